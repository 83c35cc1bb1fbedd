# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A parameter that ends at its bound is reported, for it may stand in for something else."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from quad_ident_ros.diagnose import fitted
from quad_ident_ros.diagnose.advice import at_bounds
from quad_ident_ros.diagnose.candidates import Candidate, candidates, usual_forms
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.greybox.parameters import INDEX, limits, nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
COLUMNS = tuple(INDEX[f'inertia_mismatch.factor_{axis}'] for axis in 'xyz')
INERTIA = Candidate('inertia_mismatch', 'factors', COLUMNS)


def told(**values):
    z = nominal(VEHICLE)
    for name, value in values.items():
        z[INDEX[f'inertia_mismatch.{name}']] = value
    model = SimpleNamespace(effects=(INERTIA,), z=z)
    return at_bounds(SimpleNamespace(model=model, stand_ins=()), VEHICLE, RULES)


def test_a_parameter_at_its_bound_is_named_with_its_value():
    bound = limits(VEHICLE)[1, COLUMNS[0]]
    [one] = told(factor_x=bound, factor_y=1.2)
    assert one['where'] == 'inertia_mismatch' and one['severity'] == 'warning'
    assert f'factor_x {bound:.3g} is the bound' in one['message']
    assert 'factor_y' not in one['message']


@pytest.mark.parametrize('values', [{}, {'factor_x': 1.3}])
def test_parameters_inside_their_bounds_or_without_an_effect_are_not(values):
    assert told(**values) == ()


@pytest.mark.slow
def test_an_effect_that_needs_values_no_vehicle_has_is_not_named():
    """Ten times the inertia is nothing that a vehicle file gets wrong."""
    flights = [fly_closed_loop(VEHICLE, {}, path, duration=15.0, rate=100.0, seed=seed,
                               noise=MOCAP_IMU)
               for seed, path in enumerate(('figure8', 'lissajous', 'low_passes'))]
    ixx, iyy, izz = VEHICLE.inertia
    told = diagnose(flights, replace(VEHICLE, inertia=(ixx / 10.0, iyy / 10.0, izz)))
    row = next(row for row in told.ranking if row.effect == 'inertia_mismatch')
    assert 'inertia_mismatch' not in told.verdict and 'unknown' in told.verdict
    assert row.probability == RULES.prior_probability
    assert any(finding['code'] == 'at_bound' and 'not named' in finding['message']
               for finding in told.findings)


@pytest.mark.slow
def test_air_that_rises_faster_than_steady_air_does_is_no_wind():
    """It can be simulated, but over ground something else does what it does."""
    updraft = {'wind': {'z': 3.0}, 'body_drag': {'horizontal': 0.02, 'vertical': 0.02}}
    flights = [fly_closed_loop(VEHICLE, updraft, path, duration=10.0, rate=100.0, seed=seed,
                               noise=MOCAP_IMU)
               for seed, path in enumerate(('figure8', 'lissajous'))]
    told = diagnose(flights, VEHICLE)
    row = next(row for row in told.ranking if row.effect == 'wind')
    assert 'wind' not in told.verdict and told.gap.before['velocity'] > 0.1
    assert not row.parameters or abs(row.parameters['z'].value) <= 1.0


def within_bounds(chosen, column, usual, monkeypatch):
    """Return fitted.within_bounds of a set that wants to have a parameter beyond its bound."""
    z = nominal(VEHICLE)
    z[column] = limits(VEHICLE)[1, column]
    fit = SimpleNamespace(z=z, nuisances=None, starts=None)
    monkeypatch.setattr(fitted, 'refitted', lambda flights, vehicle, z, *_, **__:
                        SimpleNamespace(z=z, nuisances=None, starts=None))
    return fitted.within_bounds(chosen, fit, usual, [], VEHICLE, [], RULES)


def test_a_form_of_a_rotor_at_its_bound_gives_way_to_the_usual_one_of_the_same_rotor(monkeypatch):
    causes = candidates([], VEHICLE, RULES, ['rotor_fault'])
    [both] = [one for one in causes if (one.form, one.rotor) == ('thrust_and_torque', 2)]
    [column] = both.columns
    chosen, again = within_bounds((both,), column, usual_forms(causes), monkeypatch)
    assert [(one.form, one.rotor) for one in chosen] == [('thrust', 2)]
    assert again.z[column] == 0.0


def test_a_form_at_its_bound_is_left_out_where_its_usual_one_cannot_be_told(monkeypatch):
    """Where the weight determines the level of thrust, thrust_scale has its offset alone."""
    offset = INDEX['thrust_scale.offset']
    curve = Candidate('thrust_scale', 'thrust_scale offset', (offset,), 'offset', usual=False)
    chosen, again = within_bounds((curve, INERTIA), offset, {}, monkeypatch)
    assert chosen == (INERTIA,) and again.z[offset] == nominal(VEHICLE)[offset]
