# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights in the blackbox logs of Betaflight."""

import random
import sys

from blackbox_files import blackbox, rows_of
from flightmaker import VEHICLE
from fuzz_readers import mutate
import numpy as np
import pytest
from reader_checks import CMD, refused, SMALL

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.load import contents_of, load, load_all
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.errors import InputError

pytest.importorskip('orangebox', reason='orangebox is not installed: pip install orangebox')

DSHOT = mapping_from({'actuators': {'kind': 'dshot', 'order': [1, 2, 3, 4]}}, 'm')
MOTORS = 48 + 1999 * (SMALL.stack(*CMD) - 100) / 1600
ROWS = rows_of(SMALL, MOTORS)


def file(tmp_path, data, name='LOG00001.BFL'):
    """Write the bytes of a log and return its path."""
    (tmp_path / name).write_bytes(data)
    return tmp_path / name


def test_a_log_gives_the_flight_in_enu_and_flu(tmp_path):
    read = load(file(tmp_path, blackbox(ROWS)), DSHOT, VEHICLE)
    assert read.info['start_ns'] == 7_000_000_000 and len(read) >= len(SMALL) - 1
    count = len(read)
    np.testing.assert_allclose(read.t, SMALL.t[:count], atol=1e-6)
    for names, bound in ((('wx', 'wy', 'wz'), np.radians(0.51)), (('ax', 'ay', 'az'), 0.003),
                         (CMD, 0.5), (('vbat',), 0.006)):
        np.testing.assert_allclose(read.stack(*names), SMALL.stack(*names)[:count], atol=bound)
    np.testing.assert_allclose(read.stack('rotor1', 'rotor2', 'rotor3', 'rotor4'),
                               SMALL.stack(*CMD)[:count], atol=0.8)
    quaternion = ('qw', 'qx', 'qy', 'qz')
    same = np.sum(read.stack(*quaternion) * SMALL.stack(*quaternion)[:count], axis=1)
    np.testing.assert_allclose(np.abs(same), 1.0, atol=1e-7)
    notes = ' '.join(read.info['notes'])
    assert '1 rear right, 2 front right, 3 rear left, 4 front left' in notes
    assert 'from 48 to 2047' in notes


def test_scales_come_from_the_header(tmp_path):
    plain = load(file(tmp_path, blackbox(ROWS)))
    for headers, factor in (({'gyro_scale': '0x3e800000'}, 0.25),
                            ({'blackbox_high_resolution': 1}, 0.1),
                            ({'gyro_scale': '0x308a3d71'}, None)):
        read = load(file(tmp_path, blackbox(ROWS, **headers)))
        factor = factor or np.degrees(1e6 * np.uint32(0x308a3d71).view(np.float32))
        np.testing.assert_allclose(read.columns['wx'], plain.columns['wx'] * factor, rtol=1e-5)
    np.testing.assert_array_equal(plain.stack('output1', 'output4'), np.round(MOTORS)[
        :len(plain), [0, 3]])
    revision = {'Firmware revision': 'Betaflight 3.5.7 (1) OMNIBUS', 'acc_1G': 'x'}
    read = load(file(tmp_path, blackbox(ROWS, **revision)))
    np.testing.assert_allclose(read.columns['vbat'], 10 * plain.columns['vbat'])
    assert not read.has('ax') and any('acc_1G' in note for note in read.info['notes'])
    read = load(file(tmp_path, blackbox(ROWS, **{'Firmware revision': 'INAV 6.0'})))
    assert not read.has('vbat')


def test_several_logs_are_several_flights(tmp_path):
    later = ROWS.copy()
    later[:, 1] += 60_000_000
    path = file(tmp_path, blackbox(ROWS) + blackbox(later[:50]))
    one, two = load_all(path)
    assert len(one) > 90 and len(two) in (49, 50)
    assert two.info['start_ns'] - one.info['start_ns'] == 60_000_000_000
    assert two.info['name'] == 'LOG00001_2'
    refused(path, '2 flights', 'convert')
    assert main(['convert', str(path), str(tmp_path / 'out.csv')]) == 0
    assert len(read_csv(tmp_path / 'out_2.csv')) == len(two)
    title, streams = contents_of(path)
    assert title == 'a blackbox log of Betaflight' and [s.name for s in streams] == [
        'log 1', 'log 2']
    assert streams[0].rate == pytest.approx(100) and 'gyroADC[0]' in streams[0].fields
    assert set(streams[0].roles) == {'rate', 'specific_force', 'attitude', 'commands', 'rotors',
                                     'battery'}


def test_a_log_that_was_cut_off_is_read_up_to_there(tmp_path):
    whole = blackbox(ROWS, ended=False)
    assert len(load(file(tmp_path, whole))) >= len(SMALL) - 1
    assert len(load(file(tmp_path, whole[:-40]))) >= len(SMALL) - 4


def test_frames_after_a_damaged_one_are_left_out_up_to_the_next_whole_one(tmp_path):
    plain = load(file(tmp_path, blackbox(ROWS)))
    whole = bytearray(blackbox(ROWS))
    middle = len(whole) - 2000
    whole[middle:middle + 6] = b'\xff' * 6
    read = load(file(tmp_path, bytes(whole)))
    assert len(plain) - 34 < len(read) < len(plain)
    rows = np.searchsorted(plain.t, read.t - 1e-7)
    np.testing.assert_allclose(read.columns['wx'], plain.columns['wx'][rows])
    np.testing.assert_allclose(read.columns['output2'], plain.columns['output2'][rows])
    assert any('damaged' in note for note in read.info['notes'])


def test_bad_logs_are_refused(tmp_path):
    whole = blackbox(ROWS)
    head = whole.index(b'\nI') + 1
    refused(file(tmp_path, whole[:head]), 'holds 0 whole frames')
    refused(file(tmp_path, whole[:200]), 'does not define')
    refused(file(tmp_path, whole.replace(b'P interval:1/2', b'P interval:0/0')), 'P interval')
    refused(file(tmp_path, whole.replace(b'P interval:1/2', b'P interval:1/9999999')),
            'P interval')
    for end in (b'\x1c', b'\x0b', b'\r', b'\xc2\x85', b'\xe2\x80\xa8'):   # lines, to Python
        refused(file(tmp_path, whole.replace(b'P interval:1/2', b'P interval:1/' + end + b'2')),
                'P interval')
    refused(file(tmp_path, whole.replace(b'P encoding:9,0,7,7,7', b'P encoding:9,0,10,10,10')),
            'encoding 10', 'blackbox_decode')
    refused(file(tmp_path, whole.replace(b'P encoding:9', b'P encoding:77')), 'header is damaged')
    refused(file(tmp_path, blackbox(ROWS, **{'Firmware type': 'Rotorflight'})), 'helicopter')
    refused(file(tmp_path, whole), 'only actuators', mapping=mapping_from({'world': 'NED'}, 'm'))
    refused(file(tmp_path, whole), 'speeds', mapping=DSHOT)


def test_without_orangebox_a_log_says_what_is_missing(tmp_path, monkeypatch):
    path = file(tmp_path, blackbox(ROWS[:20]))
    for name in [name for name in sys.modules if name.partition('.')[0] == 'orangebox']:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, 'orangebox', None)
    refused(path, "pip install 'quad_ident_ros[betaflight]'")


@pytest.mark.slow
def test_mutated_logs_are_read_or_refused_in_one_line(tmp_path, capfd):
    valid = blackbox(ROWS[:24])
    for seed in range(300):
        path = file(tmp_path, mutate(valid, random.Random(seed), [valid]))
        if not path.read_bytes().startswith(b'H Product:Blackbox'):
            continue
        for use in (lambda path: load_all(path, DSHOT, VEHICLE), contents_of):
            try:
                use(path)
            except InputError as error:
                assert len(str(error).splitlines()) == 1 and str(path) in str(error)
    assert capfd.readouterr().err == ''
