# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of bags that are read together: the same numbers as one by one, to the last bit."""

from bag_files import (
    ACTUATORS,
    esc_status,
    header,
    IMU,
    imu,
    lists,
    Make,
    odometry,
    poses,
    PX4,
    px4,
    store,
    transforms,
    write1,
    write2,
    write_old,
)
import numpy as np
import pytest
from reader_checks import CMD, same, SMALL

from quad_ident_ros.data import alike, foreign
from quad_ident_ros.data.bag_file import BagFile
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.mapping import mapping_from

SPEEDS = SMALL.stack(*CMD)
PLAIN = [*odometry(SMALL), *imu(SMALL), *esc_status(SMALL, SPEEDS.astype(int)),
         *lists(SMALL, ACTUATORS, '/command/motor_speed', 'velocity', SPEEDS)]
FIELDS = mapping_from({'topics': {
    'position': {'topic': '/odom', 'field': 'pose.pose.position', 'unit': 'mm'},
    'attitude': {'topic': '/odom', 'field': 'pose.pose'},
    'rate': {'topic': '/imu', 'field': 'angular_velocity', 'unit': 'deg/s'},
    'rotors': {'topic': '/mavros/esc_status', 'field': 'esc_status[].rpm', 'unit': 'rpm'},
    'commands': {'topic': '/command/motor_speed', 'field': 'velocity'},
    'battery': {'topic': '/imu', 'field': 'linear_acceleration.z'}}}, 'mapping')


def read_both(path, monkeypatch, mapping=None):
    """Return the records read together and one by one, and how many came together."""
    together = []
    add = foreign.TopicPart.add_many

    def counted(part, received, message):
        together.append(len(received))
        add(part, received, message)

    monkeypatch.setattr(foreign.TopicPart, 'add_many', counted)
    fast = load_all(path, mapping)
    count = sum(together)
    monkeypatch.setattr(foreign, '_fixed', lambda parts: None)
    slow = load_all(path, mapping)
    assert sum(together) == count
    return fast, slow, count


def agree(path, monkeypatch, mapping=None):
    """Check that both ways have the same records, and return how many messages came together."""
    fast, slow, count = read_both(path, monkeypatch, mapping)
    assert len(fast) == len(slow)
    for one, other in zip(fast, slow, strict=True):
        same(one, other)
        assert one.info == other.info
    return count


@pytest.mark.slow
@pytest.mark.parametrize('write', [write2, write_old, write1])
@pytest.mark.parametrize('mapping', [None, FIELDS])
def test_all_but_the_first_message_of_a_topic_come_together(tmp_path, monkeypatch, write,
                                                            mapping):
    """Imu, Odometry, ESCStatus, Actuators, serialized by ROS 1 and ROS 2, whole or by fields."""
    rows = [row for row in PLAIN if write is not write1 or row[1] != ACTUATORS]
    if write is write1 and mapping:
        pytest.skip('actuator_msgs are of ROS 2')
    count = agree(write(tmp_path / 'bag', rows), monkeypatch, mapping)
    roles = 6 if mapping else 6 - (write is write1)
    assert count == roles * (len(SMALL) - 1)


@pytest.mark.slow
@pytest.mark.parametrize('velocity', ['world', 'body'])
@pytest.mark.parametrize('old', [False, True])
def test_px4s_messages_with_stamps_counters_and_frames(tmp_path, monkeypatch, velocity, old):
    kinds = ('VehicleOdometry', 'SensorCombined')
    types = store(versions={PX4 + kind: '1.13' for kind in kinds} if old else None)
    rows = px4(SMALL, SPEEDS / 2000, velocity, old)
    for _, kind, ns, fields in rows:
        if kind == PX4 + 'VehicleOdometry' and not old:
            fields['reset_counter'] = int(ns > rows[0][2] + 5 * 10 ** 8)
    assert agree(write2(tmp_path / 'bag', rows, types=types), monkeypatch) > 3 * len(SMALL)


@pytest.mark.slow
def test_a_velocity_that_changes_its_frame_is_refused_at_its_message(tmp_path, monkeypatch):
    """The field that says how others are read has one value in messages that come together."""
    rows = px4(SMALL, SPEEDS / 2000)
    changed = [row for row in rows if row[0] == '/fmu/out/vehicle_odometry'][60]
    changed[3]['velocity_frame'] = 3
    path = write2(tmp_path / 'bag', rows)
    with pytest.raises(foreign.InputError, match='message 61: its velocity is in another frame'):
        load_all(path)


@pytest.mark.slow
def test_texts_and_lists_that_change_are_read_one_by_one(tmp_path, monkeypatch):
    """Another frame_id of the same length and of another, an attitude that is not always there."""
    rows = [*poses(SMALL), *imu(SMALL)]
    for k, (_, kind, ns, fields) in enumerate(rows):
        if k % 7 == 3:
            fields['header'] = header(ns, 'mac' if k % 2 else 'elsewhere')
        if kind == IMU and k % 11 < 5:
            fields['linear_acceleration_covariance'] = np.array([-1.0, *np.zeros(8)])
    count = agree(write2(tmp_path / 'bag', rows), monkeypatch)
    assert 0 < count < 3 * len(SMALL)


@pytest.mark.slow
def test_transforms_of_which_each_message_has_others_never_come_together(tmp_path, monkeypatch):
    path = write2(tmp_path / 'bag', transforms(SMALL, ['quad']))
    assert agree(path, monkeypatch) == 0


@pytest.mark.slow
def test_few_wait_and_many_come_in_parts(tmp_path, monkeypatch):
    monkeypatch.setattr(alike, 'MOST_MESSAGES', 16)
    path = write2(tmp_path / 'bag', odometry(SMALL))
    with BagFile(path) as bag:
        sizes = [np.size(received) for _, received, _ in bag.together({'/odom'}, lambda _: ())]
    assert sum(sizes) == len(SMALL) and max(sizes) == 16
    agree(path, monkeypatch)


@pytest.mark.parametrize('little', [True, False])
def test_a_layout_takes_either_order_of_bytes(little):
    types = store()
    messages = [Make(types)(kind, **fields) for _, kind, _, fields in imu(SMALL)]
    data = [bytes(types.serialize_cdr(one, IMU, little_endian=little)) for one in messages]
    layout = alike.layout_of(data[0], messages[0], types)
    rows = np.frombuffer(b''.join(data), np.uint8).reshape(len(data), -1)
    assert layout.alike(rows).all()
    np.testing.assert_array_equal(layout.make(rows).angular_velocity.y, SMALL.columns['wy'])


def test_a_message_that_is_not_what_was_read_has_no_layout():
    types = store()
    one, other = (Make(types)(kind, **fields) for _, kind, _, fields in imu(SMALL)[:2])
    data = bytes(types.serialize_cdr(one, IMU))
    assert alike.layout_of(data, one, types) is not None
    assert alike.layout_of(data, other, types) is None
