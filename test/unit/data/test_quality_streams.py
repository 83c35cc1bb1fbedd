# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams that are dead, have a wrong sign or are of something else: no verdict stands on them."""

import re

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest
from quality_records import CMD
from scipy.spatial.transform import Rotation

from quad_ident_ros.data.quality import cautions, findings
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.attitude import product


def columns(record, names, change):
    return changed(record, **{name: change(record.columns[name]) for name in names})


def dead(values):
    return np.full_like(values, values[0])


def second_half(values):
    return np.where(np.arange(len(values)) < len(values) // 2, values, 0.0)


GRAVE = {
    'dead, rate': (('wx', 'wy', 'wz'), dead),
    'dead, velocity': (('vx', 'vy', 'vz'), dead),
    'dead, position': (('px', 'py', 'pz'), dead),
    'dead, attitude': (('qw', 'qx', 'qy', 'qz'), dead),
    'frame_sign, height': (('pz',), np.negative),
    'frame_sign, speed': (('vx',), np.negative),
    'frame_sign, mirrored': (('px', 'vx'), np.negative),
    'frame_sign, z down alone': (('pz', 'vz'), np.negative),
    'frame_sign, gyro': (('wy',), np.negative),
    'negative, speeds': (CMD, np.negative),
    'thrust, none': (CMD, lambda values: 1e-3 * values),
    'thrust, none in the end': (CMD, second_half),
    'thrust, too much': (CMD, lambda values: 5.0 * values),
    'saturation, one rotor': (('cmd2',), lambda values: np.full_like(values, VEHICLE.speed_min)),
    'no_voltage, none': (('vbat',), np.zeros_like),
}


@pytest.mark.slow
@pytest.mark.parametrize('fault', GRAVE)
def test_a_record_without_a_stream_bears_no_verdict(fault):
    record = changed(flight(), vbat=np.full(len(flight()), 16.0))
    wrong = columns(record, *GRAVE[fault])
    code = fault.partition(',')[0]
    [found] = [one for one in findings(wrong, VEHICLE) if one.code == code][:1]
    assert found.severity == 'error'
    with pytest.raises(InputError):
        cautions(wrong, VEHICLE)


def test_the_record_with_all_its_streams_bears_one():
    record = changed(flight(), vbat=np.full(len(flight()), 16.0))
    assert cautions(record, VEHICLE) == []


@pytest.mark.slow
def test_a_voltage_that_drops_out_is_a_warning():
    """The median of it is that of the battery."""
    record = flight()
    for lost in (-1.0, 0.0):
        voltage = np.where((record.t > 15.0) & (record.t < 18.4), lost, 16.0)
        [found] = [one for one in findings(changed(record, vbat=voltage), VEHICLE)
                   if one.code == 'no_voltage']
        assert found.severity == 'warning' and '17.0 %' in found.message
        assert 't = 15.010 s' in found.where
        assert '--to 15' in found.remedy


def test_commands_that_never_change_are_a_warning():
    record = flight()
    usual = {name: np.full(len(record), VEHICLE.hover_speed) for name in CMD}
    [found] = [one for one in findings(changed(record, **usual), VEHICLE) if one.code == 'dead']
    assert found.severity == 'warning' and found.where == 'cmd1 to cmd4'


def test_few_samples_a_second_are_a_warning():
    record = fly_closed_loop(VEHICLE, {}, 'lissajous', duration=10.0, rate=100.0, seed=1)
    thin = type(record)(record.t[::5], {name: values[::5] for name, values in
                                        record.columns.items()}, record.info)
    [found] = [one for one in cautions(thin, VEHICLE) if one['code'] == 'coarse']
    assert '0.05 s' in found['message']


@pytest.mark.slow
def test_a_vehicle_that_stands_needs_no_thrust():
    """Records begin on the ground, with the motors off."""
    record = flight()
    rest = 300
    stood = {name: np.concatenate([np.full(rest, values[0]), values])
             for name, values in record.columns.items()}
    for name in (*CMD, 'vx', 'vy', 'vz', 'wx', 'wy', 'wz'):
        stood[name][:rest] = 0.0
    t = np.concatenate([record.t[0] + record.period() * np.arange(-rest, 0), record.t])
    found = findings(type(record)(t, stood, record.info), VEHICLE)
    assert not [one for one in found if one.code == 'thrust']


def turned(record, degrees):
    """Return a record whose attitude has another heading, and its gyro none."""
    half = np.radians(degrees) / 2
    q = product(np.array([np.cos(half), 0.0, 0.0, np.sin(half)]), record.stack(*QUATERNION))
    return changed(record, **dict(zip(QUATERNION, q.T, strict=True)))


@pytest.mark.parametrize(('degrees', 'measured', 'severity'), [
    (8.0, True, 'warning'), (25.0, True, 'warning'), (-63.0, True, 'error'),
    (120.0, True, 'error'), (175.0, True, 'error'), (63.0, False, 'warning'),
    (-120.0, False, 'error')])
def test_a_heading_that_is_of_another_source_is_found(degrees, measured, severity):
    """A compass beside motion capture, or a map that a drone began at any heading."""
    record = turned(flight(), degrees)
    record = record if measured else changed(record, ax=None, ay=None, az=None)
    [found] = [one for one in findings(record, VEHICLE) if one.severity != 'info']
    assert (found.code, found.severity) == ('heading', severity)
    said = float(re.search(r'by (-?[0-9]+) deg', found.message)[1])
    assert said == pytest.approx(-degrees, abs=3.0)


@pytest.mark.parametrize('measured', [True, False])
def test_drag_on_a_circle_is_no_heading(measured):
    """It lies along the velocity, a quarter turn ahead of the force that bends the path."""
    record = fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.3}}, 'circle',
                             duration=10.0, seed=1)
    record = record if measured else changed(record, ax=None, ay=None, az=None)
    assert 'heading' not in [one.code for one in findings(record, VEHICLE)]


@pytest.mark.parametrize('name', ['circle', 'lissajous', 'hover'])
def test_clocks_and_noise_are_no_heading(name):
    """On a circle the force turns while a late stream is on its way, and hover has noise alone."""
    record = fly_closed_loop(VEHICLE, {}, name, duration=15.0, seed=3, noise=SENSORS['faulty'])
    assert 'heading' not in [one.code for one in findings(record, VEHICLE)]


def test_a_wide_circle_nose_first_has_no_world_with_y_up():
    """Its y axis points to where the path bends, and drag hides the lean that bends it."""
    t = np.arange(0.0, 40.0, 0.02)
    angle = 0.16 * t
    place = np.column_stack([50 * np.cos(angle), 50 * np.sin(angle), np.full_like(t, 10.0)])
    speed, bend = (np.gradient(place, t, axis=0),
                   np.gradient(np.gradient(place, t, axis=0), t, axis=0))
    up = bend + 0.3 * speed + [0.0, 0.0, 9.81]
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    left = np.cross(up, speed)
    left /= np.linalg.norm(left, axis=1, keepdims=True)
    q = Rotation.from_matrix(np.stack([np.cross(left, up), left, up], axis=2)).as_quat()
    record = FlightRecord(t, {
        **dict(zip(('px', 'py', 'pz'), place.T, strict=True)),
        **dict(zip(('vx', 'vy', 'vz'), speed.T, strict=True)),
        **dict(zip(QUATERNION, np.roll(q, 1, axis=1).T, strict=True))})
    assert 'frame_y_up' not in [one.code for one in findings(record)]
