# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the constants of the vehicle file leave open is in the standard errors."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose import bench
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
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
