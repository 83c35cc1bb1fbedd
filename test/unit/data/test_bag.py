# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of rosbag2 folders."""

import errno
from functools import cache
import os
from pathlib import Path
import select
import shutil
import signal
import subprocess
import sys

from full_disk import file_size_limit
import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosHistory, QosReliability
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores
import yaml

from quad_ident_ros.data.bag import BagWriter
from quad_ident_ros.data.bag_file import BagFile, read_bag_messages
from quad_ident_ros.errors import InputError

ARRAY, VECTOR = 'std_msgs/msg/Float64MultiArray', 'geometry_msgs/msg/Vector3'
TOPICS = [('/cmd', ARRAY), ('/wind', VECTOR), ('/wind2', VECTOR)]
STORE = get_typestore(Stores.ROS2_JAZZY)
START = 1_700_000_000_000_000_000

# Processes of their own find this file and its helpers as this one does.
ALIKE = {'cwd': str(Path(__file__).parent),
         'env': {**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)}}


def array_cdr(values):
    """Return a serialized Float64MultiArray."""
    layout = STORE.types['std_msgs/msg/MultiArrayLayout'](dim=[], data_offset=0)
    message = STORE.types[ARRAY](layout=layout, data=np.asarray(values, float))
    return bytes(STORE.serialize_cdr(message, ARRAY))


@cache
def vector_cdr(k):
    """Return a serialized Vector3 (k, 0, 0)."""
    return bytes(STORE.serialize_cdr(STORE.types[VECTOR](x=float(k), y=0.0, z=0.0), VECTOR))


def fill(writer, start, stop):
    """Write one vector for each k in start..stop - 1, every other one earlier than the last."""
    for k in range(start, stop):
        writer.write('/wind', START + (k ^ 1) * 1_000_000, vector_cdr(k))


def numbers(path):
    """Return the k of the vectors of a bag, in the order that they come."""
    return [int(message.x) for _, _, message in read_bag_messages(path)]


def swapped(count):
    """Return the k that fill wrote, by time."""
    return [k ^ 1 for k in range(count)]


def files(path):
    """Return the content of each file in a folder, by name."""
    return {file.name: file.read_bytes() for file in path.iterdir()}


@pytest.mark.slow
def test_messages_come_back_by_time(tmp_path):
    """Topic, time and content of every message come back, in order of time over all topics."""
    with BagWriter(tmp_path / 'bag', TOPICS) as writer:
        writer.write('/wind', 30, vector_cdr(3))
        writer.flush()
        writer.write('/cmd', 20, array_cdr([1.5, -2]))
        writer.write('/wind2', 10, vector_cdr(1))
    got = list(read_bag_messages(tmp_path / 'bag'))
    assert [item[:2] for item in got] == [('/wind2', 10), ('/cmd', 20), ('/wind', 30)]
    assert got[1][2].data.tolist() == [1.5, -2]
    assert [got[0][2].x, got[2][2].x] == [1, 3]
    assert [item[0] for item in read_bag_messages(tmp_path / 'bag', {'/cmd'})] == ['/cmd']
    assert list(read_bag_messages(tmp_path / 'bag', ['/none'])) == []
    assert len(list(read_bag_messages(tmp_path / 'bag' / 'bag.mcap'))) == 3


@pytest.mark.slow
def test_every_flush_leaves_the_bag_that_close_would(tmp_path):
    """The folder after a flush is, byte for byte, one that was closed there."""
    path = tmp_path / 'bag'
    writer = BagWriter(path, TOPICS)
    snapshots = [files(path)]
    for k in range(3):
        fill(writer, 10 * k, 10 * k + 10)
        assert files(path) == snapshots[-1]
        writer.flush()
        snapshots.append(files(path))
        assert numbers(path) == swapped(10 * k + 10)
    writer.close()
    assert files(path) == snapshots[-1]
    assert set(snapshots[0]) == {'bag.mcap', 'metadata.yaml'}


def test_an_empty_bag_is_a_bag(tmp_path):
    """From its first moment the folder can be read."""
    writer = BagWriter(tmp_path / 'bag', TOPICS)
    assert list(read_bag_messages(tmp_path / 'bag')) == []
    writer.close()
    with Reader(tmp_path / 'bag') as reader:
        assert sorted(reader.topics) == ['/cmd', '/wind', '/wind2']


BEGINNING = """
import os
import sys
from quad_ident_ros.data import bag
from test_bag import *

setattr(bag._Writer, sys.argv[2], lambda *_, **__: os._exit(9))
BagWriter(sys.argv[1], TOPICS)
"""


@pytest.mark.slow
@pytest.mark.parametrize('step', ['add_connection', 'close', 'move'])
def test_a_folder_that_is_there_is_a_bag(tmp_path, step):
    """A process that ends at once while it makes one leaves none that cannot be read."""
    done = subprocess.run([sys.executable, '-c', BEGINNING, str(tmp_path / 'bag'), step],
                          check=False, **ALIKE)
    assert done.returncode == 9 and not (tmp_path / 'bag').exists()
    with BagWriter(tmp_path / 'bag', TOPICS) as writer:
        fill(writer, 0, 10)
    assert os.listdir(tmp_path) == ['bag'] and numbers(tmp_path / 'bag') == swapped(10)


def test_nothing_on_disk_changes_between_flushes(tmp_path):
    """Even messages that fill several chunks leave the file of the last flush whole."""
    path = tmp_path / 'bag'
    with BagWriter(path, TOPICS) as writer:
        fill(writer, 0, 10)
        writer.flush()
        before = files(path)
        blob = array_cdr(np.zeros(40_000))
        for k in range(8):
            writer.write('/cmd', START + k, blob)
        assert files(path) == before
    assert len(list(read_bag_messages(path, ['/cmd']))) == 8


def test_memory_is_bounded_without_flushes(tmp_path):
    """A bag that nobody flushes reaches the disk all the same."""
    writer = BagWriter(tmp_path / 'bag', TOPICS)
    blob = array_cdr(np.zeros(40_000))
    for k in range(40):
        writer.write('/cmd', START + k, blob)
    assert sum(1 for _ in read_bag_messages(tmp_path / 'bag')) >= 20
    writer.close()
    assert sum(1 for _ in read_bag_messages(tmp_path / 'bag')) == 40


def test_metadata_is_that_of_rosbags_but_for_the_distro(tmp_path):
    """metadata.yaml is what rosbags writes for the same bag, and names ROS 2 Jazzy."""
    with BagWriter(tmp_path / 'ours' / 'bag', TOPICS) as writer:
        fill(writer, 0, 10)
        writer.flush()
        fill(writer, 10, 20)
    with Reader(tmp_path / 'ours' / 'bag') as reader:
        qos = reader.connections[0].ext.offered_qos_profiles
        assert reader.ros_distro == 'jazzy'
        assert reader.message_count == 20
        assert reader.start_time == START
    assert (qos[0].history, qos[0].reliability, qos[0].durability) == (
        QosHistory.KEEP_ALL, QosReliability.RELIABLE, QosDurability.VOLATILE)
    with Writer(tmp_path / 'theirs' / 'bag', version=9,
                storage_plugin=StoragePlugin.MCAP) as theirs:
        connections = [theirs.add_connection(*topic, typestore=STORE, offered_qos_profiles=qos)
                       for topic in TOPICS]
        for k in range(20):
            theirs.write(connections[1], START + (k ^ 1) * 1_000_000, vector_cdr(k))
    ours, expected = (yaml.safe_load((tmp_path / name / 'bag' / 'metadata.yaml').read_text())
                      for name in ('ours', 'theirs'))
    expected['rosbag2_bagfile_information']['ros_distro'] = 'jazzy'
    assert ours == expected


def test_definitions_travel_with_the_bag(tmp_path):
    """A reader that knows no message types can read the bag."""
    with BagWriter(tmp_path / 'bag', TOPICS) as writer:
        fill(writer, 0, 2)
    with AnyReader([tmp_path / 'bag']) as reader:
        assert [reader.deserialize(data, connection.msgtype).x
                for connection, _, data in reader.messages()] == [1, 0]


def test_sqlite_bags_are_read_too(tmp_path):
    """The older storage of rosbag2 reads the same."""
    with Writer(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection('/wind', VECTOR, typestore=STORE)
        for k in range(3):
            writer.write(connection, START + k, vector_cdr(k))
    assert numbers(tmp_path / 'bag') == [0, 1, 2]


CHILD = f"""
import sys
sys.path[:0] = {sys.path!r}
from test_bag import *
writer = BagWriter(sys.argv[1], TOPICS)
for k in range(5):
    fill(writer, 20 * k, 20 * k + 20)
    writer.flush()
for k in range(2):
    writer.write('/cmd', START + k, array_cdr(np.zeros(200_000)))
fill(writer, 100, 150)
print('written', flush=True)
sys.stdin.read()
"""


@pytest.mark.slow
def test_kill_loses_only_what_came_after_the_last_flush(tmp_path):
    """SIGKILL between two flushes leaves a bag with all that was flushed."""
    with subprocess.Popen([sys.executable, '-c', CHILD, str(tmp_path / 'bag')],
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE, **ALIKE) as child:
        try:
            assert child.stdout.readline() == b'written\n'
        finally:
            child.send_signal(signal.SIGKILL)
        assert child.wait(60) == -signal.SIGKILL
    assert numbers(tmp_path / 'bag') == swapped(100)


FLUSHING = """
import sys
from test_bag import *

writer = BagWriter(sys.argv[1], TOPICS)
for k in range(0, 1_000_000, 500):
    fill(writer, k, k + 500)
    writer.flush()
    print(k + 500, flush=True)
"""


@pytest.mark.slow
@pytest.mark.parametrize('after', range(4))
def test_a_process_that_is_killed_while_it_flushes_loses_nothing_that_it_flushed(tmp_path, after):
    """At a moment by chance, of which most of the time goes into the writing."""
    random = np.random.default_rng(after)
    with subprocess.Popen([sys.executable, '-c', FLUSHING, str(tmp_path / 'bag')],
                          stdout=subprocess.PIPE, **ALIKE) as child:
        for _ in range(1 + after):
            flushed = int(child.stdout.readline())
        select.select([child.stdout], [], [], random.uniform(0.0, 0.02))
        child.kill()
        flushed = max([flushed, *map(int, child.stdout.read().split())])
    got = numbers(tmp_path / 'bag')
    assert len(got) >= flushed and got == swapped(len(got))


@pytest.mark.slow
@pytest.mark.parametrize('more', [4, 60])
def test_a_kill_within_a_flush_loses_nothing_that_was_whole(tmp_path, more):
    """Wherever a write ends, the new content is before that place and the old one behind it."""
    path = tmp_path / 'bag'
    writer = BagWriter(path, TOPICS)
    fill(writer, 0, 40)
    writer.flush()
    fill(writer, 40, 80)
    writer.flush()
    before = files(path)['bag.mcap']
    fill(writer, 80, 80 + more)     # less than the index at the end, and more
    writer.flush()
    after = files(path)['bag.mcap']
    begin = next(k for k, (one, other) in enumerate(zip(before, after, strict=False))
                 if one != other)
    complete, recovered = set(), 0
    for place in (*range(begin, begin + 40), *range(begin + 40, len(after), 151), len(after) - 1):
        (path / 'bag.mcap').write_bytes(after[:place] + before[place:])
        got = numbers(path)
        assert got in (swapped(80), swapped(80 + more)), place
        complete.add(len(got))
        assert numbers(path / 'bag.mcap') == got
        with BagFile(path) as read:
            recovered += read.recovered
    assert len(complete) == 2 and recovered > 10
    (path / 'bag.mcap').write_bytes(after)
    with BagFile(path) as read:
        assert not read.recovered
    writer.close()


@pytest.mark.slow
def test_a_bag_that_is_cut_off_is_read_as_far_as_it_goes(tmp_path):
    path = tmp_path / 'bag'
    with BagWriter(path, TOPICS) as writer:
        for k in range(5):
            fill(writer, 20 * k, 20 * k + 20)
            writer.flush()
    whole = files(path)['bag.mcap']
    counts = []
    for end in range(len(whole) - 1, 8, -97):
        (path / 'bag.mcap').write_bytes(whole[:end])
        try:
            got = numbers(path)
        except InputError as error:
            assert len(str(error).splitlines()) == 1
            counts.append(-1)
        else:
            counts.append(len(got))
            assert got == swapped(len(got))
    assert counts == sorted(counts, reverse=True) and set(counts) == {100, 80, 60, 40, 20, 0, -1}


@pytest.mark.parametrize('end', [True, False], ids=['with its end', 'without'])
@pytest.mark.parametrize('damage', ['content', 'length', 'everything'])
def test_a_damaged_chunk_is_left_out_and_the_others_are_read(tmp_path, damage, end):
    """Also those behind it, whatever of it is damaged, and how many are is said."""
    path = tmp_path / 'bag'
    with BagWriter(path, TOPICS) as writer:
        for k in range(5):
            fill(writer, 20 * k, 20 * k + 20)
            writer.flush()
    data = bytearray(files(path)['bag.mcap'])
    with BagFile(path) as read:
        places = [one.chunk_start_offset for one in read._reader.storages[0].chunks]
        assert read.skipped == 0
    begin, behind = places[2], places[3]
    if damage == 'content':
        data[begin + 200] ^= 1
    elif damage == 'length':
        data[begin + 1] ^= 4
    else:
        data[begin:behind] = np.random.default_rng(1).bytes(behind - begin)
    (path / 'bag.mcap').write_bytes(data if end else data[:-100])
    for place in (path, path / 'bag.mcap'):
        kept = end and damage == 'length'   # the index says it too
        assert numbers(place) == [k for k in swapped(100) if kept or not 20 <= k < 40]
        with BagFile(place) as read:
            assert (read.skipped, read.recovered) == (0 if kept else 1, not end)


@pytest.mark.parametrize('room', [0, 1, 700, 3000])
def test_full_disk(tmp_path, room):
    """A flush onto a full disk raises OSError, and what was flushed before stays readable."""
    path = tmp_path / 'bag'
    writer = BagWriter(path, TOPICS)
    fill(writer, 0, 100)
    writer.flush()
    before = files(path)
    fill(writer, 100, 200)
    with file_size_limit(len(before['bag.mcap']) + room):
        for _ in range(2):
            with pytest.raises(OSError) as caught:
                writer.flush()
            assert caught.value.errno == errno.EFBIG
            assert files(path) == before
        writer.close()
        writer.close()
    assert files(path) == before
    assert numbers(path) == swapped(100)


def test_room_again_after_a_full_disk(tmp_path):
    """A flush that failed can be tried again, and then nothing is missing."""
    path = tmp_path / 'bag'
    writer = BagWriter(path, TOPICS)
    fill(writer, 0, 100)
    for limit in (100, (path / 'bag.mcap').stat().st_size + 100):
        with file_size_limit(limit), pytest.raises(OSError):
            writer.flush()
        assert numbers(path) == []
    fill(writer, 100, 110)
    writer.flush()
    assert numbers(path) == swapped(110)
    fill(writer, 110, 120)
    writer.close()
    assert numbers(path) == swapped(120)


def test_full_disk_that_has_room_for_the_data_but_not_the_metadata(tmp_path, monkeypatch):
    """metadata.yaml is replaced whole or not at all."""
    path = tmp_path / 'bag'
    writer = BagWriter(path, TOPICS)
    fill(writer, 0, 10)

    def fail(file, *_):
        file.touch()
        raise OSError(errno.ENOSPC, 'No space left on device')
    with monkeypatch.context() as patch:
        patch.setattr(Path, 'write_text', fail)
        with pytest.raises(OSError, match='No space'):
            writer.flush()
        writer.close()
    assert set(files(path)) == {'bag.mcap', 'metadata.yaml'}
    assert numbers(path) == swapped(10)


def test_close_tells_of_its_own_failure(tmp_path):
    """What only the close would have written is not lost silently."""
    writer = BagWriter(tmp_path / 'bag', TOPICS)
    fill(writer, 0, 100)
    with file_size_limit(100), pytest.raises(OSError):
        writer.close()
    writer.close()
    assert numbers(tmp_path / 'bag') == []


def test_no_folder_to_write_to(tmp_path):
    """A place that cannot be written to is an OSError, and a full disk leaves no folder."""
    (tmp_path / 'file').touch()
    with pytest.raises(OSError):
        BagWriter(tmp_path / 'file' / 'bag', TOPICS)
    with file_size_limit(10), pytest.raises(OSError):
        BagWriter(tmp_path / 'bag', TOPICS)
    assert os.listdir(tmp_path) == ['file']


@pytest.mark.parametrize('topics, part', [
    ([('/a', VECTOR), ('/a', ARRAY)], 'repeat'),
    ([('/a', 'geometry_msgs/msg/None')], 'geometry_msgs/msg/None'),
    ([('/a', '')], 'message type'),
])
def test_topics_that_cannot_be(tmp_path, topics, part):
    """Topics without a type, or named twice, are refused before anything is made."""
    with pytest.raises(InputError, match=part):
        BagWriter(tmp_path / 'bag', topics)
    assert os.listdir(tmp_path) == []


def test_refused_calls(tmp_path):
    """An existing folder is not written to, nor a topic that does not exist."""
    with BagWriter(tmp_path / 'bag', TOPICS) as writer:
        before = files(tmp_path / 'bag')
        with pytest.raises(InputError, match='already'):
            BagWriter(tmp_path / 'bag', TOPICS)
        with pytest.raises(InputError, match="'/none'"):
            writer.write('/none', START, b'')
    assert files(tmp_path / 'bag') == before


def damage(path, kind):
    """Damage a bag."""
    data = (path / 'bag.mcap').read_bytes()
    if kind == 'no metadata':
        (path / 'metadata.yaml').unlink()
    elif kind == 'no data':
        (path / 'bag.mcap').unlink()
    elif kind == 'cut':
        (path / 'bag.mcap').write_bytes(data[:300])
    elif kind == 'empty':
        (path / 'bag.mcap').write_bytes(b'')
    elif kind == 'rubbish':
        (path / 'bag.mcap').write_bytes(data[:50] + b'\xff' * (len(data) - 87) + data[-37:])
    elif kind == 'metadata rubbish':
        (path / 'metadata.yaml').write_bytes(b'\xff[:')
    else:
        shutil.rmtree(path)


@pytest.mark.parametrize('kind', ['no metadata', 'no data', 'cut', 'empty', 'rubbish',
                                  'metadata rubbish', 'no folder'])
def test_what_is_no_bag(tmp_path, kind):
    """What cannot be read is refused with one line that names it."""
    with BagWriter(tmp_path / 'bag', TOPICS) as writer:
        fill(writer, 0, 10)
    damage(tmp_path / 'bag', kind)
    with pytest.raises(InputError) as caught:
        list(read_bag_messages(tmp_path / 'bag'))
    assert len(str(caught.value).splitlines()) == 1
    assert str(tmp_path / 'bag') in str(caught.value)
