# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compressed flights are read, and files that unpack to anything are refused."""

import gzip
import tracemalloc

from bag_files import imu, odometry, write1
from flightmaker import flight
import lz4.frame
import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import decompress, zstd
from rosbags.typesys import get_typestore, Stores

from quad_ident_ros.data import limits, unpack
from quad_ident_ros.data.bag_file import BagFile, read_bag_messages
from quad_ident_ros.data.export import write_bag
from quad_ident_ros.data.limits import most, size_on_disk
from quad_ident_ros.data.load import load
from quad_ident_ros.data.unpack import TooLarge
from quad_ident_ros.errors import InputError

SMALL = flight(seconds=1.0, noise=0.0)
STORE = get_typestore(Stores.ROS2_JAZZY)
MODES = ((CompressionMode.STORAGE, StoragePlugin.MCAP),
         (CompressionMode.MESSAGE, StoragePlugin.MCAP),
         (CompressionMode.MESSAGE, StoragePlugin.SQLITE3),
         (CompressionMode.FILE, StoragePlugin.MCAP),
         (CompressionMode.FILE, StoragePlugin.SQLITE3))


@pytest.fixture
def small(monkeypatch):
    """Make the limits so small that a test need not write GB."""
    monkeypatch.setattr(limits, 'PART', 1 << 21)
    monkeypatch.setattr(limits, 'SMALL', 1 << 20)


def packed(path, messages, mode, plugin):
    """Write (topic, stamp, message) into a bag that is compressed with zstd."""
    writer = Writer(path, version=9, storage_plugin=plugin)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    connections = {}
    with writer:
        for topic, stamp, message in messages:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], stamp, STORE.serialize_cdr(message, kind))


@pytest.mark.parametrize(('mode', 'plugin'), MODES)
def test_compressed_bags_are_read(tmp_path, mode, plugin):
    write_bag(tmp_path / 'plain', SMALL)
    packed(tmp_path / 'packed', read_bag_messages(tmp_path / 'plain'), mode, plugin)
    read = load(tmp_path / 'packed')
    for name, values in SMALL.columns.items():
        np.testing.assert_array_equal(read.columns[name], values)


@pytest.mark.usefixtures('small')
@pytest.mark.parametrize(('mode', 'plugin'), MODES)
def test_a_bag_that_unpacks_to_anything_is_refused(tmp_path, mode, plugin):
    text = STORE.types['std_msgs/msg/String']('x' * (1 << 25))
    packed(tmp_path / 'bag', [('/altitude', 1, text)], mode, plugin)
    assert size_on_disk(tmp_path / 'bag') < len(text.data) / 500
    with pytest.raises(InputError, match='MB'):
        list(read_bag_messages(tmp_path / 'bag'))


@pytest.mark.usefixtures('small')
def test_messages_that_unpack_to_far_more_than_flights_do_are_refused(tmp_path):
    text = STORE.types['std_msgs/msg/String']('x' * 60_000)
    packed(tmp_path / 'bag', (('/altitude', k, text) for k in range(200)),
           CompressionMode.STORAGE, StoragePlugin.MCAP)
    assert 200 * len(text.data) > most(size_on_disk(tmp_path / 'bag'))
    with pytest.raises(InputError, match='far more than measurements'):
        list(read_bag_messages(tmp_path / 'bag'))


@pytest.mark.parametrize('pack', [zstd.compress, lz4.frame.compress])
def test_a_chunk_is_unpacked_to_the_size_that_it_states_and_no_further(pack):
    name = 'zstd' if pack is zstd.compress else 'lz4'
    data = bytes(range(256)) * 100
    assert decompress(pack(data), name, len(data), 0) == data
    bomb = pack(bytes(1 << 24))
    tracemalloc.start()
    try:
        with pytest.raises(Exception, match='size'):
            decompress(bomb, name, 1000, 0)
        with pytest.raises(TooLarge):
            decompress(bomb, name, limits.PART + 1, 0)
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.slow
@pytest.mark.usefixtures('small')
@pytest.mark.parametrize('line', [b'0' * 100, b'0,0\n'])
def test_a_csv_that_unpacks_to_anything_is_refused(tmp_path, line):
    path = tmp_path / 'f.csv.gz'
    path.write_bytes(gzip.compress(b't,pz\n' + line * (1 << 18)))
    assert path.stat().st_size < 100_000
    with pytest.raises(InputError, match='far more than flights'):
        load(path)


@pytest.mark.slow
@pytest.mark.parametrize('packing', [None, Writer1.CompressionFormat.BZ2])
def test_bags_of_ros1_with_one_topic_after_the_other_unpack_each_chunk_once(
        tmp_path, monkeypatch, packing):
    """As programs write them that convert or merge; by time their chunks take turns."""
    record = flight(seconds=15.0, noise=0.0)
    path = write1(tmp_path / 'f.bag', [*odometry(record), *imu(record)], packing)
    calls = []
    within = unpack.BoundedReader1._within

    def counted(self, machine):
        bounded = within(self, machine)
        return lambda data: calls.append(0) or bounded(data)

    monkeypatch.setattr(unpack.BoundedReader1, '_within', counted)
    with BagFile(path) as bag:
        stamps = [stamp for _, stamp, _ in bag.messages()]
        chunks = len(bag._reader.chunks)
    assert chunks > 1 and len(calls) == chunks
    assert len(stamps) == 2 * len(record) and (np.diff(stamps) >= 0).all()
