# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the equations of motion and their integration must give, whoever wrote them."""

from dataclasses import replace

import equations_of_motion as motion
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quad_ident_ros.errors import InputError
from quad_ident_ros.model import attitude
from quad_ident_ros.model.simulate import LONGEST_STEP, MODELS, simulate
from quad_ident_ros.model.vehicle import load_vehicle

FAST = settings(deadline=None, max_examples=60)
VEHICLE = load_vehicle('paper_quadrotor')
UNEQUAL = replace(VEHICLE, inertia=(7.5e-3, 5e-3, 1.1e-2))
MASS, WEIGHT, ARM = VEHICLE.mass, VEHICLE.mass * VEHICLE.gravity, VEHICLE.arm_length
PERIOD = 0.01
# Each input: its column, the Euler angle and body rate that it turns, its lever and its axis.
TURNS = {'roll': (1, 'phi', 'wx', ARM, 0), 'pitch': (2, 'theta', 'wy', ARM, 1),
         'yaw': (3, 'psi', 'wz', 1.0, 2)}

angles = st.floats(-1.4, 1.4)
rates = st.floats(-20, 20)


def hold(inputs, seconds=5.0):
    """Return constant inputs U1..U4 for so many seconds."""
    return np.tile(np.asarray(inputs, float), (round(seconds / PERIOD) + 1, 1))


def fly(inputs, model='newton_euler', vehicle=VEHICLE, **options):
    return simulate(vehicle, model, inputs, PERIOD, **options)


def derivative(state, inputs=(0, 0, 0, 0), omega_r=0.0, vehicle=VEHICLE):
    """Return the derivative of a newton_euler state (13,)."""
    return motion.derivative(vehicle, state, inputs, omega_r)


def state(velocity=(0, 0, 0), euler=(0, 0, 0), rate=(0, 0, 0)):
    quaternion = attitude.quaternion_from_euler(np.asarray(euler, float))
    return np.concatenate([np.zeros(3), velocity, quaternion, rate])


def turn_freely(rate, vehicle, omega_r=0.0, seconds=5.0, substeps=100):
    """Return quaternions and body rates of a flight without torque that begins with a rate."""
    t = np.arange(round(seconds / PERIOD) + 1) * PERIOD
    out = motion.move(vehicle, state(rate=rate), t, substeps, omega_r)
    return out[:, 6:10], out[:, 10:13]


@pytest.mark.parametrize('model', MODELS)
def test_rest_stays_at_rest(model):
    flight = fly(hold(VEHICLE.hover_input), model, altitude=3.0)
    columns = flight.record.columns
    assert flight.status == 'complete' and flight.end_time == 5.0
    # m g / m differs from g by one rounding, 2e-15 m/s^2, which is 2e-14 m after 5 s.
    assert np.abs(columns['pz'] - 3.0).max() < 1e-12
    for name in ('px', 'py', 'vx', 'vy', 'phi', 'theta', 'psi', 'wx', 'wy', 'wz'):
        assert not columns[name].any(), name


@pytest.mark.parametrize('model', MODELS)
def test_free_fall_with_linear_drag_is_the_closed_form(model):
    record = fly(hold([0, 0, 0, 0]), model, altitude=100.0).record
    decay = VEHICLE.linear_drag[2] / MASS
    speed = -VEHICLE.gravity / decay * -np.expm1(-decay * record.t)
    fallen = -VEHICLE.gravity / decay * (record.t + np.expm1(-decay * record.t) / decay)
    # The step is 1e-5 of the time constant or less: rounding alone is left, 5e5 steps at most.
    assert np.abs(record.columns['vz'] - speed).max() < 1e-9
    assert np.abs(record.columns['pz'] - 100.0 - fallen).max() < 1e-9


@FAST
@given(st.tuples(rates, rates, rates), angles, angles, angles)
def test_drag_opposes_each_velocity_and_nothing_else(velocity, roll, pitch, yaw):
    euler = (roll, pitch, yaw)
    change = derivative(state(velocity, euler)) - derivative(state((0, 0, 0), euler))
    assert np.allclose(change[3:6], -np.array(VEHICLE.linear_drag) / MASS * velocity, atol=1e-12)
    assert not change[6:].any()


@FAST
@given(st.floats(0, 20), angles, angles, st.floats(-6, 6))
def test_thrust_acts_along_the_body_axis(thrust, roll, pitch, yaw):
    # An independent rotation: SciPy's, from the Z-Y-X angles.
    axis = Rotation.from_euler('ZYX', [yaw, pitch, roll]).apply([0, 0, 1])
    found = derivative(state(euler=(roll, pitch, yaw)), (thrust, 0, 0, 0))[3:6]
    assert np.allclose(found, axis * thrust / MASS - [0, 0, VEHICLE.gravity], atol=1e-12)


@FAST
@given(angles, angles, st.floats(-3, 3), st.tuples(rates, rates, rates))
def test_attitude_turns_with_the_body_rate(roll, pitch, yaw, rate):
    # R' = R S(Omega), eq. (1): by central differences, whose error is (h |w|)^2 / 6 of |w|.
    start = state(euler=(roll, pitch, yaw), rate=rate)
    change = derivative(start)[6:10]
    step = 1e-6
    ahead, behind = (attitude.rotation_matrix(start[6:10] + sign * step * change)
                     for sign in (1, -1))
    x, y, z = rate
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    expected = attitude.rotation_matrix(start[6:10]) @ skew
    assert np.allclose((ahead - behind) / (2 * step), expected, atol=1e-6)


@pytest.mark.parametrize('omega_r', [0.0, 300.0])
@pytest.mark.parametrize('rate', [(3, -2, 4), (0.01, 8, 0.01), (-5, 0, 1)],
                         ids=['general', 'middle_axis', 'two_axes'])
def test_torque_free_rotation_keeps_its_energy(rate, omega_r):
    # Gyroscopic moments, of the body and of the rotors, do no work.
    vehicle = replace(UNEQUAL, rotational_drag=(0.0, 0.0, 0.0))
    _, found = turn_freely(rate, vehicle, omega_r)
    energy = 0.5 * found ** 2 @ np.array(vehicle.inertia)
    # Fourth order at 1e-4 s: 1e-14 a period of the motion, and rounding over 5e4 steps.
    assert np.abs(energy / energy[0] - 1).max() < 1e-10


@pytest.mark.parametrize('rate', [(3, -2, 4), (0.01, 8, 0.01), (-5, 0, 1)],
                         ids=['general', 'middle_axis', 'two_axes'])
def test_torque_free_rotation_keeps_its_angular_momentum_in_the_world(rate):
    vehicle = replace(UNEQUAL, rotational_drag=(0.0, 0.0, 0.0))
    quaternion, found = turn_freely(rate, vehicle)
    momentum = np.einsum('nij,nj->ni', attitude.rotation_matrix(quaternion),
                         found * vehicle.inertia)
    assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.linalg.norm(momentum[0])
    # The body itself does turn: its rate is not what is constant.
    assert np.abs(found - found[0]).max() > 0.01


def test_rotational_drag_takes_energy_whichever_way_it_turns():
    for rate in ((3, -2, 4), (-3, 2, -4)):
        _, found = turn_freely(rate, UNEQUAL, seconds=2.0)
        energy = found ** 2 @ np.array(UNEQUAL.inertia)
        assert (np.diff(energy) < 0).all()


@pytest.mark.parametrize('sign', [1, -1])
@pytest.mark.parametrize('turn', TURNS)
def test_each_torque_turns_its_own_axis_in_its_own_sense(turn, sign):
    column, angle, rate, *_ = TURNS[turn]
    inputs = VEHICLE.hover_input
    inputs[column] = sign * 0.1
    columns = fly(hold(inputs, 1.0)).record.columns
    for name in ('phi', 'theta', 'psi', 'wx', 'wy', 'wz'):
        if name in (angle, rate):
            assert (np.diff(sign * columns[name]) > 0).all(), name
        else:
            assert not columns[name].any(), name


def test_thrust_moves_only_the_altitude():
    inputs = VEHICLE.hover_input + [0.5, 0, 0, 0]
    columns = fly(hold(inputs, 1.0)).record.columns
    assert (np.diff(columns['pz']) > 0).all()
    for name in ('px', 'py', 'phi', 'theta', 'psi'):
        assert not columns[name].any(), name


def test_tilting_accelerates_as_in_flu_and_enu():
    # Pitch up about +y leans the thrust forward, roll about +x leans it to the right (-y).
    pitched = fly(hold(VEHICLE.hover_input + [0, 0, 0.1, 0], 0.3)).record.columns
    assert pitched['px'][-1] > 0 and not pitched['py'].any()
    rolled = fly(hold(VEHICLE.hover_input + [0, 0.1, 0, 0], 0.3)).record.columns
    assert rolled['py'][-1] < 0 and not rolled['px'].any()


@pytest.mark.parametrize('size', [1.0, -1.0, 0.1, 0.01])
@pytest.mark.parametrize('turn', TURNS)
def test_single_axis_rotation_is_the_closed_form(turn, size):
    # With drag K w|w| the angle is V tau ln cosh(t / tau), V = sqrt(M/K), tau = I / sqrt(M K).
    column, angle, rate, lever, axis = TURNS[turn]
    inputs = VEHICLE.hover_input
    inputs[column] = size
    record = fly(hold(inputs)).record
    moment, drag = lever * abs(size), VEHICLE.rotational_drag[axis]
    speed, tau = np.sqrt(moment / drag), VEHICLE.inertia[axis] / np.sqrt(moment * drag)
    turned = np.sign(size) * speed * tau * np.log(np.cosh(record.t / tau))
    # Unwrapping follows the pitch over the top. 1e-10: fourth order at h / tau = 2e-3 at most.
    assert np.abs(record.columns[angle] - turned).max() < 1e-9 * np.abs(turned).max()
    spun = np.sign(size) * speed * np.tanh(record.t / tau)
    assert np.abs(record.columns[rate] - spun).max() < 1e-9 * speed


def test_climb_from_hover_is_the_closed_form():
    record = fly(hold(VEHICLE.hover_input + [1.0, 0, 0, 0])).record
    decay = VEHICLE.linear_drag[2] / MASS
    climbed = (record.t + np.expm1(-decay * record.t) / decay) / (MASS * decay)
    assert np.abs(record.columns['pz'] - climbed).max() < 1e-9
    assert record.columns['pz'][-1] == pytest.approx(19.19947612, abs=5e-9)   # errata section 1


def test_rotor_gyroscopics_have_the_sign_of_the_paper():
    # -M_gh of eq. (11): a nose-up rate rolls to the negative side, a roll rate pitches up.
    spin = 100.0
    size = VEHICLE.rotor_inertia * spin
    for rate, expected in (((0, 1, 0), (-size / VEHICLE.inertia[0], 0, 0)),
                           ((1, 0, 0), (0, size / VEHICLE.inertia[1], 0)),
                           ((0, 0, 1), (0, 0, 0))):
        change = derivative(state(rate=rate), omega_r=spin) - derivative(state(rate=rate))
        assert np.allclose(change[10:], expected, atol=1e-15)
        assert not change[:10].any()


def test_body_gyroscopics_are_those_of_euler():
    rate = np.array([1.5, -2.0, 3.0])
    inertia = np.array(UNEQUAL.inertia)
    vehicle = replace(UNEQUAL, rotational_drag=(0.0, 0.0, 0.0))
    expected = -np.cross(rate, inertia * rate) / inertia
    assert np.allclose(derivative(state(rate=rate), vehicle=vehicle)[10:], expected, atol=1e-12)


@pytest.mark.parametrize('model', MODELS)
def test_integration_is_of_fourth_order(model):
    # Half the step, a sixteenth of the error. The steps divide the period, and are long enough
    # for errors far above rounding and short enough to resolve a motion of all axes at once.
    # No rate changes its sign here: there K w|w| has a kink, which leaves an error of order 3.
    seconds, steps = (0.2, (1 / 200, 1 / 400, 1 / 800)) if model == 'newton_euler' \
        else (0.05, (1 / 400, 1 / 800, 1 / 1600))
    inputs = np.tile([7.0, 0.5, -0.3, 0.2], (round(seconds / PERIOD) + 1, 1))

    def end(step):
        columns = fly(inputs, model, UNEQUAL, step=step, omega_r=30.0).record.columns
        return np.array([columns[name][-1] for name in ('pz', 'px', 'wx', 'wy', 'wz', 'psi')])

    exact = end(steps[-1] / 16)
    errors = [np.abs(end(step) - exact) for step in steps]
    for coarse, fine in zip(errors, errors[1:], strict=False):
        assert np.linalg.norm(coarse) / np.linalg.norm(fine) == pytest.approx(16, rel=0.05)


def test_the_stated_step_is_kept_whatever_the_sample_period():
    # A longer sample period must not make the integration coarser.
    inputs = np.tile([7.0, 0.5, -0.3, 0.2], (2, 1))
    slow = simulate(UNEQUAL, 'newton_euler', inputs, 1.0)
    fast = simulate(UNEQUAL, 'newton_euler', np.repeat(inputs[:1], 101, axis=0), 0.01)
    for name in ('px', 'py', 'pz', 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz', 'wx', 'wy', 'wz'):
        values = slow.record.columns[name]
        assert values[-1] == pytest.approx(fast.record.columns[name][-1], abs=1e-9), name
    assert LONGEST_STEP['newton_euler'] <= 1e-4


def test_quaternion_keeps_its_length():
    columns = fly(hold([7.0, 0.5, -0.3, 0.2])).record.columns
    length = sum(columns[name] ** 2 for name in ('qw', 'qx', 'qy', 'qz'))
    assert np.abs(length - 1).max() < 1e-14


@pytest.mark.parametrize('model', MODELS)
def test_the_angles_and_the_quaternion_of_a_record_agree(model):
    columns = fly(hold([7.0, 0.02, -0.03, 0.01], 0.5), model).record.columns
    euler = np.stack([columns[name] for name in ('phi', 'theta', 'psi')], -1)
    made = attitude.quaternion_from_euler(euler)
    found = np.stack([columns[name] for name in ('qw', 'qx', 'qy', 'qz')], -1)
    assert np.allclose(np.abs(np.sum(made * found, axis=1)), 1.0, atol=1e-12)


def test_inputs_are_held_between_samples():
    # A pulse in row k acts from t[k] to t[k+1] and nowhere else.
    inputs = hold(VEHICLE.hover_input, 0.1)
    inputs[4, 3] = 0.1
    rate = fly(inputs).record.columns['wz']
    assert not rate[:5].any()
    # The drag, 4e-7 N m at the 0.77 rad/s reached, takes 1e-4 of it and more with time.
    assert rate[5] == pytest.approx(0.1 / VEHICLE.inertia[2] * PERIOD, rel=5e-3)
    assert (np.diff(rate[5:]) <= 0).all()


@pytest.mark.parametrize('inputs', [np.zeros((1, 4)), np.zeros((5, 3)), np.zeros(4)])
def test_inputs_of_the_wrong_shape_are_refused(inputs):
    with pytest.raises(InputError, match='inputs: expected'):
        fly(inputs)


def test_inputs_that_are_no_numbers_are_refused_with_their_row():
    inputs = hold(VEHICLE.hover_input, 0.1)
    inputs[3, 2] = np.nan
    with pytest.raises(InputError, match='row 3'):
        fly(inputs)


def test_a_run_of_too_many_steps_is_refused_at_once():
    with pytest.raises(InputError, match='steps'):
        fly(hold(VEHICLE.hover_input), step=1e-12)


def test_a_state_beyond_all_numbers_ends_the_run():
    inputs = hold(VEHICLE.hover_input, 0.1)
    inputs[4:, 0] = 1e308
    flight = fly(inputs)
    assert flight.status == 'diverged'
    assert len(flight.record) == 5 and 0.04 < flight.end_time < 0.05


def test_divergence_within_the_first_sample_is_said_with_its_time():
    with pytest.raises(InputError, match='diverges at t = .* s, before the second sample'):
        fly(hold([1e308, 0, 0, 0], 0.1))
