# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The bodies in MuJoCo fall, hover, swing and spin as they should, and agree with rotorpy's."""

from importlib import import_module
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest

from withheld.sensors import Noise

for name in ('rotorpy', 'mujoco', 'drone_models'):
    if find_spec(name) is None:
        pytest.skip(f'{name} is not installed', allow_module_level=True)
bodies, constants, flying, paths, plants, vehicles = (
    import_module(f'withheld.{name}') for name in (
        'bodies', 'constants', 'fly', 'paths', 'plant', 'vehicles'))
Bodies, Payload = bodies.Bodies, bodies.Payload

STEP = 0.01
PARAMS = vehicles.vehicle_of('px4_quadrotor', np.random.default_rng(1), False)
HOVER = np.full(4, constants.hover_speed(PARAMS))


def start(height=2.0, velocity=(0.0, 0.0, 0.0), speeds=HOVER):
    return np.array([0.0, 0.0, height, *velocity, 0.0, 0.0, 0.0, 1.0, *np.zeros(6), *speeds])


def held(plant, state, command, seconds):
    for _ in range(round(seconds / STEP)):
        state = plant.hold(state, command, STEP)
    return state


def commands_of(count):
    rng = np.random.default_rng(5)
    return HOVER * (1.0 + 0.02 * rng.normal(size=(count, 4)))


def together(effects, count=60):
    """Return the last states of the two plants under the same commands."""
    ends = []
    for kind in (plants.Reality, Bodies):
        plant, state = kind(PARAMS, effects), start()
        for command in commands_of(count):
            state = plant.hold(state, command, STEP)
        ends.append(state)
    return ends


def test_without_thrust_it_falls_freely():
    state = held(Bodies(PARAMS, {}), start(speeds=np.zeros(4)), np.zeros(4), 1.0)
    assert state[2] == pytest.approx(2.0 - 0.5 * 9.81, abs=1e-6)
    assert state[5] == pytest.approx(-9.81, abs=1e-9)


def test_it_hovers():
    state = held(Bodies(PARAMS, {}), start(), HOVER, 1.0)
    assert state[:13] == pytest.approx(start()[:13], abs=1e-9)


@pytest.mark.parametrize('effects', [
    {}, {'motor_lag': {'time_constant': 0.03}}, {'rotor_drag': {'coefficient': 0.3}},
    {'actuation_delay': {'delay': 0.013}}, {'rotor_gyro': {'rotor_inertia': 1e-4}},
    {'rotor_gyro': {'rotor_inertia': 1e-4}, 'motor_lag': {'time_constant': 0.03}}])
def test_it_moves_as_rotorpy_does(effects):
    theirs, ours = together(effects)
    # After 0.6 s: what steps of 10 and of 1 ms differ by.
    assert ours[:3] == pytest.approx(theirs[:3], abs=2e-4)
    assert ours[3:6] == pytest.approx(theirs[3:6], abs=2e-3)
    assert ours[10:13] == pytest.approx(theirs[10:13], abs=5e-3)


def test_rotors_that_spin_up_turn_the_vehicle_against_them():
    inertia = 1e-4
    plant = Bodies(PARAMS, {'rotor_gyro': {'rotor_inertia': inertia}})
    faster = HOVER * np.where(plant.rotor_dir > 0, 1.1, 1.0)
    state = plant.hold(start(), faster, 0.001)
    # Rotors of spin +1 turn about -z; nothing from outside has turned it yet.
    gained = inertia * np.sum(plant.rotor_dir * (faster - HOVER))
    torque = 0.001 * PARAMS['k_m'] * np.sum(plant.rotor_dir * faster ** 2)
    assert PARAMS['Izz'] * state[12] == pytest.approx(gained + torque, rel=1e-3)


def test_a_payload_hangs_on_its_cable():
    payload = Payload(0.1 * PARAMS['mass'], 0.4)
    plant = Bodies(PARAMS, {}, payload=payload)
    state = held(plant, start(), np.sqrt(1.1) * HOVER, 1.0)
    assert state[2:6] == pytest.approx([2.0, 0.0, 0.0, 0.0], abs=0.01)
    assert state[2] - plant.data.qpos[-5] == pytest.approx(0.4, rel=0.01)


def test_a_payload_swings_like_a_pendulum():
    # A light one, beneath a vehicle that moves off: it swings about where it would hang.
    plant = Bodies(PARAMS, {}, payload=Payload(1e-4 * PARAMS['mass'], 0.4))
    state, off = start(), []
    plant.hold(state, HOVER, 0.001)
    plant.data.qvel[-6] = 0.2
    for _ in range(200):
        state = plant.hold(state, HOVER, STEP)
        off.append(plant.data.qpos[-7] - state[0])
    crossings = np.flatnonzero(np.diff(np.sign(off)))
    assert 2.0 * np.diff(crossings).mean() * STEP == pytest.approx(
        2.0 * np.pi * np.sqrt(0.4 / 9.81), rel=0.03)


def test_a_hull_slows_with_the_square_of_the_speed():
    lost = []
    for speed in (2.0, 4.0):
        plant = Bodies(PARAMS, {}, hull=2.0)
        state = plant.hold(start(velocity=(speed, 0.0, 0.0)), HOVER, STEP)
        lost.append((speed - state[3]) / STEP)
    assert lost[1] / lost[0] == pytest.approx(4.0, rel=0.03)
    assert lost[0] == pytest.approx(0.16 * 2.0 ** 2, rel=0.05)
    assert plant.model.opt.density == bodies.AIR_DENSITY


def test_in_wind_a_hull_is_blown_along():
    plant = Bodies(PARAMS, {'wind': {'x': 3.0, 'y': 0.0, 'z': 0.0}}, hull=2.0)
    assert plant.hold(start(), HOVER, STEP)[3] > 0.0


def test_identified_motors_rise_and_fall_at_their_own_pace():
    motor = bodies.Identified(2.0, PARAMS, None)
    up = motor.turn(HOVER, 1.001 * HOVER, 0.001)
    rate = np.mean((up - HOVER) / (0.001 * HOVER)) / 0.001
    assert rate == pytest.approx(1.0 / 0.024, rel=0.05)
    down = motor.turn(HOVER, 0.999 * HOVER, 0.001)
    assert not np.allclose(up - HOVER, HOVER - down, rtol=0.02)
    assert motor.turn(HOVER, 1.2 * HOVER, 10.0) == pytest.approx(1.2 * HOVER)
    assert bodies.Identified(0.0, PARAMS, None).turn(HOVER, 1.2 * HOVER, 1e-3) == pytest.approx(
        1.2 * HOVER)


def test_identified_thrust_is_nominal_in_hover_alone():
    curve = bodies.IdentifiedThrust(1.0, PARAMS, None)
    gain = curve.gain(SimpleNamespace(speeds=HOVER * [0.8, 1.0, 1.2, 1.0]))
    assert gain[1] == pytest.approx(1.0)
    assert gain[0] < 0.99 < 1.01 < gain[2]


@pytest.mark.parametrize('options', [{}, {'payload': Payload(0.05 * PARAMS['mass'], 0.3)},
                                     {'motor': bodies.Identified(1.0, PARAMS, None)}])
def test_it_flies_under_the_same_controller(options):
    path = paths.Sines(np.random.default_rng(3), size=1.5, acceleration=2.0, low=1.0, turn=0.5)
    sensors = {'tilt': np.zeros(3), 'bias': np.zeros(3)}
    flown = flying.fly(Bodies(PARAMS, {}, **options), PARAMS, path, 2.0, STEP, Noise(),
                       np.random.default_rng(1), sensors)
    aims = np.array([path.update(k * STEP)['x'] for k in range(len(flown.states))])
    assert np.linalg.norm(flown.states[:, :3] - aims, axis=1).max() < 0.5
