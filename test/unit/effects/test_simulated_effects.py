# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A vehicle with effects under the inputs U1..U4: by its rotors, where the effects need them."""

from dataclasses import replace

from effect_flights import ALL, roll, state
import numpy as np
import pytest

from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.model import simulate as simulation
from quad_ident_ros.model.dynamics import course_of
from quad_ident_ros.model.simulate import simulate
from quad_ident_ros.model.vehicle import load_vehicle

PERIOD = 0.01
# Drag that is the same along all axes is the same along those of the world and of the body.
VEHICLE = replace(load_vehicle('paper_quadrotor'), linear_drag=(0.1, 0.1, 0.1))
STATES = ('px', 'py', 'pz', 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz', 'wx', 'wy', 'wz')


def inputs(seconds=1.0, turns=(0.05, -0.03, 0.02)):
    """Return inputs that hold the weight and turn the vehicle to and fro, (N, 4)."""
    rows = np.tile(VEHICLE.hover_input, (round(seconds / PERIOD) + 1, 1))
    sign = np.where(np.arange(len(rows)) // 10 % 2, -1, 1)
    rows[:, 1:] += sign[:, None] * turns
    return rows


def fly(effects, rows=None, **options):
    vehicle = replace(VEHICLE, effects=effects)
    return simulate(vehicle, 'newton_euler', inputs() if rows is None else rows, PERIOD, **options)


@pytest.mark.parametrize('name', EFFECTS)
def test_a_flight_is_that_of_the_rotors_commanded(name):
    # The record has the commands where rotors were flown; predicted from them it is the same.
    effects = {name: ALL[name]}
    record = fly(effects, altitude=0.5).record
    assert record.has('cmd1') == EFFECTS[name].forms[0].on_rotors
    if record.has('cmd1'):
        start = record.stack(*STATES)[0]
        # The voltage is not simulated: what sags by the volt does not, what sags by the second.
        found = roll(VEHICLE, effects, course_of(record, VEHICLE), start)
        # One step of 10 ms for a hundred of 0.1 ms.
        assert np.abs(found - record.stack(*STATES)).max() < 2e-5


@pytest.mark.parametrize('name', EFFECTS)
def test_every_effect_acts_in_the_simulation(name):
    nominal, found = (fly(effects, altitude=0.1).record.stack(*STATES)
                      for effects in ({}, {name: ALL[name]}))
    assert np.abs(found - nominal).max() > 1e-4


def test_flown_by_its_rotors_a_vehicle_without_strength_is_the_nominal_one():
    rows = inputs()
    nominal = fly({}, rows).record.stack(*STATES)
    found = fly({'rotor_drag': {'coefficient': 1e-15}}, rows).record.stack(*STATES)
    assert np.abs(found - nominal).max() < 1e-10


def test_effects_on_rotors_refuse_inputs_that_no_rotors_give():
    rows = np.ones((11, 4))
    assert fly({}, rows).status == fly({'body_drag': {'vertical': 0.1}}, rows).status == 'complete'
    with pytest.raises(InputError, match='vehicle paper_quadrotor: its effects motor_lag act on '
                                         r'rotors, but no rotor speeds give U = \(1, 1, 1, 1\)'):
        fly({'motor_lag': {'time_constant': 0.05}, 'body_drag': {'vertical': 0.1}}, rows)


def test_the_printed_equations_know_no_effects():
    with pytest.raises(InputError, match='know no effects; fly the model newton_euler'):
        simulate(replace(VEHICLE, effects={'wind': {'x': 1.0}}), 'paper', inputs(), PERIOD)


def test_rotors_that_are_flown_take_the_place_of_omega_r():
    # Asked for a spin of the rotors, the simulation turns them: at hover with a yaw torque they
    # have one of their own, in any case, and without being asked they have none.
    rows = inputs(0.3, turns=(0.05, 0.03, 0.05))
    rows[:, 1:] = np.abs(rows[:, 1:])
    drag = {'rotor_drag': {'coefficient': 1e-9}}
    without, asked, more = (fly(drag, rows, omega_r=omega_r).record.columns['wx']
                            for omega_r in (0.0, 50.0, 500.0))
    assert (asked == more).all() and np.abs(asked - without).max() > 1e-6
    gyro = {'rotor_gyro': {'rotor_inertia': VEHICLE.rotor_inertia}}
    assert np.abs(fly({**drag, **gyro}, rows).record.columns['wx'] - asked).max() < 1e-12
    # Nor is it added to one that they have by their spin.
    by_spin = {'rotor_gyro': dict.fromkeys(('heavier_clockwise', 'heavier_counterclockwise'),
                                           0.5 * VEHICLE.rotor_inertia)}
    again = fly({**drag, **by_spin}, rows, omega_r=50.0).record.columns['wx']
    assert np.abs(again - asked).max() < 1e-12


def test_the_flight_of_an_offset_centre_of_mass_begins_at_rest_where_it_is_said():
    record = fly({'com_offset': ALL['com_offset']}, altitude=2.0).record
    first = record.stack(*STATES)[0]
    assert np.abs(first - state(position=(0, 0, 2))).max() < 1e-15


def test_a_long_flight_is_integrated_in_parts_without_a_seam(monkeypatch):
    whole, parts = fly(ALL, altitude=1.0), []
    monkeypatch.setattr(simulation, 'STEPS_AT_ONCE', 1700)
    found = fly(ALL, altitude=1.0, on_progress=parts.append)
    assert len(parts) == 6 and found.status == 'complete'
    assert np.abs(found.record.stack(*STATES) - whole.record.stack(*STATES)).max() < 1e-10


def test_a_flight_that_diverges_ends_at_its_step():
    # Its rate grows by 1.96e6 rad/s^2: the limit is passed 0.204 ms after the sample at 0.51 s.
    vehicle = replace(VEHICLE, rotational_drag=(0.0, 0.0, 0.0))
    rows = np.zeros((101, 4))
    rows[:, 1] = 1.96e6 * vehicle.inertia[0] / vehicle.arm_length
    for step, end in ((1e-4, 0.5103), (1e-3, 0.511)):
        found = simulate(vehicle, 'newton_euler', rows, PERIOD, step=step)
        assert found.status == 'diverged' and len(found.record) == 52
        assert found.end_time == pytest.approx(end, abs=1e-9)
