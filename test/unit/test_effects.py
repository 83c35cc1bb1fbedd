# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Each effect against what is known of it in closed form."""

from dataclasses import replace

from flight import ALL, BARE, held, HEXA, hover_speed, IRIS, roll, state, steps, VEHICLE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import bounds, EFFECTS, mapping, NULL, PARAMETERS, vector
from quad_ident_ros.model.actuators import delayed, lagged
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.dynamics import course_of, predict
from quad_ident_ros.model.sensors import recorded, underlying
from quad_ident_ros.model.vehicle import load_vehicle

FAST = settings(deadline=None, max_examples=60)
MASS, GRAVITY = BARE.mass, BARE.gravity
WEIGHT = MASS * GRAVITY
HOVER = hover_speed(BARE)

# Those of the format of a diagnosis.
NAMES = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'wind', 'inflow',
         'ground_effect', 'battery_sag', 'thrust_scale', 'mass_offset', 'inertia_mismatch',
         'com_offset', 'rotor_fault', 'rotor_gyro', 'blade_flapping', 'attitude_misalignment',
         'gyro_bias')


# The registry.

def test_every_effect_of_the_format_is_registered_and_no_other():
    assert tuple(EFFECTS) == NAMES
    assert all(EFFECTS[name].name == name for name in NAMES)


@pytest.mark.parametrize('name', EFFECTS)
def test_an_effect_says_what_it_is(name):
    effect = EFFECTS[name]
    assert effect.title and effect.source and effect.excitation and effect.parameters
    assert set(effect.confused_with) <= set(EFFECTS) - {name}
    acts = [effect.body, effect.air, effect.thrust, effect.wrench, effect.actuator, effect.sensor]
    assert sum(part is not None for part in acts) == 1
    for parameter in effect.parameters:
        assert parameter.lower <= parameter.null < parameter.upper
        assert 0 < parameter.size < parameter.upper


def test_bounds_go_with_the_size_of_the_vehicle():
    small = replace(BARE, mass=BARE.mass / 10, inertia=tuple(np.array(BARE.inertia) / 10))
    units = [parameter.unit for _, parameter in PARAMETERS]
    ratio = [10 if 'kg' in unit or 'N' in unit else 1 for unit in units]
    assert np.allclose(bounds(BARE), bounds(small) * ratio, rtol=1e-12, atol=0)


def test_the_vector_and_the_mapping_of_effects_are_one_another_s_inverse():
    theta = vector(ALL, VEHICLE)
    assert mapping(theta) == ALL and mapping(NULL) == {}
    assert (vector(mapping(theta), VEHICLE) == theta).all()


# No strength, no effect.

@pytest.mark.parametrize('place', range(len(NULL)))
def test_vanishing_strength_is_the_nominal_vehicle_to_the_last_bit(place):
    name, parameter = PARAMETERS[place]
    course = steps(VEHICLE)
    start = state(velocity=(3, -2, 1), euler=(0.2, -0.1, 1.0), rate=(1, -2, 0.5))
    theta = NULL.copy()
    theta[place] += 1e-300 if parameter.null == 0 else np.spacing(1.0) / 4
    assert theta[place] > 0
    nominal, found = (predict(VEHICLE, each, course, start[None], [0], 100)
                      for each in (NULL, theta))
    # The delay's means of the commands are sums and differences of them.
    tolerance = 1e-12 if name == 'actuation_delay' else 0.0
    assert np.abs(found - nominal).max() <= tolerance


@pytest.mark.parametrize('name', EFFECTS)
def test_every_effect_of_some_strength_shows(name):
    # Else the test above could not fail.
    course = steps(VEHICLE)
    start = state(position=(0, 0, 0.3), velocity=(3, -2, 1), euler=(0.2, -0.1, 1), rate=(1, -2, 3))
    nominal, found = (roll(VEHICLE, effects, course, start)
                      for effects in ({}, {name: ALL[name]}))
    assert np.abs(found[1:] - nominal[1:]).max() > 1e-4


# Motors and their commands.

def test_a_lagging_motor_answers_a_step_with_an_exponential():
    t = np.arange(51) * 0.01
    commands = np.full((51, 1), 500.0)
    commands[10:] = 700.0
    speeds = lagged(t, commands, 0.05)[:, 0]
    exact = np.where(t < 0.1, 500.0, 700.0 - 200.0 * np.exp(-(t - 0.1) / 0.05))
    assert np.abs(speeds - exact).max() < 1e-10


@pytest.mark.parametrize('lag', [0.2, 0.05, 0.01])
def test_a_lagging_motor_lifts_with_the_square_of_its_speed(lag):
    # From hover to 1.1 of its speed: the integral of (c + g exp(-t / lag))^2.
    course = held(BARE, 1.1 * HOVER, seconds=0.5, period=0.002)
    course.commands[0] = HOVER
    t = course.t - course.t[1]
    gap = -0.1
    lifted = (1.21 * t + 2.2 * gap * lag * -np.expm1(-t / lag)
              + gap ** 2 * lag / 2 * -np.expm1(-2 * t / lag))
    found = roll(BARE, {'motor_lag': {'time_constant': lag}}, course, state())[1:, 5]
    # Steps of 2 ms: (h / lag)^4 / 180 of the part of exp(-2 t / lag), at most.
    assert np.abs(found - GRAVITY * (lifted - t)[1:]).max() < 1e-6


def test_a_lag_much_shorter_than_the_step_is_the_mean_of_its_exponential():
    course = held(BARE, 1.1 * HOVER)
    course.commands[0] = HOVER
    without = roll(BARE, {}, course, state())[-1]
    for lag in (1e-3, 1e-5, 1e-9):
        found = roll(BARE, {'motor_lag': {'time_constant': lag}}, course, state())[-1]
        # The thrust lacks 0.21 of the weight for about a lag, less the square of the gap.
        assert without[5] - found[5] == pytest.approx(0.22 * GRAVITY * lag, rel=0.06)


@pytest.mark.parametrize('count', [0, 1, 3, 20])
def test_a_delay_of_whole_samples_moves_the_commands_by_these(count):
    course = steps(VEHICLE)
    moved = np.concatenate([np.tile(course.commands[:1], (count, 1)), course.commands])[:101]
    # What acts after the last sample is nobody's to know.
    found = delayed(course.t, course.commands, count * 0.01)
    assert np.abs(found - moved)[:-1].max() < 1e-10
    found = roll(VEHICLE, {'actuation_delay': {'delay': count * 0.01}}, course, state())
    expected = roll(VEHICLE, {}, replace(course, commands=moved), state())
    assert np.abs(found - expected).max() < 1e-10


@FAST
@given(st.floats(0, 0.3), st.lists(st.floats(1e-3, 0.1), min_size=2, max_size=20),
       st.integers(0, 1000))
def test_a_delayed_command_has_the_mean_thrust_of_the_command(delay, steps, seed):
    # What acts until the end is what was commanded until a delay before, whatever the samples.
    t = np.concatenate([[0.0], np.cumsum(steps)])
    commands = np.random.default_rng(seed).uniform(0, 1000, (len(t), 2))
    found = np.diff(t) @ delayed(t, commands, delay)[:-1] ** 2
    # The command held to the next sample, and the first one before it.
    until = np.clip(t[-1] - delay - t[:-1], 0.0, np.diff(t))
    expected = until @ commands[:-1] ** 2 + min(delay, t[-1]) * commands[0] ** 2
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-6)


# Drag and wind.

@pytest.mark.parametrize(('linear', 'quadratic'), [(0.3, 0.05), (0.3, 0.0), (0.0, 0.05)])
def test_a_hovering_vehicle_takes_up_the_wind(linear, quadratic):
    # m u' = -c u - d u^2 of its velocity u against the air.
    wind = 4.0
    course = held(BARE, HOVER, seconds=3.0)
    effects = {'rotor_drag': {'coefficient': linear}, 'wind': {'x': -wind},
               'body_drag': {'horizontal': quadratic}}
    # All rotors at one height: their drag turns the vehicle, if they are not where its mass is.
    flat = replace(BARE, rotors=tuple(replace(rotor, position=(*rotor.position[:2], 0.0))
                                      for rotor in BARE.rotors))
    found = roll(flat, effects, course, state())[:, 3] + wind
    if linear:
        decay = np.exp(-linear * course.t / MASS)
        exact = linear * wind * decay / (linear + quadratic * wind * (1 - decay))
    else:
        exact = wind / (1 + quadratic * wind * course.t / MASS)
    assert np.abs(found - exact).max() < 1e-8


def test_the_velocity_at_the_end_is_that_at_which_the_forces_balance():
    # Leaning, with rotors of one speed: thrust along the body, drag of two kinds against the air.
    flat = replace(BARE, rotors=tuple(replace(rotor, position=(*rotor.position[:2], 0.0))
                                      for rotor in BARE.rotors))
    effects = {'rotor_drag': {'coefficient': 0.3}, 'inflow': {'axial': 0.5},
               'body_drag': {'horizontal': 0.05, 'vertical': 0.09}}
    faster = 1.05
    course = held(flat, faster * HOVER, seconds=60.0)
    last = roll(flat, effects, course, state(position=(0, 0, 500), euler=(0.1, 0.3, 0.7)))[-1]
    rotation = rotation_matrix(last[6:10])
    x, y, z = rotation.T @ last[3:6]
    speed = np.linalg.norm([x, y, z])
    force = np.array([-(0.3 * faster + 0.05 * speed) * x, -(0.3 * faster + 0.05 * speed) * y,
                      faster ** 2 * WEIGHT - 0.5 * faster * z - 0.09 * speed * z])
    assert np.abs(rotation @ force - [0, 0, WEIGHT]).max() < 1e-9 * WEIGHT
    assert speed > 3 and np.abs(last[10:]).max() < 1e-12


def test_a_falling_body_reaches_its_terminal_velocity():
    # Rotors that stand still: m g = d v^2, v = terminal tanh(g t / terminal).
    terminal = np.sqrt(WEIGHT / 0.08)
    course = held(BARE, 0.0, seconds=5.0)
    found = roll(BARE, {'body_drag': {'vertical': 0.08}}, course, state())[:, 5]
    assert np.abs(found + terminal * np.tanh(GRAVITY * course.t / terminal)).max() < 1e-7


@FAST
@given(st.tuples(*[st.floats(-10, 10)] * 3), st.integers(0, 10 ** 6))
def test_a_steady_wind_is_a_moving_world(wind, seed):
    # Whatever else there is but the ground, at which the world does not move.
    effects = {name: values for name, values in ALL.items()
               if name not in ('ground_effect', 'wind')}
    course = steps(VEHICLE, seconds=0.3, seed=seed)
    start = state(velocity=(3, -2, 1), euler=(0.2, -0.1, 1.0), rate=(1, -2, 0.5))
    moving = start.copy()
    moving[3:6] += wind
    still = roll(VEHICLE, effects, course, start)
    found = roll(VEHICLE, {**effects, 'wind': dict(zip('xyz', wind, strict=True))}, course, moving)
    still[:, :3] += course.t[:, None] * wind
    still[:, 3:6] += wind
    assert np.abs(found - still).max() < 1e-10


def test_drag_of_a_rotor_acts_where_the_rotor_is():
    # In-plane force above the centre of mass leans the vehicle back.
    found = roll(BARE, {'rotor_drag': {'coefficient': 0.3}}, held(BARE, HOVER, 1e-3, 1e-4),
                 state(velocity=(5, 0, 0)))[-1]
    height = BARE.rotors[0].position[2]
    assert found[11] / 1e-3 == pytest.approx(-0.3 * 5 * height / BARE.inertia[1], rel=1e-3)


@pytest.mark.parametrize(('velocity', 'parameter', 'force'), [
    ((0, 0, 2), 'axial', -0.5 * 2), ((0, 0, -2), 'axial', 0.5 * 2), ((3, 0, 0), 'axial', 0.0),
    ((3, 4, 0), 'translational', 0.5 * 25), ((0, 0, 2), 'translational', 0.0)])
def test_inflow_changes_the_thrust(velocity, parameter, force):
    found = roll(BARE, {'inflow': {parameter: 0.5}}, held(BARE, HOVER, 1e-4, 1e-5),
                 state(velocity=velocity))
    assert (found[-1, 5] - velocity[2]) / 1e-4 == pytest.approx(force / MASS, rel=1e-3, abs=1e-9)
    assert np.abs(found[-1, 3:5] - velocity[:2]).max() < 1e-9


@pytest.mark.parametrize(('velocity', 'moment'), [
    ((5, 0, 0), (0, 0.02 * 5, 0)), ((0, 5, 0), (-0.02 * 5, 0, 0)), ((0, 0, 5), (0, 0, 0))])
def test_flapping_pitches_the_nose_up_and_rolls_away(velocity, moment):
    found = roll(BARE, {'blade_flapping': {'coefficient': 0.02}}, held(BARE, HOVER, 1e-4, 1e-5),
                 state(velocity=velocity))[-1]
    assert found[10:] / 1e-4 == pytest.approx(np.divide(moment, BARE.inertia), rel=1e-3, abs=1e-9)


# Thrust.

@pytest.mark.parametrize(('height', 'strength'), [(0.1, 1.0), (0.2, 1.0), (0.15, 3.0)])
def test_hover_in_ground_effect_takes_less_speed(height, strength):
    # Cheeseman and Bennett: thrust over that far from the ground is 1 / (1 - (R / 4z)^2).
    above = height - BARE.rotors[0].position[2]
    share = 1 - strength * (BARE.rotor_radius / (4 * height)) ** 2
    course = held(BARE, HOVER * np.sqrt(share))
    found = roll(BARE, {'ground_effect': {'strength': strength}}, course,
                 state(position=(0, 0, above)))
    # It would fall by 5 m without: what is left is the integration of a balance.
    assert np.abs(found - found[0]).max() < 1e-9
    far = roll(BARE, {'ground_effect': {'strength': strength}}, course,
               state(position=(0, 0, 1000.0)))
    assert far[-1, 5] == pytest.approx(-(1 - share) * GRAVITY, rel=1e-3)


@pytest.mark.parametrize('height', [-10.0, -1e-3, 0.0, 1e-3])
def test_ground_effect_stays_finite_at_and_below_the_ground(height):
    found = roll(BARE, {'ground_effect': {'strength': 16.0}}, held(BARE, HOVER, 0.02),
                 state(position=(0, 0, height)))
    assert np.isfinite(found).all() and 0 < found[-1, 5] <= 3 * GRAVITY * 0.02 + 1e-9


def test_thrust_falls_with_the_time_and_with_the_voltage():
    course = held(BARE, HOVER)
    by_time = roll(BARE, {'battery_sag': {'per_second': 0.04}}, course, state())[:, 5]
    assert np.abs(by_time + GRAVITY * 0.04 * course.t ** 2 / 2).max() < 1e-9
    lower = replace(course, volt_drop=np.full(len(course.t), 0.5))
    by_volt = roll(BARE, {'battery_sag': {'per_volt': 0.2}}, lower, state())[:, 5]
    assert np.abs(by_volt + GRAVITY * 0.1 * course.t).max() < 1e-9


@pytest.mark.parametrize(('effects', 'changes'), [
    ({'thrust_scale': {'factor': 1.3}}, {'thrust_coefficient': BARE.thrust_coefficient * 1.3}),
    ({'mass_offset': {'mass': 0.4}}, {'mass': BARE.mass + 0.4}),
    ({'inertia_mismatch': {'factor_x': 1.3, 'factor_y': 0.8, 'factor_z': 2.0}},
     {'inertia': tuple(np.multiply(VEHICLE.inertia, (1.3, 0.8, 2.0)))})])
def test_a_different_vehicle_is_a_vehicle_with_a_mismatch(effects, changes):
    course = steps(VEHICLE)
    start = state(velocity=(3, -2, 1), rate=(1, -2, 0.5))
    found = roll(VEHICLE, effects, course, start)
    assert np.abs(found - roll(replace(VEHICLE, **changes), {}, course, start)).max() < 1e-10


@pytest.mark.parametrize('rotor', range(4))
def test_a_weak_rotor_lifts_less_and_turns_the_vehicle_to_its_side(rotor):
    found = roll(BARE, {'rotor_fault': {f'loss_{rotor + 1}': 0.2}}, held(BARE, HOVER, 1e-4, 1e-5),
                 state())[-1] / 1e-4
    lost = 0.2 * WEIGHT / 4
    x, y, _ = BARE.rotors[rotor].position
    assert found[5] == pytest.approx(-lost / MASS, rel=1e-6)
    assert found[10:] == pytest.approx(np.divide([-y * lost, x * lost, 0], BARE.inertia), rel=1e-6,
                                       abs=1e-6)


def test_more_rotors_than_faults_are_no_fault():
    many = replace(HEXA, rotors=HEXA.rotors * 2)
    found = roll(many, {'rotor_gyro': {'rotor_inertia': 1e-3}}, held(many, hover_speed(many), 0.1),
                 state())
    same = roll(HEXA, {'rotor_gyro': {'rotor_inertia': 2e-3}},
                held(HEXA, hover_speed(HEXA), 0.1), state())
    # Two rotors at each place with half the thrust each, and twice the angular momentum of one.
    assert found[-1, 2] == pytest.approx(same[-1, 2], abs=1e-9)


# Rotation.

def test_rotors_of_one_sense_have_the_body_precess():
    # Axisymmetric, no torque: w turns about the axis at J sum(spin speed) / I.
    inertia, speed, rotor = 0.03, 400.0, 2e-4
    vehicle = replace(BARE, inertia=(inertia, inertia, 0.05), thrust_coefficient=1e-30,
                      torque_coefficient=1e-30,
                      rotors=tuple(replace(each, spin=1) for each in BARE.rotors))
    course = held(vehicle, speed, seconds=2.0, period=0.001)
    found = roll(vehicle, {'rotor_gyro': {'rotor_inertia': rotor}}, course, state(rate=(2, 0, 0)))
    turned = rotor * 4 * speed / inertia * course.t
    assert turned[-1] > 6 * np.pi
    exact = 2 * np.stack([np.cos(turned), -np.sin(turned), np.zeros_like(turned)], axis=1)
    assert np.abs(found[:, 10:] - exact).max() < 1e-6


@pytest.mark.parametrize('lag', [0.05, 1e-4])
def test_speeding_rotors_up_keeps_the_angular_momentum_about_their_axes(lag):
    # Two rotors of each sense, in a square: the vehicle turns about its axis alone.
    vehicle = replace(load_vehicle('hummingbird'), torque_coefficient=1e-30)
    hover = hover_speed(vehicle)
    faster = hover * np.where([rotor.spin > 0 for rotor in vehicle.rotors], 1.1, 0.9)
    course = held(vehicle, faster)
    course.commands[0] = hover
    effects = {'rotor_gyro': {'rotor_inertia': 3e-5}, 'motor_lag': {'time_constant': lag}}
    found = roll(vehicle, effects, course, state())
    speeds = lagged(course.t, course.commands, lag)
    # A rotor turns against the reaction torque that its spin names.
    momentum = -3e-5 * speeds @ [rotor.spin for rotor in vehicle.rotors]
    total = vehicle.inertia[2] * found[:, 12] + momentum
    assert np.abs(total - total[0]).max() < 1e-12 * np.abs(momentum).max() + 1e-15
    assert found[-1, 12] > 1e-3


@pytest.mark.parametrize('offset', [(0.02, 0, 0), (0, -0.03, 0), (0.02, -0.03, 0.01)])
def test_an_offset_centre_of_mass_turns_the_hovering_vehicle(offset):
    effects = {'com_offset': dict(zip('xyz', offset, strict=True))}
    found = roll(BARE, effects, held(BARE, HOVER, 1e-4, 1e-5), state())[-1] / 1e-4
    moment = -np.cross(offset, [0, 0, WEIGHT])
    assert found[10:] == pytest.approx(moment / BARE.inertia, rel=1e-3, abs=1e-6)


def test_the_record_is_of_the_body_origin_and_the_fall_of_the_centre_of_mass():
    offset = np.array([0.05, -0.03, 0.08])
    vehicle = replace(BARE, inertia=(0.03, 0.03, 0.03))
    course = held(vehicle, 0.0, seconds=2.0, period=0.001)
    start = state(velocity=(1, 2, 3), euler=(0.3, 0.2, 0.1), rate=(2, -3, 5))
    found = roll(vehicle, {'com_offset': dict(zip('xyz', offset, strict=True))}, course, start)
    assert found[0] == pytest.approx(start, abs=1e-15)
    centre = found[:, :3] + rotation_matrix(found[:, 6:10]) @ offset
    t = course.t[:, None]
    first = np.array([1, 2, 3]) + rotation_matrix(start[6:10]) @ np.cross(start[10:], offset)
    assert np.abs(centre - centre[0] - first * t + [0, 0, GRAVITY / 2] * t ** 2).max() < 1e-9
    # The velocity recorded is that of the place recorded: by central differences.
    rate_of_change = (found[2:, :3] - found[:-2, :3]) / 0.002
    assert np.abs(rate_of_change - found[1:-1, 3:6]).max() < 1e-4
    assert (np.ptp(found[:, 3:5], axis=0) > 0.1).all()


# Sensors.

def test_a_tilted_attitude_and_a_biased_rate_are_recorded_and_change_no_motion():
    course = steps(VEHICLE)
    start = state(velocity=(3, -2, 1), euler=(0.2, -0.1, 1.0), rate=(1, -2, 0.5))
    nominal = roll(VEHICLE, {}, course, start)
    effects = {name: ALL[name] for name in ('attitude_misalignment', 'gyro_bias')}
    theta = vector(effects, VEHICLE)
    found = roll(VEHICLE, effects, course, recorded(theta, start))
    assert np.abs(found[:, :6] - nominal[:, :6]).max() < 1e-12
    assert found[:, 10:] == pytest.approx(nominal[:, 10:] + [0.02, -0.03, 0.01], abs=1e-12)
    tilt = rotation_matrix(nominal[:, 6:10]).transpose(0, 2, 1) @ rotation_matrix(found[:, 6:10])
    # To first order the tilt is 1 + skew; its square is 6e-3.
    assert np.abs(tilt - [[1, -0.1, -0.02], [0.1, 1, -0.03], [0.02, 0.03, 1]]).max() < 8e-3
    assert np.ptp(tilt, axis=0).max() < 1e-12


@FAST
@given(st.tuples(*[st.floats(-0.5, 0.5)] * 9), st.tuples(*[st.floats(-5, 5)] * 12))
def test_what_is_recorded_and_what_underlies_it_are_one_another_s_inverse(values, motion):
    theta = NULL.copy()
    names = [name for name, _ in PARAMETERS]
    for name, part in zip(('com_offset', 'attitude_misalignment', 'gyro_bias'),
                          (values[:3], values[3:6], values[6:]), strict=True):
        theta[[k for k, each in enumerate(names) if each == name]] = part
    start = state(motion[:3], motion[3:6], motion[6:9], motion[9:])
    assert np.abs(underlying(theta, recorded(theta, start)) - start).max() < 1e-12
    assert np.abs(recorded(theta, underlying(theta, start)) - start).max() < 1e-12


def test_a_course_begins_at_zero_whatever_the_clock_of_the_record():
    # Else a battery that sags by the second would be empty on a clock that counts from 1970.
    t = 1.7e9 + 0.5 * np.arange(5)
    commands = {f'cmd{j}': np.full(5, 500.0) for j in range(1, 5)}
    course = course_of(FlightRecord(t, commands, {}), IRIS)
    assert (course.t == 0.5 * np.arange(5)).all()


def test_a_prediction_leaves_the_states_that_it_starts_from_as_they_are():
    starts = np.tile(state(euler=(0.1, 0.2, 0.3)), (3, 1))
    kept = starts.copy()
    predict(VEHICLE, vector(ALL, VEHICLE), steps(VEHICLE), starts, [0, 1, 2], 5)
    assert (starts == kept).all()
