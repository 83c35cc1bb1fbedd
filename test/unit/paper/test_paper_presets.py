# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The experiments of the reproduction, and the flights that end before their time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.paper import reference
from quad_ident_ros.paper.divergence import cases
from quad_ident_ros.paper.presets import load_preset

VEHICLE = load_vehicle('paper_quadrotor')


@pytest.fixture(scope='module')
def printed_cases():
    return cases()


@pytest.mark.parametrize('name', ['hover_single_axis', 'small_angle'])
def test_single_axis_flights_are_the_exact_solutions(name):
    preset = load_preset(name)
    assert [entry.output for entry in preset.references] == list(OUTPUTS)
    for entry in preset.references:
        assert entry.t == 5.0
        assert entry.computed == pytest.approx(entry.expected, rel=1e-9)
    assert preset.infeasible is None and preset.truth is None and preset.duration == 5.0


def test_unit_steps_have_the_values_of_adaptive_integrators():
    # The printed model amplifies the last digit of any integration: psi has the fewest.
    for name, count in (('paper_unit_steps_printed', 16), ('paper_unit_steps_newton_euler', 4)):
        preset = load_preset(name)
        assert len(preset.references) == count
        for entry in preset.references:
            assert entry.computed == pytest.approx(entry.expected, rel=1e-6)
        assert 'no rotor speeds' in preset.infeasible


def test_exact_solutions_solve_their_equations():
    moment, inertia, drag = 0.3, 0.02, 0.004
    turn = solve_ivp(lambda t, x: [x[1], (moment - drag * x[1] * abs(x[1])) / inertia],
                     (0, 3), [0, 0], rtol=1e-10, atol=1e-12).y[0, -1]
    assert reference.turned(moment, inertia, drag, 3.0) == pytest.approx(turn, rel=1e-8)
    climb = solve_ivp(lambda t, x: [x[1], (moment - drag * x[1]) / inertia],
                      (0, 3), [0, 0], rtol=1e-10, atol=1e-12).y[0, -1]
    assert reference.climbed(moment, inertia, drag, 3.0) == pytest.approx(climb, rel=1e-8)
    # Shortly before the blow-up the rate is the reciprocal of the time that is left.
    end = reference.blow_up(moment, inertia, drag)
    rate = solve_ivp(lambda t, x: [(moment + drag * x[0] ** 2) / inertia], (0, 0.999 * end), [0],
                     rtol=1e-10).y[0, -1]
    assert inertia / (drag * rate) == pytest.approx(0.001 * end, rel=1e-4)


@pytest.mark.slow
def test_the_long_flight_follows_the_yaw_spin():
    preset = load_preset('paper_unit_steps_newton_euler_500s')
    record, = preset.records
    assert preset.duration == 500.0 and record.period() == pytest.approx(1.0)
    # U4 against friction: the speed sqrt(U4/K), many turns per sample, not one folded.
    steady = np.sqrt(1.0 / VEHICLE.rotational_drag[2])
    np.testing.assert_allclose(np.diff(record.columns['psi'])[5:], steady, rtol=1e-2)
    fit = identify(preset.records, Settings(methods=('pso_cs',), poles='real')).methods['pso_cs']
    psi = fit.outputs['psi']
    assert psi.errors['nrmse_percent'] < 0.1
    assert psi.model.gain / psi.model.a == pytest.approx(steady, rel=0.01)
    # Roll and pitch nutate: no second-order response describes them.
    assert fit.outputs['phi'].errors['nrmse_percent'] > 20


def test_yaw_of_the_printed_model_is_not_folded():
    record, = load_preset('paper_unit_steps_printed').records
    signal = identify([record], Settings(methods=('ls',))).signals['psi']
    assert signal.y[-1] == record.columns['psi'][-1]
    assert np.abs(np.diff(signal.y)).max() > np.pi


def test_the_responses_of_table_3_are_identified_as_what_they_are():
    preset = load_preset('paper_table3')
    fits = identify(preset.records, Settings(methods=('ls',), poles='real')).methods['ls'].outputs
    for output, (gain, a, b) in preset.truth.items():
        model = fits[output].model
        assert model.gain == pytest.approx(gain, rel=1e-9)
        assert (model.b, model.a) == pytest.approx(sorted((a, b)), abs=1e-9)


@pytest.mark.slow
def test_printed_equations_end_at_the_exact_time(printed_cases):
    exact = [case for case in printed_cases if case.source == 'exact']
    assert len(exact) == 5
    for case in exact:
        assert case.status == 'diverged'
        # A rate passes 1e6 rad/s within 2e-5 s of the end; fixed steps add some.
        assert case.end_time == pytest.approx(case.expected, abs=5e-5)
    assert {round(case.expected, 4) for case in exact} == {0.0810, 0.8101, 0.2562, 1.0411}


@pytest.mark.slow
def test_printed_equations_end_where_an_adaptive_integrator_ends(printed_cases):
    known = [case for case in printed_cases if case.source == 'adaptive integrator']
    assert len(known) == 2
    for case in known:
        assert case.status == 'diverged'
        assert case.end_time == pytest.approx(case.expected, abs=1e-3)


def test_only_friction_that_slows_lasts_and_the_derived_equations_always_do(printed_cases):
    lasting = [case for case in printed_cases if case.status == 'complete']
    assert [case.source for case in lasting] == ['friction that slows']
    assert lasting[0].end_time == lasting[0].duration == 5.0
    for case in printed_cases:
        assert case.derived == 'complete'
        assert 0 < case.end_time <= case.duration
    assert [case.duration for case in printed_cases].count(500.0) == 3
