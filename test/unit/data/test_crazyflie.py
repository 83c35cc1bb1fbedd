# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights in the micro-SD logs of a Crazyflie."""

import json
from pathlib import Path
import random

from flightmaker import VEHICLE
from fuzz_readers import mutate
import numpy as np
import pytest
from reader_checks import CMD, refused, SMALL
from usd_files import crazyflie_events, packed, usdlog

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.load import contents_of, load
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import conjugate, euler_from_quaternion, product, rotate

DUTY = mapping_from({'actuators': {'kind': 'pwm', 'minimum': 0, 'maximum': 65535}}, 'm')
MOTORS = 65535 * (SMALL.stack(*CMD) - 100) / 1600
PLACE = Path('shared') / 'flights' / 'crazyflie_usd'
REAL = next((folder / PLACE for folder in Path(__file__).resolve().parents
             if (folder / PLACE).is_dir()), None)


def file(tmp_path, data, name='log00'):
    """Write the bytes of a log and return its path."""
    (tmp_path / name).write_bytes(data)
    return tmp_path / name


@pytest.mark.parametrize('version', [1, 2])
def test_a_log_gives_the_flight_in_enu_and_flu(tmp_path, version):
    path = file(tmp_path, usdlog(crazyflie_events(SMALL, MOTORS), version))
    read = load(path, DUTY, VEHICLE)
    assert read.info['start_ns'] == 3_000_000_000
    np.testing.assert_allclose(read.t, SMALL.t, atol=1e-9)
    for names, bound in ((('px', 'py', 'pz', 'vx', 'vy', 'vz'), 2e-7),
                         (('wx', 'wy', 'wz'), 1e-6), (('ax', 'ay', 'az'), 3e-6), (CMD, 0.02),
                         (('qw', 'qx', 'qy', 'qz'), 1e-6), (('vbat',), 0.01)):
        np.testing.assert_allclose(read.stack(*names)[:80], SMALL.stack(*names)[:80], atol=bound)
    assert any('1 front right' in note for note in read.info['notes'])
    assert any('pm.state' in note for note in read.info['notes'])


def test_rates_force_and_outputs_alone_are_a_flight(tmp_path, capsys):
    path = file(tmp_path, usdlog(crazyflie_events(SMALL, MOTORS)[:1]))
    read = load(path)
    assert list(read.columns) == ['wx', 'wy', 'wz', 'ax', 'ay', 'az', 'output1', 'output2',
                                  'output3', 'output4']
    np.testing.assert_array_equal(read.columns['output4'], np.round(MOTORS[:, 3]))
    for name in ('out.csv', 'out.mcap'):
        assert main(['convert', str(path), str(tmp_path / name)]) == 0
        np.testing.assert_array_equal(load(tmp_path / name).columns['wy'], read.columns['wy'])
    capsys.readouterr()
    assert main(['info', str(path), '--json', '-']) == 0
    data = json.loads(capsys.readouterr().out)
    assert not [entry for entry in data['findings'] if entry['severity'] == 'error']


def _state(names, values):
    return [(5, 'state', tuple(f'{name}(f)' for name in names), 1.0 + SMALL.t, values)]


def test_angles_are_read_with_the_sign_of_bitcrazes_pitch(tmp_path):
    quaternion = SMALL.stack('qw', 'qx', 'qy', 'qz')
    angles = np.degrees(euler_from_quaternion(quaternion)) * [1, -1, 1]
    for group in ('stateEstimate', 'stabilizer'):
        names = [f'{group}.{name}' for name in ('roll', 'pitch', 'yaw')]
        read = load(file(tmp_path, usdlog(_state(names, angles))))
        same = np.sum(read.stack('qw', 'qx', 'qy', 'qz') * quaternion, axis=1)
        np.testing.assert_allclose(np.abs(same), 1.0, atol=1e-12)


def test_the_kalman_filters_velocity_is_turned_into_the_world(tmp_path):
    quaternion = SMALL.stack('qw', 'qx', 'qy', 'qz')
    body = rotate(conjugate(quaternion), SMALL.stack('vx', 'vy', 'vz'))
    names = [*(f'kalman.state{n}' for n in ('X', 'Y', 'Z', 'PX', 'PY', 'PZ')),
             *(f'kalman.q{k}' for k in range(4))]
    values = np.hstack([SMALL.stack('px', 'py', 'pz'), body, quaternion])
    read = load(file(tmp_path, usdlog(_state(names, values))))
    for columns in (('px', 'py', 'pz'), ('vx', 'vy', 'vz'), ('qw', 'qx', 'qy', 'qz')):
        np.testing.assert_allclose(read.stack(*columns), SMALL.stack(*columns), atol=1e-6)


def test_the_packed_state_is_read(tmp_path):
    """The largest entry of the quaternion is any of the four; the pitch rate has another sign."""
    q = SMALL.stack('qw', 'qx', 'qy', 'qz')
    turns = np.eye(4)[np.arange(len(q)) % 4]
    q = product(turns, q)
    rates = 1e3 * SMALL.stack('wx', 'wy', 'wz') * [1, -1, 1]
    names = ('quat(I)', 'rateRoll(h)', 'ratePitch(h)', 'rateYaw(h)', 'x(h)', 'y(h)', 'z(h)')
    rows = np.column_stack([packed(q), np.clip(rates, -32000, 32000),
                            1e3 * SMALL.stack('px', 'py', 'pz')])
    read = load(file(tmp_path, usdlog([(5, 'z', tuple(f'stateEstimateZ.{name}' for name in names),
                                        1.0 + SMALL.t, rows)])))
    dot = np.sum(read.stack('qw', 'qx', 'qy', 'qz') * q, axis=1)
    assert np.degrees(2 * np.arccos(np.minimum(np.abs(dot), 1.0))).max() < 0.3
    np.testing.assert_allclose(read.stack('wx', 'wy', 'wz'), SMALL.stack('wx', 'wy', 'wz'),
                               atol=1e-3)
    np.testing.assert_allclose(read.stack('px', 'py', 'pz'), SMALL.stack('px', 'py', 'pz'),
                               atol=1e-3)


def test_the_pose_of_motion_capture_does_where_no_estimate_is_logged(tmp_path):
    names = ('x', 'y', 'z', 'qw', 'qx', 'qy', 'qz')
    columns = ('px', 'py', 'pz', 'qw', 'qx', 'qy', 'qz')
    read = load(file(tmp_path, usdlog(_state([f'locSrv.{name}' for name in names],
                                             SMALL.stack(*columns)))))
    np.testing.assert_allclose(read.stack(*columns[:3]), SMALL.stack(*columns[:3]), atol=1e-6)
    assert read.has(*columns)


def test_contents_tell_what_an_event_could_be_read_for(tmp_path):
    title, streams = contents_of(file(tmp_path, usdlog(crazyflie_events(SMALL, MOTORS))))
    assert title == 'a Crazyflie log (micro-SD card)'
    by_name = {content.name: content for content in streams}
    fixed = by_name['fixedFrequency']
    assert fixed.samples == len(SMALL) and fixed.rate == pytest.approx(100)
    assert fixed.roles == ('rate', 'specific_force', 'commands')
    assert fixed.fields[0] == 'acc.x (f)'
    assert by_name['estimate'].roles == ('pose', 'velocity')
    assert by_name['battery'].roles == ('battery',)
    assert by_name['landed'].samples == 1 and by_name['landed'].roles == ()


def test_a_log_that_was_cut_off_is_read_up_to_there(tmp_path):
    whole = usdlog(crazyflie_events(SMALL, MOTORS)[:1], checksum=False)
    read = load(file(tmp_path, whole[:-7]))
    assert len(read) == len(SMALL) - 1
    assert any('checksum' in note for note in read.info['notes'])


def test_a_log_that_is_damaged_is_read_up_to_there(tmp_path):
    data = bytearray(usdlog(crazyflie_events(SMALL, MOTORS)[:1]))
    row = 10 + 6 * 4 + 3 * 2 + 4
    data[-4 - 40 * row:-2 - 40 * row] = b'\x31\x77'
    read = load(file(tmp_path, bytes(data)))
    assert len(read) == len(SMALL) - 40
    assert any('damaged at byte' in note for note in read.info['notes'])


def test_bad_logs_are_refused(tmp_path):
    events = crazyflie_events(SMALL, MOTORS)
    whole = usdlog(events)
    refused(file(tmp_path, whole[:22]), 'ends in its header')
    refused(file(tmp_path, whole[:55]), 'name is missing')
    refused(file(tmp_path, whole[:1] + b'\x03\0' + whole[3:]), 'version 3')
    refused(file(tmp_path, usdlog(events[:1], claims=900)), 'Crazyflie')
    refused(file(tmp_path, usdlog([(1, 'e', ('acc.x(z)',), [], [])])), 'acc.x(z)')
    refused(file(tmp_path, usdlog([events[0][:3] + ([], [])])), 'no samples')
    refused(file(tmp_path, usdlog(events[2:])), 'none of the variables', 'pm.state')
    refused(file(tmp_path, usdlog(events[1:2])), 'motor.m1', mapping=DUTY, vehicle=VEHICLE)
    refused(file(tmp_path, whole), 'only actuators', mapping=mapping_from({'body': 'FRD'}, 'm'))
    refused(file(tmp_path, whole), 'speeds', mapping=DUTY)


@pytest.mark.slow
def test_mutated_logs_are_read_or_refused_in_one_line(tmp_path):
    short = SMALL.slice(0, 12)
    valid = usdlog(crazyflie_events(short, MOTORS[:12]))
    for seed in range(400):
        data = mutate(valid, random.Random(seed), [valid])
        path = file(tmp_path, data)
        try:
            load(path, DUTY, VEHICLE)
            contents_of(path)
        except InputError as error:
            assert len(str(error).splitlines()) == 1 and str(path) in str(error)


@pytest.mark.skipif(REAL is None, reason=f'the real logs are not there: {PLACE}')
@pytest.mark.parametrize(('name', 'samples'), [('log10', 50496), ('log16', 47182)])
def test_real_logs_are_read(name, samples):
    read = load(REAL / name)
    assert len(read) == samples and 1.0 / read.period() == pytest.approx(1011, abs=3)
    flying = read.stack('output1', 'output2', 'output3', 'output4').min(axis=1) > 20000
    assert np.median(read.columns['az'][flying]) == pytest.approx(9.8, abs=0.6)
