# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is said of the errors of libraries: one line that names the file once, in plain words."""

import errno
import os
import sqlite3
import struct

from bag_files import odometry, write1
from flightmaker import copy_bag, flight
import pytest
from rosbags.rosbag2 import StoragePlugin

from quad_ident_ros.data.export import write_bag
from quad_ident_ros.data.load import contents_of, load_all
from quad_ident_ros.errors import InputError, Reason, reason_of


@pytest.mark.parametrize(('error', 'reason'), [
    (Reason('no definition of geo\n 3'), 'no definition of geo 3'),
    (Reason('a chunk: too large'), 'a chunk: too large'),
    (struct.error('unpack requires a buffer of 8 bytes'), 'it is damaged'),
    (KeyError('version'), 'it is damaged'),
    (RuntimeError("A key is missing KeyError('version')"), 'it is damaged'),
    (RuntimeError('x' * 400), 'it is damaged'),
    (RuntimeError(''), 'it is damaged'),
    (OSError(errno.EACCES, 'Permission denied'), 'Permission denied'),
    (MemoryError(), 'it is damaged and claims more than fits into memory'),
    (RuntimeError('Cannot open database /a/f.db3: malformed'), 'Cannot open database'),
    (RuntimeError('Cannot load\n /a/f.db3/metadata.yaml: line 3'), 'Cannot load metadata.yaml'),
    (RuntimeError('The magic is wrong.'), 'The magic is wrong')])
def test_reason_in_plain_words(error, reason):
    assert reason_of(error, '/a/f.db3') == reason


def _bag(folder, kind):
    record = flight(seconds=0.12, noise=0.0)
    if kind == 'bag':
        return write1(folder / 'one', odometry(record))
    write_bag(folder / 'ours', record)
    if kind == 'folder':
        return folder / 'ours'
    copy_bag(folder / 'ours', folder / 'copy', {
        'mcap': StoragePlugin.MCAP, 'db3': StoragePlugin.SQLITE3}[kind])
    return next((folder / 'copy').glob(f'*.{kind}'))


@pytest.mark.parametrize('kind', ['bag', 'folder', 'mcap', 'db3'])
@pytest.mark.parametrize('read', [contents_of, load_all])
def test_damaged_bag_is_named_once(tmp_path, kind, read):
    path = _bag(tmp_path, kind)
    file = path / 'metadata.yaml' if kind == 'folder' else path
    data = bytearray(file.read_bytes())
    data[100:len(data) // 2] = b':{' * (len(data) // 4)
    file.write_bytes(data)
    with pytest.raises(InputError) as error:
        read(path)
    assert str(error.value).count(str(path)) == 1
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.skipif(os.geteuid() == 0, reason='root may read everything')
@pytest.mark.parametrize('name', ['f.csv', 'f.mcap', 'f.bag', 'f.db3', 'f.ulg', 'f.parquet',
                                  'f.BIN'])
def test_file_without_permission(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(bytes(100))
    path.chmod(0)
    for read in (contents_of, load_all):
        with pytest.raises(InputError, match='Permission denied') as error:
            read(path)
        assert str(error.value).count(str(path)) == 1


@pytest.mark.parametrize('name', ['f.csv', 'f.mcap', 'f.bag', 'f.db3', 'f.ulg', 'f.parquet',
                                  'f.BIN'])
def test_link_to_nowhere(tmp_path, name):
    path = tmp_path / name
    path.symlink_to(tmp_path / 'gone')
    for read in (contents_of, load_all):
        with pytest.raises(InputError) as error:
            read(path)
        assert str(error.value).count(str(path)) == 1


@pytest.mark.parametrize('name', ['folder', 'f.csv', 'f.ulg', 'f.BIN', 'f.parquet'])
def test_folder_that_is_no_bag(tmp_path, name):
    path = tmp_path / name
    path.mkdir()
    for read in (contents_of, load_all):
        with pytest.raises(InputError, match='not a bag of ROS 2') as error:
            read(path)
        assert str(error.value).count(str(path)) == 1


@pytest.mark.parametrize('value', [None, b'\xff\x00'])
@pytest.mark.parametrize('column', ['name', 'type'])
def test_list_of_topics_that_is_no_text(tmp_path, column, value):
    path = _bag(tmp_path, 'db3')
    with sqlite3.connect(path) as database:
        database.execute('CREATE TABLE other AS SELECT * FROM topics')
        database.execute('DROP TABLE topics')
        database.execute('ALTER TABLE other RENAME TO topics')
        database.execute(f'UPDATE topics SET {column} = ?', (value,))
    database.close()
    for read in (contents_of, load_all):
        with pytest.raises(InputError, match='list of topics is damaged') as error:
            read(path)
        assert str(error.value).count(str(path)) == 1
