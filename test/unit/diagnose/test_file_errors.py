# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the constants of the vehicle file leave open is in the standard errors."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose import bench
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.file_errors import with_constants
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.normal import Normal
from quad_ident_ros.greybox.parameters import constants_behind, INDEX
from quad_ident_ros.model.vehicle import load_vehicle, Rotor

VEHICLE = load_vehicle('hummingbird')
OFFSET = 0.002      # m, of the centre of mass
LARGER = 1.05       # inertia, arms and torque of the file: alike, so that no ratio shows it


def file_of(factor, **stated):
    """Return the vehicle file with moments and inertia times a factor."""
    return replace(
        VEHICLE, inertia=tuple(factor * one for one in VEHICLE.inertia),
        torque_coefficient=factor * VEHICLE.torque_coefficient,
        rotors=tuple(Rotor(tuple(factor * one for one in rotor.position), rotor.spin)
                     for rotor in VEHICLE.rotors), uncertainty=stated)


@pytest.fixture(scope='module')
def flights():
    return [fly_closed_loop(VEHICLE, {'com_offset': {'x': OFFSET}}, course, duration=10.0,
                            seed=seed, noise=SENSORS['mocap_imu'])
            for seed, course in enumerate(('lissajous', 'figure8', 'lissajous'))]


def offset(flights, vehicle):
    found = diagnose(flights, vehicle)
    assert found.verdict == ('com_offset',)
    return found.ranking[0].parameters['x']


@pytest.mark.slow
def test_an_offset_beside_arms_that_are_off_is_known_as_well_as_the_arms(flights):
    # A larger vehicle of the same motion has the centre of mass as much further out.
    value = offset(flights, file_of(LARGER))
    assert value.value == pytest.approx(LARGER * OFFSET, rel=0.01)
    assert abs(value.value - OFFSET) < 2.0 * value.std < 0.1 * OFFSET


@pytest.mark.slow
def test_a_file_that_knows_its_constants_leaves_nothing_open(flights):
    sure = {'inertia': tuple(1e-4 * one for one in VEHICLE.inertia),
            'torque_coefficient': 1e-4 * VEHICLE.torque_coefficient,
            **{f'rotors[{k}].position': (1e-5,) * 3 for k in range(4)}}
    value = offset(flights, file_of(1.0, **sure))
    assert abs(value.value - OFFSET) < 4.0 * value.std < 0.02 * OFFSET


def test_arms_whose_error_is_taken_out_count_as_those_of_the_file(monkeypatch):
    def errors(chosen, fit, *_args):
        return np.full(len(fit.columns), 0.1 if 'arms' in chosen else 0.2)

    monkeypatch.setattr(bench, 'errors_by_file', errors)
    offset, arms, gyro = (INDEX[name] for name in (
        'com_offset.x', 'inertia_mismatch.arms_x', 'rotor_gyro.rotor_inertia'))
    best, named = (SimpleNamespace(chosen=chosen, estimate=SimpleNamespace(columns=columns))
                   for chosen, columns in ((('offset', 'arms', 'gyro'), [offset, arms, gyro]),
                                           (('offset',), [offset])))
    selection = SimpleNamespace(best=best, sizes=(0.0, 0.0), joint=SimpleNamespace(form_error=0.0))
    found = bench.Bench([], (), VEHICLE, selection, None, None).errors_by_file(named)
    # An error of the arms is one of the file itself.
    assert found == {offset: 0.2, gyro: 0.1}


def test_a_parameter_that_stands_for_a_constant_has_its_deviation():
    # The residual shows a parameter and twice a constant, whose sum alone is known, to 0.01.
    slopes, weight = np.array([1.0, 2.0]), 1e4
    known = Normal(weight * np.outer(slopes, slopes), np.zeros(2), 0.0, np.zeros((1, 2)))
    held, whole = with_constants(known, np.array([0.3]), np.ones(2))
    assert held == pytest.approx(np.array([[1.0 / weight]]))
    assert whole == pytest.approx(np.array([[1.0 / weight + 4.0 * 0.09, -2.0 * 0.09],
                                            [-2.0 * 0.09, 0.09]]))


def test_a_constant_that_is_known_exactly_hides_none_of_the_others():
    # Beside the constant of 0.3 a tiny one, as a drag of a millionth.
    slopes, weight = np.array([1.0, 2.0, 1.0]), 1e4
    known = Normal(weight * np.outer(slopes, slopes), np.zeros(3), 0.0, np.zeros((1, 3)))
    _, whole = with_constants(known, np.array([0.3, 1e-9]), np.ones(3))
    assert np.sqrt(np.diag(whole)) == pytest.approx([np.hypot(0.01, 0.6), 0.3, 1e-9])


def test_what_flights_would_rather_have_counts_as_an_error():
    # The constant shows by itself, 0.2 off; the parameter goes with it.
    weight = 1e4
    information = weight * (np.outer([1.0, 2.0], [1.0, 2.0]) + np.diag([0.0, 1.0]))
    known = Normal(information, information @ [-0.4, 0.2], 0.0, np.zeros((1, 2)))
    held, whole = with_constants(known, np.array([1.0]), np.ones(2))
    assert held[0, 0] == pytest.approx(1.0 / weight)
    assert whole[0, 0] == pytest.approx(0.4 ** 2, rel=0.01)


def test_a_file_without_deviations_is_known_to_some_percent():
    found = constants_behind(VEHICLE, [INDEX['com_offset.x']], 0.05, 0.2)
    assert not {'mass', 'thrust_coefficient', 'gravity'} & {*found}
    assert found['inertia_y'] == pytest.approx(0.05 * VEHICLE.inertia[1])
    assert found['inertia_mismatch.arms_x'] == 0.05


def test_what_is_estimated_or_stated_is_not_guessed():
    estimated = [INDEX[f'inertia_mismatch.{name}'] for name in ('factor_x', 'arms_x')]
    vehicle = replace(VEHICLE, uncertainty={'mass': 0.01, 'inertia': (None, 1e-5, None)})
    found = constants_behind(vehicle, estimated, 0.05, 0.2)
    assert not {'inertia_x', 'inertia_mismatch.arms_x', 'inertia_mismatch.arms_y'} & {*found}
    assert found['mass'] == 0.01 and found['inertia_y'] == 1e-5


@pytest.mark.parametrize('axis', [0, 1])
def test_arms_are_known_as_well_as_the_places_of_the_rotors(axis):
    stated = {f'rotors[{k}].position': (0.001, 0.001, None) for k in range(4)}
    places = [rotor.position[axis] for rotor in VEHICLE.rotors]
    found = constants_behind(replace(VEHICLE, uncertainty=stated), [], 0.05, 0.2)
    # The factor that fits best to places with independent errors of 1 mm.
    assert found[f'inertia_mismatch.arms_{"xy"[axis]}'] == pytest.approx(
        0.001 / np.linalg.norm(places))


def test_arms_of_a_plus_are_known_by_the_rotors_that_are_along_them():
    plus = load_vehicle('paper_quadrotor')
    stated = {f'rotors[{k}].position': (0.001, None, None) if k % 2 == 0 else (None, 0.001, None)
              for k in range(4)}
    found = constants_behind(replace(plus, uncertainty=stated), [], 0.05, 0.2)
    for axis in 'xy':
        assert found[f'inertia_mismatch.arms_{axis}'] == pytest.approx(
            0.001 / np.sqrt(2.0) / plus.arm_length)
