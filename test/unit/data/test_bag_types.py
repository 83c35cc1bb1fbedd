# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags of others without a mapping, and with types that only their definitions describe."""

import sqlite3
from types import SimpleNamespace

from bag_files import (
    ACTUATORS,
    CRAZYFLIE,
    esc_status,
    header,
    imu,
    lists,
    MAV,
    named_poses,
    odometry,
    poses,
    PX4,
    px4,
    START,
    store,
    transforms,
    TWIST,
    write1,
    write2,
    write_old,
    xyz,
)
from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest
from reader_checks import CMD, refused, SMALL
from rosbags.rosbag1 import Writer as Writer1

from quad_ident_ros.data.bag_guess import _holds
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.mapping import mapping_from, Source
from quad_ident_ros.data.topic_part import TopicPart
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import euler_from_quaternion

SPEEDS = SMALL.stack(*CMD)
PLACE, SPEED, ATTITUDE = ('px', 'py', 'pz'), ('vx', 'vy', 'vz'), ('qw', 'qx', 'qy', 'qz')
RATE, FORCE = ('wx', 'wy', 'wz'), ('ax', 'ay', 'az')
SHARES = (SPEEDS - 100) / 1600


def agrees(read, *groups, within=1e-9, record=SMALL):
    """Check that a record has the motion of the flight."""
    assert len(read) == len(record)
    for group in groups:
        if group == ATTITUDE:
            both = np.abs(np.sum(read.stack(*group) * record.stack(*group), axis=1))
            np.testing.assert_allclose(both, 1.0, atol=max(within, 1e-9))
        else:
            np.testing.assert_allclose(read.stack(*group), record.stack(*group), atol=within)


def test_types_that_leave_no_doubt_need_no_mapping(tmp_path):
    """Position, velocity of Odometry, rate and force of Imu, speeds of Actuators."""
    write2(tmp_path / 'bag', [*odometry(SMALL), *imu(SMALL),
                              *lists(SMALL, ACTUATORS, '/command/motor_speed', 'velocity', SPEEDS),
                              *poses(SMALL, '/mocap/other')])
    read = load(tmp_path / 'bag')
    agrees(read, PLACE, SPEED, ATTITUDE, RATE, FORCE, CMD)
    taken, others = read.info['notes']
    assert 'pose and velocity from /odom (nav_msgs/msg/Odometry)' in taken
    assert 'rate and specific_force from /imu' in taken and 'commands from /command' in taken
    assert '/mocap/other (pose)' in others


@pytest.mark.parametrize('velocity', ['world', 'body'])
@pytest.mark.parametrize('old', [False, True])
@pytest.mark.parametrize('write', [write2, write_old])
def test_the_topics_of_px4_are_known_by_type(tmp_path, velocity, old, write):
    """NED and FRD, stamps of the samples in us; the layouts of PX4 1.13 and of now."""
    kinds = ('VehicleOdometry', 'SensorCombined')
    types = store(versions={PX4 + kind: '1.13' for kind in kinds} if old else None)
    path = write(tmp_path / 'bag', px4(SMALL, SHARES, velocity, old), types=types)
    read = load(path)
    agrees(read, PLACE, SPEED, ATTITUDE, RATE, FORCE, within=1e-5)
    assert read.info['start_ns'] == START
    np.testing.assert_allclose(read.stack(*[f'output{k}' for k in range(1, 5)]), SHARES, atol=1e-6)
    assert not read.has('output5') and not read.has('cmd1')
    assert set(read.columns['vbat']) == {15.5}
    assert 'vehicle_visual_odometry' not in ' '.join(read.info['notes'])


def test_a_mapping_without_topics_says_how_outputs_become_speeds(tmp_path):
    write_old(tmp_path / 'old.db3', px4(SMALL, SHARES[:, [2, 0, 3, 1]]))
    mapping = mapping_from({'actuators': {'kind': 'normalised', 'order': [2, 4, 1, 3]}}, 'm')
    read = load(tmp_path / 'old.db3', mapping, VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, atol=0.01)


def test_px4_without_odometry_is_read_from_position_and_attitude(tmp_path):
    messages = [one for one in px4(SMALL, SHARES) if 'odometry' not in one[0]]
    read = load(write_old(tmp_path / 'f.db3', messages))
    agrees(read, PLACE, SPEED, ATTITUDE, RATE, FORCE, within=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize('odometry', [True, False])
def test_the_resets_that_px4_counts_split_a_bag(tmp_path, odometry):
    """A step of 0.8 m, less than a jump that shows in the data."""
    record = flight(seconds=12.0, noise=0.0)
    messages = [one for one in px4(record, np.full((len(record), 4), 0.5))
                if odometry or 'odometry' not in one[0]]
    for topic, _, ns, fields in messages:
        late = ns >= START + 6 * 10 ** 9
        if topic.endswith('vehicle_odometry') and late:
            fields['reset_counter'] = 1
            fields['position'][0] += 0.8
        elif topic.endswith('local_position') and late:
            fields.update(xy_reset_counter=1, x=fields['x'] + 0.8,
                          delta_xy=np.array([0.8, 0.0], np.float32))
    one, other = load_all(write_old(tmp_path / 'f.db3', messages))
    assert one.t[-1] == pytest.approx(5.99) and other.t[0] == pytest.approx(6.0)
    assert ('odometry was reset' if odometry else 'reset by 0.8 m') in one.info['notes'][-1]


def test_a_counter_that_is_no_number_is_said():
    """As in a bag whose definition of the type is another one."""
    part = TopicPart('bag, topic /attitude', 'attitude', Source('/attitude'))
    for counter in ('two', [1, 2]):
        message = SimpleNamespace(__msgtype__=PX4 + 'VehicleAttitude', timestamp=1,
                                  q=(1.0, 0.0, 0.0, 0.0), quat_reset_counter=counter)
        with pytest.raises(InputError, match='the definition of'):
            part.add(0, message)
    message.quat_reset_counter, message.delta_q_reset = 2, (1.0,)
    part.add(0, message)
    assert part.counters.fields()['quat_reset_counter'][-1] == 2


@pytest.mark.filterwarnings('error')
def test_a_number_that_is_none_and_signals_it_ends_in_no_warning():
    """As fuzzing of 100,000 bags found: numpy warns of it where it becomes a longer number."""
    signalling = np.frombuffer(b'\x01\x00\x80\x7f' * 4, '<f4')
    message = SimpleNamespace(__msgtype__=PX4 + 'VehicleAttitude', timestamp=1, q=signalling,
                              quat_reset_counter=0, delta_q_reset=signalling)
    assert not _holds('attitude', PX4 + 'VehicleAttitude', message)


def test_a_definition_of_another_length_is_said(tmp_path):
    """A PX4 that is older or newer than what ships."""
    types = store(versions={PX4 + 'VehicleAttitude': ''})
    messages = [one for one in px4(SMALL, SHARES) if one[0].endswith('vehicle_attitude')]
    path = write_old(tmp_path / 'f.db3', messages, types)
    base = sqlite3.connect(path)
    base.execute('UPDATE messages SET data = CAST(data || zeroblob(12) AS BLOB)')
    base.commit()
    base.close()
    refused(path, 'no definition', 'VehicleAttitude', 'none that ships')


@pytest.mark.parametrize('signs', [(1, 1, 1, 1), (1, -1, 1, -1)], ids=['none', 'in reverse'])
def test_measured_speeds_become_rotor_speeds(tmp_path, signs):
    """Those of rotors that turn in reverse are below zero in MAVLink."""
    rpm = np.round(SPEEDS * 60 / (2 * np.pi)).astype(int) * signs
    for write in (write2, write_old):
        read = load(write(tmp_path / write.__name__, [*odometry(SMALL), *esc_status(SMALL, rpm)]))
        np.testing.assert_allclose(read.stack('rotor1', 'rotor4'), SPEEDS[:, [0, 3]], atol=0.06)
    mapping = mapping_from({'topics': {'rotors': {'topic': '/mavros/esc_status',
                                                  'field': 'esc_status[].rpm'},
                                       'pose': {'topic': '/odom'}},
                            'actuators': {'kind': 'rpm'}}, 'm')
    read = load(tmp_path / 'write2', mapping)
    np.testing.assert_allclose(read.stack('rotor1', 'rotor4'), SPEEDS[:, [0, 3]], atol=0.06)


def test_commands_and_measured_speeds_are_told_by_the_names_of_their_topics(tmp_path):
    """As RotorS and its followers have them; normalised ones stay outputs."""
    path = write2(tmp_path / 'a', [
        *odometry(SMALL), *lists(SMALL, MAV, '/x/command/motor_speed', 'angular_velocities',
                                 SPEEDS),
        *lists(SMALL, MAV, '/x/motor_speed', 'angular_velocities', SPEEDS + 1)])
    read = load(path)
    np.testing.assert_array_equal(read.stack(*CMD), SPEEDS)
    np.testing.assert_array_equal(read.columns['rotor2'], SPEEDS[:, 1] + 1)
    path = write2(tmp_path / 'b', [*odometry(SMALL), *lists(SMALL, ACTUATORS, '/m', 'normalized',
                                                            SHARES)])
    np.testing.assert_array_equal(load(path).columns['output1'], SHARES[:, 0])


def test_transforms_of_one_vehicle_are_a_pose(tmp_path):
    path = write2(tmp_path / 'one', [*transforms(SMALL, ['/cf1']), *imu(SMALL)])
    agrees(load(path), PLACE, ATTITUDE, RATE)
    path = write2(tmp_path / 'two', [*transforms(SMALL, ['cf1', 'cf2']), *imu(SMALL)])
    refused(path, 'topic /tf', 'cf1, cf2', 'pose: {topic: /tf, child: FRAME}')
    topics = {'pose': {'topic': '/tf', 'child': 'cf2'}, 'rate': {'topic': '/imu'}}
    read = load(path, mapping_from({'topics': topics}, 'm'))
    agrees(read, PLACE, ATTITUDE, record=changed(SMALL, px=SMALL.columns['px'] + 1))
    topics['pose']['child'] = 'cf3'
    refused(path, 'with child_frame_id cf3', mapping=mapping_from({'topics': topics}, 'm'))


def test_a_name_that_would_break_a_line_is_that_of_a_damaged_bag(tmp_path):
    path = write1(tmp_path / 'a.bag', odometry(SMALL, '/b\u2028om'))
    refused(path, 'its list of topics is damaged')


def test_two_topics_for_one_role_are_listed_with_the_lines_to_write(tmp_path):
    path = write2(tmp_path / 'bag', [*odometry(SMALL, '/a/odom'), *odometry(SMALL, '/b/odom'),
                                     *imu(SMALL)])
    refused(path, 'pose: /a/odom, /b/odom', '--mapping', 'topics: {pose: {topic: /a/odom}',
            'rate: {topic: /imu}')


@pytest.mark.parametrize('names', [('/uav1', '/uav2'), ('/mocap/cf3', '/cf12')])
def test_topics_of_two_vehicles_are_no_flight(tmp_path, names):
    """Each role has one topic; the rates of one were joined to the poses of the other."""
    one, other = names
    path = write2(tmp_path / 'bag', [*odometry(SMALL, f'{one}/odom'),
                                     *imu(SMALL, f'{other}/imu')])
    refused(path, 'of several vehicles', f'{one}/odom', f'{other}/imu', '--mapping')
    path = write2(tmp_path / 'one', [*odometry(SMALL, f'{one}/odom'), *imu(SMALL, f'{one}/imu')])
    agrees(load(path), PLACE, RATE)


def test_what_is_asked_for_is_no_state(tmp_path):
    """Setpoints are no measurements, and raw measurements are the second choice."""
    path = write2(tmp_path / 'bag', [
        *poses(SMALL, '/vrpn/cf/pose'),
        *poses(changed(SMALL, px=SMALL.columns['px'] + 9), '/setpoint_position/local'),
        *imu(SMALL, '/imu/data'), *imu(changed(SMALL, wx=SMALL.columns['wx'] + 9),
                                       '/imu/data_raw')])
    agrees(load(path), PLACE, RATE)


def test_an_attitude_of_an_imu_serves_where_nothing_better_is_there(tmp_path):
    q = SMALL.stack(*ATTITUDE)
    turned = [(topic, kind, ns, {**fields, 'orientation': dict(zip('wxyz', map(float, q[k]),
                                                                   strict=True))})
              for k, (topic, kind, ns, fields) in enumerate(imu(SMALL))]
    agrees(load(write2(tmp_path / 'a', turned)), ATTITUDE, RATE, FORCE)
    assert not load(write2(tmp_path / 'b', imu(SMALL))).has('qw')   # zero: it has none
    none = [*turned[0][:3], {**turned[0][3], 'orientation_covariance': np.full(9, -1.0)}]
    assert not load(write2(tmp_path / 'c', [none, *turned[1:]])).has('qw')


@pytest.mark.parametrize('frame, column', [('base_link', 'body'), ('map', 'world'),
                                           ('somewhere', None)])
def test_a_twist_is_taken_where_its_frame_is_known(tmp_path, frame, column):
    speed = SMALL.stack(*SPEED)
    twists = [('/speed', TWIST, ns, {'header': header(ns, frame),
                                     'twist': {'linear': xyz(speed[k])}})
              for k, (_, _, ns, _) in enumerate(poses(SMALL))]
    read = load(write2(tmp_path / 'bag', [*poses(SMALL), *twists]))
    if column == 'world':
        agrees(read, PLACE, SPEED)
    elif column == 'body':
        assert np.abs(read.stack(*SPEED) - speed).max() > 0.01
        np.testing.assert_allclose(np.linalg.norm(read.stack(*SPEED), axis=1),
                                   np.linalg.norm(speed, axis=1))
    else:
        assert not read.has('vx')


def test_an_odometry_whose_twist_is_in_the_frame_of_its_pose(tmp_path):
    agrees(load(write2(tmp_path / 'bag', odometry(SMALL, frame='odom', child='odom'))), SPEED)


def test_any_type_is_read_by_its_definition_and_the_path_of_a_field(tmp_path):
    rows = [('/lab', 'lab_msgs/msg/State', ns, {
        'where': fields['pose']['pose'], 'omega': SMALL.stack(*RATE)[k].astype(np.float32),
        'rpm': SPEEDS[k]}) for k, (_, _, ns, fields) in enumerate(odometry(SMALL))]
    path = write2(tmp_path / 'bag', rows)
    refused(path, 'no topic of this bag is known', '/lab (lab_msgs/msg/State)', '--mapping')
    topics = {'pose': {'topic': '/lab', 'field': 'where'}, 'rate': {'topic': '/lab',
                                                                    'field': 'omega'},
              'position': {'topic': '/lab', 'field': 'where.position'},
              'commands': {'topic': '/lab', 'field': 'rpm'}}
    read = load(path, mapping_from({'topics': topics}, 'm'))
    agrees(read, PLACE, ATTITUDE, CMD)
    agrees(read, RATE, within=1e-6)
    topics['rate'] = {'topic': '/lab', 'field': 'rpm'}
    refused(path, 'message 1', "'rpm' holds 4 numbers, not 3",
            mapping=mapping_from({'topics': topics}, 'm'))
    topics['rate'] = {'topic': '/lab', 'field': 'where.place'}
    refused(path, "no field 'place'", 'position, orientation',
            mapping=mapping_from({'topics': topics}, 'm'))


@pytest.mark.parametrize('others, field', [
    ((), ''), ((), 'poses[].pose'), (('cf2',), 'poses[1].pose'), (('cf2',), 'poses[cf1].pose')])
def test_a_pose_of_a_list_is_read_by_its_place_or_name(tmp_path, others, field):
    """Crazyswarm2 and others publish the bodies of a motion capture in one message."""
    path = write2(tmp_path / 'bag', named_poses(SMALL, *others))
    mapping = mapping_from({'topics': {'pose': {'topic': '/poses', 'field': field}}},
                           'm') if field else None
    agrees(load(path, mapping), PLACE, ATTITUDE)


def test_a_body_that_is_not_seen_is_missing_in_its_message_alone(tmp_path):
    rows = named_poses(SMALL, 'cf2')
    for k in range(0, len(rows), 9):
        rows[k][3]['poses'].pop()
    path = write2(tmp_path / 'bag', rows)
    topics = {'pose': {'topic': '/poses', 'field': 'poses[cf1].pose'}}
    seen = np.arange(len(SMALL)) % 9 > 0
    np.testing.assert_allclose(load(path, mapping_from({'topics': topics}, 'm')).stack(*PLACE),
                               SMALL.stack(*PLACE)[seen])
    topics['pose']['field'] = 'poses[cf3].pose'
    refused(path, "'poses[cf3]' is not there; there are cf2", mapping=mapping_from(
        {'topics': topics}, 'm'))
    topics['pose']['field'] = 'poses[].pose'
    refused(path, 'several poses; name one', mapping=mapping_from({'topics': topics}, 'm'))
    topics['pose']['field'] = 'header[0].frame_id'
    refused(path, "'header' is no list", mapping=mapping_from({'topics': topics}, 'm'))


def test_a_pose_whose_name_is_in_a_list_beside_it(tmp_path):
    rows = [('/states', 'gazebo_msgs/msg/ModelStates', ns, {
        'name': ['ground', 'quad'], 'pose': [{'orientation': {'w': 1.0}}, fields['pose']['pose']]})
            for _, _, ns, fields in odometry(SMALL)]
    agrees(load(write2(tmp_path / 'bag', rows), mapping_from(
        {'topics': {'pose': {'topic': '/states', 'field': 'pose[quad]'}}}, 'm')), PLACE, ATTITUDE)


def test_of_the_velocities_of_mavros_that_of_the_world_is_read(tmp_path):
    rows = [(f'/mavros/local_position/{name}', TWIST, ns, {
        'header': header(ns, frame), 'twist': {'linear': xyz(way * SMALL.stack(*SPEED)[k])}})
        for k, (_, _, ns, _) in enumerate(poses(SMALL))
        for name, frame, way in (('velocity_body', 'base_link', -1), ('velocity_local', 'map', 1))]
    agrees(load(write2(tmp_path / 'bag', poses(SMALL) + rows)), SPEED)


def test_stamps_of_0_before_a_clock_of_simulation_do_not_cost_the_others(tmp_path):
    """The times of receipt were used, and a simulation at half the speed took twice as long."""
    rows = [(topic, kind, START + 2 * (ns - START), {**fields, 'header': header(
        max(ns - START - 100_000_000, 0))})
            for topic, kind, ns, fields in odometry(SMALL) + imu(SMALL)]
    read = load(write2(tmp_path / 'bag', rows))
    late = int(np.sum(SMALL.t - SMALL.t[0] <= 0.1 + 1e-9))
    np.testing.assert_allclose(read.t - read.t[0], SMALL.t[late:] - SMALL.t[late], atol=1e-6)
    np.testing.assert_allclose(read.stack(*PLACE), SMALL.stack(*PLACE)[late:])
    assert f'topic /imu: {late} messages before the clock began' in '; '.join(read.info['notes'])


def test_stamps_of_several_clocks_give_way_to_times_of_receipt(tmp_path):
    """PX4's clock began at its start, the other's in 1970."""
    late = [one for one in px4(SMALL, SHARES, late_us=990_000_000) if 'sensor' in one[0]]
    read = load(write2(tmp_path / 'bag', [*odometry(SMALL), *late]))
    agrees(read, PLACE, SPEED)
    agrees(read, RATE, within=1e-5)
    assert 'times of receipt' in ' '.join(read.info['notes'])


@pytest.mark.parametrize('packing', [None, *Writer1.CompressionFormat])
def test_bags_of_ros_1_are_read_alike(tmp_path, packing):
    rpm = np.round(SPEEDS * 60 / (2 * np.pi)).astype(int)
    path = write1(tmp_path / 'flight.dat', [
        *odometry(SMALL), *imu(SMALL), *esc_status(SMALL, rpm), *transforms(SMALL, ['a', 'b']),
        *lists(SMALL, MAV, '/x/command/motor_speed', 'angular_velocities', SPEEDS)], packing)
    read = load(path)
    agrees(read, PLACE, SPEED, ATTITUDE, RATE, FORCE, CMD)
    np.testing.assert_allclose(read.columns['rotor1'], SPEEDS[:, 0], atol=0.06)
    mapping = mapping_from({'topics': {'pose': {'topic': '/tf', 'child': 'a'}}}, 'm')
    agrees(load(path, mapping), PLACE, ATTITUDE)


def test_a_bag_of_ros_1_that_was_cut_off_is_told_how_to_mend(tmp_path):
    path = write1(tmp_path / 'f.bag', odometry(SMALL))
    path.write_bytes(path.read_bytes()[:-200])
    refused(path, 'rosbag reindex')


def test_pose_and_twist_of_a_motion_capture_are_none_of_the_recorder(tmp_path):
    """Names that others use as well; their twist is in the world."""
    speed = SMALL.stack(*SPEED)
    twists = [('/vrpn/cf/twist', TWIST, ns, {'header': header(ns, 'world'),
                                             'twist': {'linear': xyz(speed[k])}})
              for k, (_, _, ns, _) in enumerate(poses(SMALL))]
    agrees(load(write2(tmp_path / 'bag', [*poses(SMALL, '/vrpn/cf/pose'), *twists])), PLACE, SPEED)


def test_a_battery_that_is_recorded_once_does_not_keep_a_flight_from_being_read(tmp_path):
    one = [row for row in px4(SMALL, SHARES) if 'battery' not in row[0]]
    one += [row for row in px4(SMALL, SHARES) if 'battery' in row[0]][:1]
    read = load(write2(tmp_path / 'bag', one))
    assert not read.has('vbat') and read.has('px')


def test_a_topic_in_other_units_is_read_by_its_unit(tmp_path):
    """As Crazyswarm2 publishes log variables: lists of float32, rates in deg/s, forces in g."""
    rpm = SPEEDS * 30 / np.pi
    messages = [one for topic, table in (
        ('/cf1/place', 1000 * SMALL.stack(*PLACE)), ('/cf1/speed', 100 * SMALL.stack(*SPEED)),
        ('/cf1/gyro', np.degrees(SMALL.stack(*RATE))), ('/cf1/acc', SMALL.stack(*FORCE) / 9.80665),
        ('/cf1/rpm', rpm), ('/cf1/angles', np.degrees(euler_from_quaternion(
            SMALL.stack(*ATTITUDE)))), ('/cf1/vbat', np.full((len(SMALL), 1), 3900.0)))
        for one in lists(SMALL, CRAZYFLIE, topic, 'values', table.astype(np.float32))]
    path = write2(tmp_path / 'bag', messages)
    units = {'position': ('place', 'mm'), 'velocity': ('speed', 'cm/s'), 'rate': ('gyro', 'deg/s'),
             'specific_force': ('acc', 'g'), 'rotors': ('rpm', 'rpm'),
             'attitude': ('angles', 'deg'), 'battery': ('vbat', 'mV')}
    topics = {role: {'topic': f'/cf1/{name}', 'field': 'values', 'unit': unit}
              for role, (name, unit) in units.items()}
    topics['velocity']['frame'] = 'world'
    # What the commands are does not matter for speeds that are measured in rpm.
    actuators = {'kind': 'pwm', 'maximum': 65535, 'minimum': 0, 'speeds': [0, 2000]}
    read = load(path, mapping_from({'topics': topics, 'actuators': actuators}, 'm'))
    agrees(read, PLACE, SPEED, RATE, FORCE, within=2e-5)
    agrees(read, ATTITUDE, within=1e-6)
    np.testing.assert_allclose(read.stack('rotor1', 'rotor4'), SPEEDS[:, [0, 3]], rtol=1e-6)
    np.testing.assert_allclose(read.columns['vbat'], 3.9)


def test_a_pose_in_mm_keeps_its_attitude(tmp_path):
    big = changed(SMALL, **{name: 1000 * SMALL.columns[name] for name in PLACE})
    write2(tmp_path / 'bag', poses(big))
    topics = {'pose': {'topic': '/pose_of_it', 'unit': 'mm'}}
    agrees(load(tmp_path / 'bag', mapping_from({'topics': topics}, 'm')), PLACE, ATTITUDE)


def test_a_quaternion_has_no_unit(tmp_path):
    write2(tmp_path / 'bag', poses(SMALL))
    for field in ({}, {'field': 'pose.orientation'}):
        topics = {'attitude': {'topic': '/pose_of_it', 'unit': 'deg', **field}}
        refused(tmp_path / 'bag', 'a quaternion, which has no unit; leave unit out',
                mapping=mapping_from({'topics': topics}, 'm'))
