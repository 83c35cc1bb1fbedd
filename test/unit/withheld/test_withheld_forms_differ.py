# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""No form of the evaluation is one that the library has: what the best fit of these leaves."""

from dataclasses import replace

from library_forms import COUNT, flown, instants, of_battery, of_part, remainder, STEP
import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HOVER, made, PARAMS, PLACES

from quad_ident_ros.effects.registry import EFFECTS, vector
from quad_ident_ros.model.actuators import actuated
from quad_ident_ros.model.vehicle import load_vehicle
from withheld.actuators import Battery
from withheld.forms import EVALUATION

# Of what a form does, rms: less is a small error of form, which the diagnosis must not mind.
LEAST = 0.05
SIZE = 3.0
FORCES = [(effect, form) for effect in (
    'rotor_drag', 'body_drag', 'inflow', 'ground_effect', 'battery_sag', 'thrust_scale',
    'rotor_fault', 'blade_flapping') for form in EVALUATION[effect]]
FLIGHT = flown(PARAMS, HOVER)
STEP_OF_MOTORS = 0.002
FLIGHTS = range(4, 20)      # seeds of what differs between the flights of a case
VEHICLE = load_vehicle('iris')
# Where the vehicle is at the times of FLIGHT, m.
WAY = np.column_stack([1.2 * np.sin(0.9 * FLIGHT['time']), 1.2 * np.cos(0.7 * FLIGHT['time']),
                       1.0 + 0.5 * np.sin(0.5 * FLIGHT['time'])])
# How it leans then.
LEANS = Rotation.from_euler('xy', 0.15 * FLIGHT['air'][:, :2])


@pytest.mark.slow
@pytest.mark.parametrize(('effect', 'form'), FORCES)
def test_a_force_or_moment_is_no_form_of_the_library(effect, form):
    part = made(effect, form, SIZE)
    if isinstance(part, Battery):
        assert not part.recorded    # a recorded voltage would show it to the library
        target = of_battery(part, PARAMS, PLACES, HOVER, FLIGHT)
    else:
        target = of_part(part, PARAMS, PLACES, FLIGHT)
    for ours in EFFECTS[effect].forms:
        if not ours.needs_voltage:
            assert remainder(target, ours, PARAMS, PLACES, FLIGHT, HOVER) > LEAST


def test_what_the_fit_leaves_of_a_form_of_the_library_is_nothing():
    sloped = of_part(made('thrust_scale', 'sloped', SIZE), PARAMS, PLACES, FLIGHT)
    rests = {one.name: remainder(sloped, one, PARAMS, PLACES, FLIGHT, HOVER)
             for one in EFFECTS['thrust_scale'].forms}
    assert rests['exponent'] < 0.02 < LEAST < rests['factor']


def commands():
    """Return held commands, (N, 4), as a controller gives them, and the times of their samples."""
    rng, t = np.random.default_rng(1), np.arange(0.0, 6.0, STEP_OF_MOTORS)
    rates = 2.0 * np.pi * np.exp(rng.uniform(np.log(0.3), np.log(8.0), (4, 15, 1)))
    waves = np.sin(rates * t + rng.uniform(0.0, 6.28, (4, 15, 1))).sum(axis=1).T
    return np.repeat(HOVER * (1.0 + 0.05 * waves)[::5], 5, axis=0), t


def followed(turn, command):
    speeds, out = command[0].copy(), np.empty_like(command)
    for k, one in enumerate(command):
        speeds = out[k] = turn(speeds, one)
    return out


@pytest.mark.slow
@pytest.mark.parametrize('form', EVALUATION['motor_lag'])
def test_a_motor_is_no_lag_of_the_library(form):
    motor, (command, t) = made('motor_lag', form, SIZE), commands()
    true = followed(lambda w, c: motor.turn(w, c, STEP_OF_MOTORS), command)

    def missed(speeds):
        return np.sqrt(np.mean((speeds - true) ** 2) / np.mean((true - command) ** 2))

    def up_and_down(logs):
        up, down = np.exp(logs)
        return missed(followed(lambda w, c: c + (w - c) * np.exp(
            -STEP_OF_MOTORS / np.where(c > w, up, down)), command))

    def second_order(logs):
        mean_lag, inner_lag = np.exp(logs)
        theta = vector({'motor_lag': {'mean_lag': mean_lag, 'inner_lag': inner_lag}}, VEHICLE)
        return missed(actuated(t, t[:-1], command, theta[None]).speeds[0][1:])

    # What follows a command is at the end of its step.
    true, command = true[:-1], command[:-1]

    def slew(logs):
        up, down = HOVER * STEP_OF_MOTORS * np.exp(logs + 4.0)
        return missed(followed(lambda w, c: w + np.clip(c - w, -down, up), command))

    for law in (up_and_down, second_order, slew):
        best = minimize(law, np.log([0.03, 0.03]), method='Nelder-Mead',
                        options={'xatol': 1e-3, 'fatol': 1e-4})
        assert best.success and best.fun > LEAST


@pytest.mark.parametrize('form', EVALUATION['actuation_delay'])
def test_a_delay_is_not_constant(form):
    line = made('actuation_delay', form, SIZE)
    waits = [line.waits(t) for t in np.arange(0.0, 20.0, 0.01)]
    assert np.std(waits) / np.mean(waits) > LEAST


@pytest.mark.parametrize('form', EVALUATION['wind'])
def test_a_wind_is_not_the_same_everywhere_and_at_all_times(form):
    wind, rng = made('wind', form, SIZE), np.random.default_rng(2)
    places = np.column_stack([rng.uniform(-1.5, 1.5, (COUNT, 2)), rng.uniform(0.1, 2.0, COUNT)])
    air = np.array([wind.wind(STEP * k, place) for k, place in enumerate(places)])
    assert np.linalg.norm(air.std(axis=0)) > LEAST * np.linalg.norm(air.mean(axis=0))


@pytest.mark.parametrize('form', EVALUATION['inertia_mismatch'])
def test_inertia_that_does_not_turn_with_the_body_is_no_factor_on_the_inertia(form):
    moment = of_part(made('inertia_mismatch', form, SIZE), PARAMS, PLACES, FLIGHT)[:, 3:]
    slopes = np.gradient(FLIGHT['rate'], STEP, axis=0)
    for axis in range(3):
        share = slopes[:, axis] @ moment[:, axis] / (slopes[:, axis] @ slopes[:, axis])
        rest = moment[:, axis] - share * slopes[:, axis]
        assert share < 0.0 and np.std(rest) > LEAST * np.std(moment[:, axis])


@pytest.mark.parametrize('form', EVALUATION['com_offset'])
def test_a_centre_that_moves_is_no_constant_offset(form):
    part, true = made('com_offset', form, SIZE), fresh()
    part.alter(true, PARAMS)
    flight = FLIGHT | {'rotation': LEANS.as_matrix(), 'position': WAY}
    moment = of_part(part, PARAMS, PLACES, flight)[:, 3:5]
    lift = PARAMS['k_eta'] * np.sum(FLIGHT['speeds'] ** 2, axis=1)
    x, y, _ = true['centre']
    moment = moment + lift[:, None] * [-y, x]
    share = lift @ moment / (lift @ lift)
    assert np.linalg.norm(moment - lift[:, None] * share) > LEAST * np.linalg.norm(moment)


def heave(part):
    """Return the force, (COUNT,) N along z, of a load on a body that heaves, and its pull."""
    pull = 9.81 + 3.0 * np.sin(2.0 * np.pi * 0.8 * FLIGHT['time'])
    steps, force = 20, []
    for now, one, place in zip(instants(PLACES, FLIGHT), pull, WAY, strict=True):
        for _ in range(steps):
            extra = part.wrench(replace(now, position=place))
            part.after(STEP / steps, np.eye(3), np.array([0.0, 0.0, one - 9.81]))
        force.append(0.0 if extra is None else extra[0][2])
    return np.array(force), pull


@pytest.mark.parametrize('form', EVALUATION['mass_offset'])
def test_a_load_is_no_mass_that_stays(form):
    part, true, weights, pulls = made('mass_offset', form, SIZE), fresh(), [], []
    part.alter(true, PARAMS)
    for seed in FLIGHTS:
        part.begin(np.random.default_rng(seed))
        mass = true['mass'] - PARAMS['mass'] + np.array([part.mass(t) for t in FLIGHT['time']])
        force, pull = heave(part)
        weights.append(mass * pull - force)     # what the load takes of the thrust
        pulls.append(pull)
    weight, pull = np.concatenate(weights), np.concatenate(pulls)
    share = pull @ weight / (pull @ pull)
    assert share == pytest.approx(part.parameters['mass'], rel=0.2)
    assert np.linalg.norm(weight - share * pull) > LEAST * np.linalg.norm(weight)


@pytest.mark.parametrize('form', EVALUATION['rotor_gyro'])
def test_the_momentum_of_rotors_is_not_that_of_two_inertias(form):
    moment = of_part(made('rotor_gyro', form, SIZE), PARAMS, PLACES, FLIGHT)[:, 3:]
    p, q, _ = FLIGHT['rate'].T
    ours = []
    for spin in (1.0, -1.0):
        momentum = spin * FLIGHT['speeds'][:, PARAMS['rotor_directions'] == spin].sum(axis=1)
        ours.append(np.column_stack([momentum * q, -momentum * p, np.gradient(momentum, STEP)]))
    ours = np.stack([one.ravel() for one in ours], axis=1)
    inertias = np.linalg.lstsq(ours, moment.ravel(), rcond=None)[0]
    remains = moment.ravel() - ours @ inertias
    assert np.linalg.norm(remains) > LEAST * np.linalg.norm(moment)


@pytest.mark.parametrize('form', EVALUATION['gyro_bias'])
def test_a_bias_is_not_constant(form):
    part = made('gyro_bias', form, SIZE)
    thrusts, rates = np.mean((FLIGHT['speeds'] / HOVER) ** 2, axis=1), FLIGHT['rate']
    bias = np.array([
        part.measured(t, np.array([*place, *velocity, *attitude, *rate]), thrust)[10:] - rate
        for t, place, velocity, attitude, thrust, rate in zip(
            FLIGHT['time'], WAY, FLIGHT['air'], LEANS.as_quat(), thrusts, rates, strict=True)])
    assert np.linalg.norm(bias.std(axis=0)) > LEAST * np.linalg.norm(bias.mean(axis=0))


@pytest.mark.parametrize('form', EVALUATION['attitude_misalignment'])
def test_a_tilt_is_not_that_of_an_attitude_or_of_a_block(form):
    part, turns = made('attitude_misalignment', form, SIZE), []
    thrusts, rates = np.mean((FLIGHT['speeds'] / HOVER) ** 2, axis=1), FLIGHT['rate']
    seen = np.array([
        part.measured(t, np.array([*place, *velocity, *attitude, *rate]), thrust)
        for t, place, velocity, attitude, thrust, rate in zip(
            FLIGHT['time'], WAY, FLIGHT['air'], LEANS.as_quat(), thrusts, rates, strict=True)])
    turns = (LEANS.inv() * Rotation.from_quat(seen[:, 6:10])).as_rotvec()
    mean = np.mean(turns, axis=0)
    # The rates of a block that is tilted so, or of one that is not: whichever is nearer.
    block = Rotation.from_rotvec(mean).inv().apply(rates)
    rest = min(np.linalg.norm(seen[:, 10:] - one) for one in (rates, block))
    change = np.linalg.norm(block - rates)
    assert max(np.linalg.norm(turns - mean) / np.linalg.norm(turns), rest / change) > LEAST
