# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A parameter that ends at its bound is reported, for it may stand in for something else."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose import fitted
from quad_ident_ros.diagnose.advice import at_bounds
from quad_ident_ros.diagnose.candidates import Candidate, candidates, usual_forms
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import bounds
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.greybox.parameters import INDEX, limits, NAMES, nominal, SPLIT
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


def test_what_stands_in_before_minor_effects_come_back_says_where_it_ended():
    z, held = nominal(VEHICLE), nominal(VEHICLE)
    z[[*COLUMNS]], held[[*COLUMNS]] = 1.4, limits(VEHICLE)[1, [*COLUMNS]]
    reported, essential = (SimpleNamespace(effects=(INERTIA,), z=one) for one in (z, held))
    [one] = at_bounds(SimpleNamespace(model=reported, essential=essential, stand_ins=(INERTIA,)),
                      VEHICLE, RULES)
    assert 'without the effects that do not matter' in one['message']
    assert one['message'].endswith('is not named')


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
    # A value that ends at its bound is no estimate, and nothing to draw others around.
    held = {f'inertia_mismatch.{name}' for name, one in row.parameters.items()
            if one.value in limits(told.vehicle)[1]}
    assert held and not held & {*(told.covariance.names if told.covariance else ())}


def test_the_bound_of_no_effect_is_none_however_near():
    drag = Candidate('body_drag', 'planar', tuple(
        INDEX[f'body_drag.{axis}'] for axis in ('horizontal', 'vertical')))
    z, (_, upper, size) = nominal(VEHICLE), limits(VEHICLE)[:, drag.columns]
    for share, held in ((0.005, 1), (0.02, 0)):
        z[[*drag.columns]] = share * size[0], upper[1] - share * size[1]
        assert fitted.columns_at_bounds(drag, z, VEHICLE, RULES) == [*drag.columns[1:]][:held]


def test_only_air_may_move_faster_in_a_simulation_than_flights_can_show():
    lower, upper, _ = limits(VEHICLE)[:, SPLIT:]
    wide = bounds(VEHICLE)
    narrow = np.flatnonzero((lower > wide[0]) | (upper < wide[1]))
    assert [NAMES[SPLIT + place] for place in narrow] == ['wind.z']
    # What a file has is within, so that nothing takes it away.
    updraft = replace(VEHICLE, effects={'wind': {'x': 0.0, 'y': 0.0, 'z': 3.0}})
    z, (lower, upper, _) = nominal(updraft), limits(updraft)
    column = INDEX['wind.z']
    assert z[column] == 3.0 and np.all((lower <= z) & (z <= upper))
    assert (lower[column], upper[column]) == (-1.0, 4.0)


@pytest.mark.slow
def test_air_that_rises_faster_than_steady_air_does_is_no_wind():
    """It can be simulated, but over ground something else does what it does."""
    updraft = {'wind': {'z': 3.0}, 'body_drag': {'horizontal': 0.02, 'vertical': 0.02}}
    flights = [fly_closed_loop(VEHICLE, updraft, path, duration=10.0, rate=100.0, seed=seed,
                               noise=MOCAP_IMU)
               for seed, path in enumerate(('figure8', 'lissajous', 'low_passes'))]
    told = diagnose(flights, VEHICLE)
    assert not {'wind', 'none'} & {*told.verdict}


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
