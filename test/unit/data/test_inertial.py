# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights of which only accelerometer, gyro and commands were logged."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from quad_ident_ros.data.inertial import is_inertial, reckoned, with_position
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.quality.ground import airborne, resting
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.carried import carried
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.greybox.fit import fit
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.vehicle import load_vehicle, vehicle_from_mapping

IRIS = load_vehicle('iris')
G = IRIS.gravity
PLACE = Path('shared') / 'flights' / 'crazyflie_usd'
REAL = next((folder / PLACE for folder in Path(__file__).resolve().parents
             if (folder / PLACE).is_dir()), None)
PATHS = ('chirp_yaw', 'vertical', 'low_passes')
UNTOLD = {name for name, effect in EFFECTS.items()
          if all(form.needs_reference for form in effect.forms)}


def flown(effects=None, path='lissajous', seed=0, duration=10.0, **kind):
    """Return a closed-loop flight at 200 Hz."""
    return fly_closed_loop(IRIS, effects or {}, path, duration=duration, rate=200.0, seed=seed,
                           **kind)


def bare(record):
    """Return a record without position, velocity, attitude, rotor speeds and voltage."""
    return FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                   if name[0] in 'wa' or name.startswith('cmd')}, record.info)


def test_a_turn_in_place_is_reckoned_exactly():
    t = np.arange(0.0, 2.0, 0.005)
    still, rate = np.zeros_like(t), 0.7
    record = FlightRecord(t, {'wx': still, 'wy': still, 'wz': still + rate,
                              'ax': still, 'ay': still, 'az': still + G})
    made = reckoned(record, G)
    np.testing.assert_allclose(made.stack('px', 'py', 'pz', 'vx', 'vy', 'vz'), 0.0, atol=1e-9)
    np.testing.assert_allclose(2.0 * np.arctan2(made.columns['qz'], made.columns['qw']), rate * t,
                               atol=1e-9)


def test_over_half_a_second_reckoned_motion_is_the_true_one():
    record = flown()
    made, half = reckoned(bare(record), G), 100
    true, own = (rotation_matrix(one.stack('qw', 'qx', 'qy', 'qz')) for one in (record, made))
    turns = [np.einsum('nji,njk->nik', one[:-half], one[half:]) for one in (true, own)]
    np.testing.assert_allclose(*turns, atol=2e-3)
    # In the axes of the body at the start gravity is known only as far as the attitude is.

    def changes(one, rotation):
        velocity = one.stack('vx', 'vy', 'vz')
        change = velocity[half:] - velocity[:-half] + [0.0, 0.0, G * half / 200.0]
        return np.einsum('nji,nj->ni', rotation[:-half], change)
    np.testing.assert_allclose(changes(record, true), changes(made, own), atol=0.02)


def test_what_is_inertial():
    record = flown(duration=5.0)
    assert is_inertial(bare(record)) and not is_inertial(record)
    names = [name for name in bare(record).columns if name != 'az']
    assert not is_inertial(FlightRecord(record.t, {name: record.columns[name] for name in names}))


def test_ground_time_and_blows_are_left_out():
    record = bare(flown(duration=8.0))
    columns = {name: np.array(values) for name, values in record.columns.items()}
    for part in (record.t < 1.0, record.t > 6.5):
        for name in columns:
            columns[name][part] = G if name == 'az' else 0.0
    columns['ax'][np.argmin(np.abs(record.t - 6.0))] = 15.0 * G
    mixed = FlightRecord(record.t, columns, record.info)
    kept = airborne(mixed, IRIS)
    assert resting(mixed, IRIS).any()
    assert 1.0 <= kept.t[0] < 1.2 and 5.3 < kept.t[-1] < 5.7
    # In free fall the rotors give little, and the vehicle flies.
    columns = {name: np.array(values) for name, values in record.columns.items()}
    falls = (record.t > 3.0) & (record.t < 4.0)
    for name in columns:
        columns[name][falls] = 0.0
    assert not resting(FlightRecord(record.t, columns, record.info), IRIS).any()


def test_vibration_is_no_blow():
    record = bare(flown(duration=6.0))
    shaken = {name: values + (6.0 * np.random.default_rng(1).standard_normal(len(values))
                              if name[0] == 'a' else 0.0)
              for name, values in record.columns.items()}
    t = record.t / 5.0      # as fast as a log of 1 kHz
    assert not resting(FlightRecord(t, shaken, record.info), IRIS).any()


@pytest.mark.slow
def test_what_needs_a_reference_says_so():
    lone = [bare(flown(seed=seed, duration=6.0)) for seed in range(2)]
    with pytest.raises(InputError, match=r'about steady wind \(wind\).*name other effects'):
        diagnose(lone, IRIS, effects=['wind'])
    with pytest.raises(InputError, match='neither position nor velocity.*diagnose'):
        fit(lone[:1], IRIS, ['mass'])


@pytest.mark.slow
def test_the_drag_of_the_file_does_not_act_beside_the_air_of_the_record():
    """What a written vehicle explains is measured as the diagnosis is."""
    records = [bare(flown(seed=seed, duration=6.0)) for seed in range(2)]
    plain, dragged = (replace(IRIS, linear_drag=(drag, drag, drag)) for drag in (0.0, 0.5))
    lagged = replace(plain, effects={'motor_lag': {'time_constant': 0.05}})
    gaps = [carried(records, one, lagged, {}).gaps['nominal'] for one in (plain, dragged)]
    assert gaps[0] == pytest.approx(gaps[1])


def test_nothing_is_reckoned_over_a_gap():
    record = bare(flown(duration=6.0))
    late = np.where(record.t > 3.0, record.t + 60.0, record.t)
    made = [reckoned(one, G) for one in (record, FlightRecord(late, record.columns))]
    jump = np.flatnonzero(np.diff(late) > 1.0)[0]
    before, after = (made[1].stack('qw', 'qx', 'qy', 'qz')[k] for k in (jump, jump + 1))
    np.testing.assert_allclose(before, after, atol=1e-9)


@pytest.mark.slow
def test_flights_with_and_without_a_pose_do_not_mix():
    whole, lone = flown(duration=5.0), bare(flown(seed=1, duration=5.0))
    with pytest.raises(InputError, match='neither position nor velocity.*separately'):
        diagnose([whole, lone, replace(lone, info={'name': 'third'}, t=lone.t + 1.0)], IRIS)


@pytest.mark.slow
@pytest.mark.parametrize('effects', [
    {'motor_lag': {'time_constant': 0.05}}, {'rotor_fault': {'loss_2': 0.08}},
    {'thrust_scale': {'factor': 1.15}}], ids=lambda effects: next(iter(effects)))
def test_what_motors_do_is_told_without_a_pose(effects):
    [(name, values)] = effects.items()
    flights = [bare(flown(effects, path, seed, 12.0, noise=MOCAP_IMU))
               for seed, path in enumerate(PATHS)]
    told = diagnose(flights, IRIS)
    row = next(row for row in told.ranking if row.effect == name)
    if name == 'thrust_scale':      # only its ratio to the mass shows
        row = max((row for row in told.ranking if row.effect in ('thrust_scale', 'mass_offset')),
                  key=lambda row: row.probability)
    assert row.probability > 0.5
    if row.effect == name:
        [(parameter, value)] = values.items()
        assert row.parameters[parameter].value == pytest.approx(value, rel=0.1)
    assert not UNTOLD & {*told.verdict}
    assert set(told.not_shown) >= UNTOLD
    assert any(finding['code'] == 'inertial' for finding in told.findings)


def test_a_position_that_is_missing_is_the_integral_of_the_velocity():
    record = flown(duration=5.0)
    made = with_position(FlightRecord(record.t, {
        name: values for name, values in record.columns.items() if name[0] != 'p'}))
    moved = record.stack('px', 'py', 'pz') - record.stack('px', 'py', 'pz')[0]
    np.testing.assert_allclose(made.stack('px', 'py', 'pz'), moved, atol=1e-3)
    assert with_position(record) is record


@pytest.mark.slow
def test_a_drag_is_told_without_a_position():
    flights = [flown({'rotor_drag': {'coefficient': 0.4}}, path, seed, 12.0, noise=MOCAP_IMU)
               for seed, path in enumerate(('figure8', 'lissajous', 'low_passes'))]
    told = diagnose([FlightRecord(one.t, {name: values for name, values in one.columns.items()
                                          if name[0] != 'p'}, one.info) for one in flights], IRIS)
    assert told.verdict == ('rotor_drag',)
    value = told.ranking[0].parameters['coefficient']
    assert abs(value.value - 0.4) < 4.0 * value.std
    assert 'ground_effect' in told.not_shown


@pytest.mark.slow
def test_nothing_is_named_where_only_the_air_is_unknown():
    flights = [bare(flown({'rotor_drag': {'coefficient': 0.4}}, path, seed, 20.0, noise=MOCAP_IMU))
               for seed, path in enumerate(PATHS)]
    assert diagnose(flights, IRIS).verdict in (('none',), ('unknown',))


@pytest.mark.slow
@pytest.mark.parametrize('factor', [1.3, 0.8])
def test_inertia_is_told_to_a_fifth_beside_a_drag(factor):
    flights = [bare(flown({'rotor_drag': {'coefficient': 0.4},
                           'inertia_mismatch': dict.fromkeys(('factor_x', 'factor_y'), factor)},
                          path, seed, 20.0, noise=MOCAP_IMU)) for seed, path in enumerate(PATHS)]
    told = diagnose(flights, IRIS)
    row = next(row for row in told.ranking if row.effect == 'inertia_mismatch')
    for axis in 'xy':   # too small, not too large: the controller answers the noise of the gyro
        assert 0.8 * factor < row.parameters[f'factor_{axis}'].value < 1.05 * factor


@pytest.mark.slow
@pytest.mark.skipif(REAL is None, reason=f'the real flights are not there: {PLACE}')
def test_a_real_crazyflie():
    spot = 0.028
    vehicle = vehicle_from_mapping({
        'name': 'crazyflie', 'mass': 0.027, 'gravity': 9.806,
        'inertia': [1.66e-5, 1.66e-5, 2.93e-5],
        'thrust_coefficient': 2.4e-8, 'torque_coefficient': 1.44e-10, 'speed_max': 2500.0,
        'rotors': [{'position': [x * spot, y * spot, 0.0], 'spin': spin} for x, y, spin in
                   ((1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1))],
        'motors': {'kind': 'duty16', 'thrust': {'gain': 0.15, 'exponent': 2}}}, 'vehicle')
    told = diagnose(load_all(REAL / 'log10', vehicle=vehicle), vehicle)
    rows = {row.effect: row for row in told.ranking if row.effect in told.verdict}
    assert {'motor_lag', 'thrust_scale'} <= set(rows)
    # Published for this vehicle: 72 ms, by another method on other parts of the flights.
    late = rows['motor_lag'].parameters['time_constant'].value + (
        rows['actuation_delay'].parameters['delay'].value if 'actuation_delay' in rows else 0.0)
    assert 0.05 < late < 0.09
    # Thrust of a motor by the four published curves and the fit of the square alone.
    at = {name: value.value for name, value in rows['thrust_scale'].parameters.items()}
    u = np.linspace(0.4, 0.9, 6)
    hover = vehicle.hover_speed / 2500.0
    thrust = (at['at_hover'] * 0.027 * 9.806 / 4
              * ((u / hover + at['offset']) / (1.0 + at['offset'])) ** 2)
    curves = np.array([a + b * u + c * u ** 2 for a, b, c in (
        (0.0213, -0.0112, 0.1201), (5.48e-4, 6.77e-2, 9.15e-2), (0.0, 0.0, 0.148),
        (3.75e-4, -1.23e-4, 0.153), (-1.30e-3, 1.75e-3, 0.125))])
    assert (thrust > curves.min(axis=0)).all() and (thrust < curves.max(axis=0)).all()
