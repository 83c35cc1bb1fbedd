# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A wrong kind of file is recognised by its content, and the error says what to give instead."""

from contextlib import suppress
import gzip
import io
import os
import pickle
import socket
import struct
import tarfile
import zipfile

from dataflash_files import dataflash
from flightmaker import flight, VEHICLE
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from reader_checks import FAST, refused, same
from usd_files import usdlog
import yaml

from quad_ident_ros.data.blackbox import MAGIC
from quad_ident_ros.data.csv import read_csv, write_csv
from quad_ident_ros.data.load import contents_of, load, load_all, reader_of
from quad_ident_ros.data.readers.others import is_text
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import vehicle_to_mapping

SHORT = flight(seconds=3.0)


def tar(mode):
    """Return the bytes of a tar archive with one file."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode=mode) as archive:
        archive.addfile(tarfile.TarInfo('log_1.ulg'))
    return packed.getvalue()


def zipped():
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, 'w') as archive:
        archive.writestr('log_1.ulg', 'x')
    return packed.getvalue()


def packet(stamp):
    """Return a message of MAVLink 2 behind its time, as ground stations log them."""
    return struct.pack('>Q', stamp) + b'\xfd\x09\0\0\0\x01\x01\0\0\0' + bytes(11)


XML = b'<?xml version="1.0" encoding="UTF-8"?>\n'
KINDS = {
    'png': (b'\x89PNG\r\n\x1a\n' + bytes(40), 'a picture (PNG)', 'give the log'),
    'jpeg': (b'\xff\xd8\xff\xe0' + bytes(40), 'a picture (JPEG)', 'give the log'),
    'gif': (b'GIF89a' + bytes(40), 'a picture (GIF)', 'give the log'),
    'bmp': (b'BM\x36\x10\0\0' + bytes(4) + b'\x36\0\0\0\x28' + bytes(40), 'a picture (BMP)',
            'give the log'),
    'tiff': (b'II*\0\x08\0\0\0' + bytes(40), 'a picture (TIFF)', 'give the log'),
    'tiff of a Mac': (b'MM\0*\0\0\0\x08' + bytes(40), 'a picture (TIFF)', 'give the log'),
    'webp': (b'RIFF\x24\0\0\0WEBPVP8 ' + bytes(40), 'a picture (WebP)', 'give the log'),
    'heic': (b'\0\0\0\x18ftypheic' + bytes(40), 'a picture (HEIF)', 'give the log'),
    'avi': (b'RIFF\x24\0\0\0AVI LIST' + bytes(40), 'a video', 'give the log'),
    'video': (b'\0\0\0\x18ftypmp42', 'a video', 'give the log'),
    'pdf': (b'%PDF-1.4\n', 'a PDF', 'give the log'),
    'zip': (zipped(), 'a ZIP archive', 'unpack it'),
    '7z': (b'7z\xbc\xaf\x27\x1c' + bytes(40), 'a 7z archive', 'unpack it'),
    'tar': (tar('w'), 'a tar archive', 'unpack it'),
    'tar in gzip': (tar('w:gz'), 'a tar archive', 'unpack it'),
    'ulog in gzip': (gzip.compress(b'ULog\x01\x12\x35\x01' + bytes(90)), 'gzip', 'unpack it'),
    'bzip2': (b'BZh91AY&SY', 'bzip2', 'unpack it'), 'xz': (b'\xfd7zXZ\0\0', 'xz', 'unpack it'),
    'zstd': (b'\x28\xb5\x2f\xfd\0', 'zstd', 'unpack it'),
    'elf': (b'\x7fELF\x02\x01' + bytes(40), 'a program', 'give the log'),
    'excel': (b'\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1', 'Microsoft Office', 'as CSV'),
    'matlab': (b'MATLAB 5.0 MAT-file, x'.ljust(128, b'\0'), 'MATLAB', 'as CSV'),
    'matlab_hdf5': (b'MATLAB 7.3 MAT-file, x'.ljust(512, b'\0') + b'\x89HDF\r\n\x1a\n', 'MATLAB',
                    'as CSV'),
    'feather': (b'ARROW1\0\0' + bytes(40), 'Arrow', 'Parquet or CSV'),
    'pickle': (pickle.dumps({'t': list(range(40))}), 'pickle of Python', 'CSV or Parquet'),
    'hdf5': (b'\x89HDF\r\n\x1a\n' + bytes(40), 'HDF5', 'CSV or Parquet'),
    'numpy': (b'\x93NUMPY\x01\0', 'NumPy', 'as CSV'),
    'lfs': (b'version https://git-lfs.github.com/spec/v1\noid sha256:ab\n', 'Git LFS', 'pull'),
    'html': (b'<!DOCTYPE html>\n<html><body>404</body></html>\n', 'HTML', 'download'),
    'kml': (XML + b'<kml xmlns="http://www.opengis.net/kml/2.2">\n', 'KML', 'the log'),
    'gpx': (XML + b'<gpx version="1.1">\n', 'GPX', 'the log'),
    'xml': (XML + b'<sdf version="1.6">\n', 'XML', 'give the log'),
    'json': (b'{"schema": "x",\n "y": [1, 2]}\n', 'JSON', 'give the log'),
    'json list': (b'[\n {"t": 0},\n {"t": 1}\n]\n', 'JSON', 'give the log'),
    'yaml': (b'# iris\nname: iris\nrotors:\n- position: [0, 0, 0]\n  spin: 1\n', 'YAML',
             '--vehicle and --mapping'),
    'bag list': (b'rosbag2_bagfile_information:\n  version: 5\n', 'ROS 2', 'give the folder'),
    'console': (b'INFO  [logger] logger started\nWARN  [commander] low battery\n', 'console',
                'give the .ulg file'),
    'boot': (b'HW arch: PX4_FMU_V5\nFW git-hash: ab\n', 'console', 'give the .ulg file'),
    'tlog': (packet(1_700_000_000_000_000) + packet(1_700_000_000_200_000), 'MAVLink',
             'give the log of the vehicle itself'),
    'dataflash as text': (b'FMT, 128, 89, FMT, BBnNZ, Type,Length\n', 'ArduPilot', '.BIN'),
    'utf-16': ('t,px\n0,1\n1,2\n'.encode('utf-16'), 'UTF-16', 'as UTF-8'),
    'zeros': (bytes(5000), 'zeros', 'copy it from the vehicle again'),
    'noise': (np.random.default_rng(0).bytes(600), 'this kind of file is not known', 'ULog'),
    'empty': (b'', 'empty', 'again'),
}


NAMES = ('flight.csv', 'log', 'log.ulg', 'f.mcap', 'f.bag', 'f.BIN')
CASES = [(kind, name) for kind in KINDS for name in NAMES
         if kind != 'noise' or not name.endswith(('ulg', 'mcap', 'bag'))]   # a damaged one


@pytest.mark.parametrize(('kind', 'name'), CASES)
def test_a_wrong_kind_is_told_by_its_content(kind, name, tmp_path):
    content, *words = KINDS[kind]
    (tmp_path / name).write_bytes(content)
    refused(tmp_path / name, *words)
    with pytest.raises(InputError, match='this is|this kind|empty'):
        contents_of(tmp_path / name)


def test_an_old_log_of_px4_is_told(tmp_path):
    pytest.importorskip('pymavlink', reason='pymavlink is not installed')

    def definition(kind, size, name, letters, labels):
        return (b'\xa3\x95\x80' + bytes([kind, size]) + name.ljust(4, b'\0')
                + letters.ljust(16, b'\0') + labels.ljust(64, b'\0'))
    (tmp_path / 'a.px4log').write_bytes(
        definition(2, 55, b'ATT', b'fffffffffffff', b'qw,qx,qy,qz,Roll')
        + definition(129, 11, b'TIME', b'Q', b'StartTime') + b'\xa3\x95\x81' + bytes(8))
    refused(tmp_path / 'a.px4log', 'this is a log of PX4 before 1.5')


def test_what_is_no_file_is_told_and_never_waited_for(tmp_path):
    os.mkfifo(tmp_path / 'pipe')
    refused(tmp_path / 'pipe', 'a pipe', 'save it to a file')
    refused('/dev/null', 'a device')
    refused('/dev/zero', 'a device')
    refused('/proc/self/environ', 'the file is empty')      # as /proc/kmsg: reading it may wait
    refused(tmp_path / 'none.csv', 'no such file')
    (tmp_path / 'gone').symlink_to('nowhere')
    refused(tmp_path / 'gone', 'no such file')
    here = os.getcwd()
    with socket.socket(socket.AF_UNIX) as end, suppress(OSError):
        os.chdir(tmp_path)      # the path of a socket may have 107 bytes
        end.bind('socket')
        os.chdir(here)
        refused(tmp_path / 'socket', 'a socket')
    os.chdir(here)


def test_a_folder_names_what_is_in_it(tmp_path):
    refused(tmp_path, 'this is a folder', 'no file')
    for k in range(5):
        (tmp_path / f'log_{k}.ulg').write_bytes(b'')
    refused(tmp_path, 'this is a folder', 'log_0.ulg, log_1.ulg, log_2.ulg, ...')
    (tmp_path / 'x_0.mcap').write_bytes(b'')
    refused(tmp_path, 'give the file in it, x_0.mcap', 'ros2 bag reindex')


def test_tables_are_told_by_their_content_too(tmp_path):
    """Packed or not, and with the name of another kind."""
    write_csv(tmp_path / 'f.csv', SHORT)
    for name in ('f.ulg', 'f.mcap', 'f.bag', 'f', 'f.json', 'f.yaml'):
        (tmp_path / name).write_bytes((tmp_path / 'f.csv').read_bytes())
        same(load(tmp_path / name), SHORT)
    (tmp_path / 'packed').write_bytes(gzip.compress((tmp_path / 'f.csv').read_bytes()))
    same(load(tmp_path / 'packed'), SHORT)
    same(read_csv(tmp_path / 'packed'), SHORT)


@pytest.mark.parametrize('suffix', ['.ulg', '.bag', '.mcap', '.db3', '.csv', ''])
def test_logs_are_told_by_their_content_whatever_their_name(suffix, tmp_path):
    contents = {'ardupilot': dataflash([]), 'px4': b'ULog\x01\x12\x35\x01' + bytes(20),
                'crazyflie': usdlog([(0, 'fixed', ('gyro.x(f)',), (0.0,), ((0.0,),))]),
                'rosbag1': b'#ROSBAG V2.0\n\0\1', 'rosbag2': b'\x89MCAP0\r\n\0\1',
                'betaflight': MAGIC + bytes(20), 'parquet': b'PAR1' + bytes(20)}
    for kind, content in contents.items():
        path = tmp_path / f'{kind}{suffix}'
        path.write_bytes(content)
        assert reader_of(path).name == kind


def test_a_damaged_file_is_told_by_its_name(tmp_path):
    for name, kind in (('a.ulg', 'px4'), ('a.bag', 'rosbag1'), ('a.db3', 'rosbag2')):
        (tmp_path / name).write_bytes(bytes(range(1, 250)))
        assert reader_of(tmp_path / name).name == kind


def test_lines_above_a_header_do_not_make_it_another_kind(tmp_path):
    rows = '\n'.join(f'{0.01 * k},{k},{k},{k}' for k in range(20))
    for above in ('---\nvehicle: quad\ndate: today\n', '[motion capture]\n', '# INFO [x]\n'):
        (tmp_path / 'f.csv').write_text(f'{above}time,pos_x,pos_y,pos_z\n{rows}\n')
        assert reader_of(tmp_path / 'f.csv').name == 'csv'
        with suppress(InputError):      # whether it is a flight is another matter
            load_all(tmp_path / 'f.csv')


def test_our_own_vehicle_files_are_yaml(tmp_path):
    (tmp_path / 'v').write_text(yaml.safe_dump(vehicle_to_mapping(VEHICLE)))
    refused(tmp_path / 'v', 'YAML', '--vehicle')


def test_text_is_told_where_a_letter_is_cut():
    whole = 'höher, schneller'.encode()
    assert all(is_text(whole[:k]) for k in range(1, len(whole)))
    assert is_text('\ufeffa'.encode()) and not is_text(b'a\0b') and not is_text(b'\xffab')


@FAST
@given(content=st.binary(max_size=600))
def test_any_content_is_refused_in_one_line_or_read(tmp_path_factory, content):
    path = tmp_path_factory.mktemp('any') / 'f'
    path.write_bytes(content)
    try:
        load_all(path)
    except InputError as error:
        assert len(str(error).splitlines()) == 1 and str(path) in str(error)
