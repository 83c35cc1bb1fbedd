# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is in a bag; bags that are damaged, huge by what they say, or nonsense."""

from pathlib import Path
import random

from bag_files import (
    esc_status,
    imu,
    lists,
    MAV,
    odometry,
    px4,
    START,
    store,
    transforms,
    write1,
    write2,
    write_old,
)
import numpy as np
import pytest
from reader_checks import CMD, SMALL
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin

from quad_ident_ros.data import limits
from quad_ident_ros.data.bag_file import BagFile, read_bag_messages
from quad_ident_ros.data.export import write_bag
from quad_ident_ros.data.load import contents_of, load_all
from quad_ident_ros.errors import InputError

SPEEDS = SMALL.stack(*CMD)
SHORT = SMALL.slice(0, 12)


@pytest.mark.parametrize('write, title', [
    (write2, 'a bag of ROS 2'), (write_old, 'a bag of ROS 2'), (write1, 'a bag of ROS 1')])
def test_the_topics_of_a_bag(tmp_path, write, title):
    rpm = SPEEDS.astype(int)
    path = write(tmp_path / 'bag.db3', [*odometry(SMALL), *imu(SMALL)[20:71],
                                        *esc_status(SMALL, rpm)])
    said, contents = contents_of(path)
    assert said == title
    found = {one.name: one for one in contents}
    odom, gyro = found['/odom'], found['/imu']
    assert (odom.type, odom.samples, odom.start) == ('nav_msgs/msg/Odometry', len(SMALL), 0.0)
    assert odom.roles == ('pose', 'velocity', 'rate')
    assert 'pose.pose.position' in odom.fields and 'header.stamp' in odom.fields
    assert 'pose.covariance[36]' in odom.fields
    assert gyro.samples == 51 and gyro.rate == pytest.approx(100, rel=1e-6)
    assert (gyro.start, gyro.duration) == pytest.approx((0.2, 0.5))
    assert gyro.roles == ('attitude', 'rate', 'specific_force')
    assert 'esc_status[].rpm' in found['/mavros/esc_status'].fields
    assert found['/mavros/esc_status'].roles == ('rotors',)


def test_a_recording_of_the_recorder_shows_its_bag(tmp_path):
    write_bag(tmp_path / 'bag', SMALL)
    names = [one.name for one in contents_of(tmp_path)[1]]
    assert names == [one.name for one in contents_of(tmp_path / 'bag')[1]] and 'pose' in names


def test_a_type_without_any_definition_is_shown_without_fields(tmp_path):
    types = store()
    path = write_old(tmp_path / 'f.db3', [('/lab', 'lab_msgs/msg/State', START, {}),
                                          *odometry(SHORT)], types)
    found = {one.name: one for one in contents_of(path)[1]}
    assert found['/lab'].fields == () and found['/lab'].samples == 1
    assert len(load_all(path)[0]) == len(SHORT)      # others are read all the same
    with pytest.raises(InputError, match='no definition of lab_msgs/msg/State'):
        list(read_bag_messages(path, {'/lab'}))


@pytest.mark.parametrize('text, said', [
    ('nav_msgs/Odometry[] inner\n', 'contains itself'),
    ('std_msgs/Empty[] many\n', 'empty messages'),
    ('std_msgs/Empty[4000000000] many\n', 'empty messages'),
    ('lab_msgs/Nothing one\n', 'no definition of lab_msgs/msg/Nothing'),
    ('string[4000000000] many\n', 'array of 4000000000 entries'),
    ('float64[4000000000] many\n', 'array of 4000000000 entries'),
    ('std_msgs/Time[5000] many\n', 'array of 5000 entries'),
    ('float64[] many\n', 'cannot be read'),
    ('float64 = \n', 'cannot be read')])
def test_absurd_definitions_end_in_a_line(tmp_path, text, said):
    """A list of four milliards of entries that take no bytes would take for ever."""
    path = write1(tmp_path / 'f.bag', odometry(SHORT))
    with BagFile(path) as bag:
        connection = bag._reader.connections[0]
        definition = connection.msgdef._replace(data=text)
        bag._reader.connections[0] = connection._replace(msgdef=definition)
        with pytest.raises(InputError, match=said):
            list(bag.messages())


def test_an_index_that_repeats_itself_is_refused(tmp_path):
    """Each entry of the index of chunks may name the same chunk: the index is then endless."""
    path = write1(tmp_path / 'f.bag', odometry(SMALL))
    data = path.read_bytes()
    at = last = int.from_bytes(data[data.index(b'index_pos=') + 10:][:8], 'little')
    while at < len(data):   # a record: its header and its data, each after its length
        last = at
        for _ in range(2):
            at += 4 + int.from_bytes(data[at:at + 4], 'little')
    count = data.index(b'chunk_count=') + len('chunk_count=')
    path.write_bytes(data[:count] + (2000).to_bytes(4, 'little') + data[count + 4:]
                     + 1999 * data[last:])
    with pytest.raises(InputError, match='again and again'):
        load_all(path)


def test_an_index_that_names_messages_of_other_topics_is_refused(tmp_path):
    path = write1(tmp_path / 'f.bag', [*odometry(SHORT), *esc_status(SHORT, SPEEDS.astype(int))])
    data = bytearray(path.read_bytes())
    at = data.index(b'conn=\x00', data.index(b'op=\x02') - 40)   # of the first message
    data[at + 5] = 1
    path.write_bytes(data)
    with pytest.raises(InputError, match='other topics'):
        list(read_bag_messages(path, {'/odom'}))


def test_a_chunk_that_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    for packing in Writer1.CompressionFormat:
        path = write1(tmp_path / f'{packing.name}.bag', odometry(SMALL), packing)
        with monkeypatch.context() as patch:
            patch.setattr(limits, 'PART', 1000)
            with pytest.raises(InputError, match='unpacks to over'):
                load_all(path)


SPECIAL = (bytes(4), b'\xff' * 4, b'\x7f' + b'\xff' * 3, b'\xff' * 8, b'=', b'op=', b'[]', b'[9]')


def mutations(data, count, seed):
    """Yield mutated copies of bytes."""
    for number in range(count):
        chance = random.Random(f'{seed} {number}')
        changed = bytearray(data)
        for _ in range(chance.choice((1, 1, 2, 5))):
            at = chance.randrange(len(changed))
            what = chance.randrange(5)
            if what == 0:
                changed[at] ^= 1 << chance.randrange(8)
            elif what == 1:
                special = chance.choice(SPECIAL)
                changed[at:at + len(special)] = special
            elif what == 2:
                del changed[at:at + chance.choice((1, 4, 50))]
            elif what == 3:
                changed[at:at] = changed[at:at + chance.choice((4, 60))]
            elif chance.random() < 0.2:
                del changed[at:]
            if not changed:
                changed = bytearray(b'#')
        yield bytes(changed)


def example(folder, kind):
    """Return the bytes of a small bag of a kind."""
    if kind == 'px4':
        return write_old(folder / 'f.db3', px4(SHORT, SPEEDS / 2000)).read_bytes()
    rows = [*odometry(SHORT), *imu(SHORT), *transforms(SHORT, ['a']),
            *esc_status(SHORT, SPEEDS.astype(int)),
            *lists(SHORT, MAV, '/command/motor_speed', 'angular_velocities', SPEEDS)]
    if kind == 'mcap':
        return next(Path(write2(folder / 'bag', rows)).glob('*.mcap')).read_bytes()
    if kind == 'sqlite3':
        return next(Path(write2(folder / 'bag', rows, StoragePlugin.SQLITE3)).glob(
            '*.db3')).read_bytes()
    packing = {'bz2': Writer1.CompressionFormat.BZ2, 'lz4': Writer1.CompressionFormat.LZ4}
    return write1(folder / 'f.bag', rows, packing.get(kind)).read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['ros1', 'bz2', 'lz4', 'px4', 'mcap', 'sqlite3'])
def test_mutated_bags_are_read_or_refused_in_a_line(tmp_path, kind):
    """Whole and listed: no traceback, and rows that are finite in time."""
    valid = example(tmp_path, kind)
    path = tmp_path / 'mutated'
    outcomes = {'read': 0, 'refused': 0}
    for data in [valid, *mutations(valid, 200, kind)]:
        path.write_bytes(data)
        for use in (load_all, contents_of):
            try:
                got = use(path)
            except InputError as error:
                text = str(error)
                assert str(path) in text and len(text.splitlines()) == 1 and len(text) < 1000
                outcomes['refused'] += 1
            else:
                outcomes['read'] += 1
                if use is load_all:
                    assert all(np.isfinite(record.t).all() for record in got)
    assert outcomes['read'] > 2 and outcomes['refused'] > 10
