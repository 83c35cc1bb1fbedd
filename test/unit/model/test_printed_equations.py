# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Where eqs. (13)-(18) as printed differ from what follows from eqs. (1)-(12), term by term.

The right sides of (13)-(15) are body accelerations, so they are compared with those: `difference`
is printed minus derived, at one attitude and one set of Euler rates.
"""

from dataclasses import replace

import equations_of_motion as motion
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.model import attitude, equations
from quad_ident_ros.model.simulate import simulate
from quad_ident_ros.model.vehicle import load_vehicle

FAST = settings(deadline=None, max_examples=100)
PAPER = load_vehicle('paper_quadrotor')
# Three different inertias and drags, so that no term is hidden by an equal one.
VEHICLE = replace(PAPER, inertia=(7.5e-3, 5e-3, 1.1e-2), rotational_drag=(5e-4, 4e-4, 6e-4))
FRICTIONLESS = replace(VEHICLE, rotational_drag=(0.0, 0.0, 0.0))
IX, IY, IZ = VEHICLE.inertia
KX, KY, KZ = VEHICLE.rotational_drag
JR = VEHICLE.rotor_inertia

angle = st.floats(-1.4, 1.4)
rate = st.floats(-30, 30)
triple_angle, triple_rate = st.tuples(angle, angle, angle), st.tuples(rate, rate, rate)


def printed(euler, euler_rate, inputs=(0, 0, 0, 0), omega_r=0.0, vehicle=VEHICLE,
            velocity=(0, 0, 0)):
    """Return the right sides of eqs. (13)-(15), and of (16)-(18)."""
    out = np.empty(12)
    state = np.concatenate([np.zeros(3), velocity, euler, euler_rate]).astype(float)
    equations.printed(state, np.asarray(inputs, float), omega_r,
                      equations.parameter_vector(vehicle), out)
    return out[9:], out[3:6]


def derived(euler, euler_rate, inputs=(0, 0, 0, 0), omega_r=0.0, vehicle=VEHICLE,
            velocity=(0, 0, 0)):
    """Return the body and world accelerations of the same motion, from eqs. (1)-(12)."""
    rate = attitude.body_rate(np.array([euler], float), np.array([euler_rate], float))[0]
    state = np.concatenate([np.zeros(3), velocity,
                            attitude.quaternion_from_euler(np.array(euler, float)), rate])
    out = motion.derivative(vehicle, state, inputs, omega_r)
    return out[10:], out[3:6]


def difference(euler, euler_rate, omega_r=0.0, vehicle=VEHICLE):
    return (printed(euler, euler_rate, omega_r=omega_r, vehicle=vehicle)[0]
            - derived(euler, euler_rate, omega_r=omega_r, vehicle=vehicle)[0])


def close(found, expected):
    # Accelerations reach 1e4 rad/s^2; 1e-10 is rounding of that.
    return np.allclose(found, expected, rtol=1e-10, atol=1e-10)


# Where they agree.

@FAST
@given(triple_angle, triple_rate, st.floats(-50, 50))
def test_translation_16_to_18_is_right(euler, velocity, thrust):
    inputs = (thrust, 0, 0, 0)
    assert close(printed(euler, (0, 0, 0), inputs, velocity=velocity)[1],
                 derived(euler, (0, 0, 0), inputs, velocity=velocity)[1])


@FAST
@given(triple_angle, triple_rate, st.tuples(rate, rate, rate))
def test_moments_of_the_inputs_are_right(euler, euler_rate, moments):
    inputs = (0.0, *moments)
    for equation in (printed, derived):
        change = equation(euler, euler_rate, inputs)[0] - equation(euler, euler_rate)[0]
        lever = VEHICLE.arm_length
        assert close(change, (lever * moments[0] / IX, lever * moments[1] / IY, moments[2] / IZ))


@FAST
@given(triple_angle, triple_rate)
def test_body_gyroscopics_are_right(euler, euler_rate):
    # Without friction and rotors (13) and (14) are the derived ones, and (15) is but for the
    # friction without its coefficient.
    found = difference(euler, euler_rate, vehicle=FRICTIONLESS)
    assert close(found[:2], 0)
    (roll, pitch, _), (roll_rate, pitch_rate, yaw_rate) = euler, euler_rate
    assert close(found[2], -(pitch_rate ** 2 * np.sin(roll) ** 2
                             - 2 * roll_rate * yaw_rate * np.sin(roll) * np.cos(roll)
                             * np.cos(pitch)))


@FAST
@given(triple_angle, triple_rate, st.floats(-500, 500))
def test_rotor_terms_of_13_and_14_are_right(euler, euler_rate, omega_r):
    change = (difference(euler, euler_rate, omega_r=omega_r)
              - difference(euler, euler_rate, omega_r=0.0))
    assert close(change[:2], 0)


@pytest.mark.parametrize('axis', range(2))
def test_friction_of_one_positive_roll_or_pitch_rate_is_right(axis):
    euler_rate = np.zeros(3)
    euler_rate[axis] = 7.0
    assert close(difference((0, 0, 0), euler_rate), 0)


# (13).

def test_13_friction_loses_the_square_of_the_yaw_rate():
    # Yaw alone, pitched by 30 degrees: the body rolls at -psi' sin theta, which (13) does not
    # brake at all.
    found = difference((0, np.pi / 6, 0), (0, 0, 10.0))
    assert close(found[0], -KX / IX * 25.0)
    assert printed((0, np.pi / 6, 0), (0, 0, 10.0))[0][0] == pytest.approx(0, abs=1e-12)


def test_13_friction_has_the_sine_of_theta_squared_in_its_cross_term():
    # (phi' - psi' s)^2 has -2 phi' psi' s; printed is s^2 (the derived rate here is positive).
    phi_rate, psi_rate, s = 9.0, 2.0, np.sin(0.5)
    found = difference((0, 0.5, 0), (phi_rate, 0, psi_rate))
    assert close(found[0], -KX / IX * (-2 * phi_rate * psi_rate * (s ** 2 - s)
                                       - psi_rate ** 2 * s ** 2))


def test_13_friction_is_unsigned():
    # It pushes a negative roll rate further down instead of braking it.
    assert printed((0, 0, 0), (-6.0, 0, 0))[0][0] == pytest.approx(-KX / IX * 36)
    assert derived((0, 0, 0), (-6.0, 0, 0))[0][0] == pytest.approx(KX / IX * 36)


# (14).

def test_14_friction_lacks_pitch_times_yaw():
    # (theta' c + psi' s ct)^2 has 2 theta' psi' s c ct, which is not printed.
    found = difference((np.pi / 4, 0, 0), (0, 3.0, 5.0))
    assert close(found[1], KY / IY * 2 * 3.0 * 5.0 * 0.5)


def test_14_friction_has_roll_times_yaw_instead():
    found = difference((np.pi / 4, 0, 0), (3.0, 0, 5.0))
    assert close(found[1], -KY / IY * 2 * 3.0 * 5.0 * 0.5)


def test_14_friction_is_unsigned():
    assert printed((0, 0, 0), (0, -6.0, 0))[0][1] == pytest.approx(-KY / IY * 36)
    assert derived((0, 0, 0), (0, -6.0, 0))[0][1] == pytest.approx(KY / IY * 36)


# (15).

def test_15_has_a_rotor_term_that_is_a_copy_of_14():
    # The third entry of (11) is zero, and Iy is the wrong inertia.
    euler, euler_rate, omega_r = (0.3, 0.4, 0), (2.0, 1.0, 3.0), 250.0
    change = difference(euler, euler_rate, omega_r=omega_r) - difference(euler, euler_rate)
    assert close(change, (0, 0, -JR * omega_r / IY * (3.0 * np.sin(0.4) - 2.0)))


def test_15_friction_of_the_pitch_rate_lacks_its_coefficient():
    # Rolled on its side, a pitch rate is a yaw rate of the body. The bracket is printed without
    # Kfaz / Iz, so that it is the same whatever the vehicle: -1 rad/s^2 at 1 rad/s.
    for vehicle in (VEHICLE, FRICTIONLESS, PAPER):
        assert printed((np.pi / 2, 0, 0), (0, 1.0, 0), vehicle=vehicle)[0][2] == \
            pytest.approx(-1.0)
    assert derived((np.pi / 2, 0, 0), (0, 1.0, 0))[0][2] == pytest.approx(KZ / IZ)


def test_15_friction_has_roll_times_yaw_for_pitch_times_yaw():
    change = (printed((np.pi / 4, 0, 0), (3.0, 0, 5.0), vehicle=FRICTIONLESS)[0]
              - derived((np.pi / 4, 0, 0), (3.0, 0, 5.0), vehicle=FRICTIONLESS)[0])
    assert close(change[2], 2 * 3.0 * 5.0 * 0.5)
    # Pitch times yaw is not in the printed friction; in the derived one it is: -Kfaz w^2 / Iz of
    # the body's yaw rate w = psi' c - theta' s = 2 / sqrt(2).

    def right(*euler_rate):
        return printed((np.pi / 4, 0, 0), euler_rate)[0][2]
    assert right(0, 3.0, 5.0) - right(0, 3.0, 0) - right(0, 0, 5.0) == pytest.approx(0, abs=1e-12)
    assert derived((np.pi / 4, 0, 0), (0, 3.0, 5.0))[0][2] == pytest.approx(-2 * KZ / IZ)


def test_15_friction_drives_the_yaw_rate_instead_of_braking_it():
    assert printed((0, 0, 0), (0, 0, 4.0))[0][2] == pytest.approx(KZ / IZ * 16)
    assert derived((0, 0, 0), (0, 0, 4.0))[0][2] == pytest.approx(-KZ / IZ * 16)


# All at once: there is no other difference.

@FAST
@given(triple_angle, triple_rate, st.floats(-500, 500))
def test_the_differences_named_above_are_all(euler, euler_rate, omega_r):
    (roll, pitch, _), (dp, dt, ds) = euler, euler_rate
    sp, cp, st_, ct = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    wx, wy, wz = attitude.body_rate(np.array([euler]), np.array([euler_rate]))[0]
    expected = (
        -KX / IX * (dp ** 2 - 2 * dp * ds * st_ ** 2 - wx * abs(wx)),
        -KY / IY * (dt ** 2 * cp ** 2 + 2 * dp * ds * sp * cp * ct + ds ** 2 * sp ** 2 * ct ** 2
                    - wy * abs(wy)),
        -JR * omega_r / IY * (ds * st_ - dp) - (dt ** 2 * sp ** 2 - 2 * dp * ds * sp * cp * ct)
        + KZ / IZ * ds ** 2 * cp ** 2 * ct ** 2 + KZ / IZ * wz * abs(wz))
    assert close(difference(euler, euler_rate, omega_r=omega_r), expected)


# The left sides.

def euler_acceleration(euler, euler_rate, vehicle):
    """Return the Euler angles' second derivative of the derived motion, numerically."""
    step = 1e-4
    rate = attitude.body_rate(np.array([euler]), np.array([euler_rate]))[0]
    x = np.concatenate([np.zeros(6), attitude.quaternion_from_euler(np.array(euler)), rate])
    angles = []
    for direction in (-1, 0, 1):
        out = motion.move(vehicle, x, direction * step * np.arange(2), 10)
        angles.append(attitude.euler_from_quaternion(out[1, 6:10]))
    return (angles[0] - 2 * angles[1] + angles[2]) / step ** 2


def test_left_sides_are_body_accelerations_and_not_euler_accelerations():
    # Without friction and rotors the right sides of (13) and (14) are right as body
    # accelerations. As accelerations of the Euler angles, as printed, they are far off ...
    euler, euler_rate = (0.3, 0.4, 0.2), (2.0, 1.0, 3.0)
    right = printed(euler, euler_rate, vehicle=FRICTIONLESS)[0]
    true = euler_acceleration(euler, euler_rate, FRICTIONLESS)
    assert np.abs(right[:2] - true[:2]).min() > 1.0
    # ... and the terms that are missing are those of the derivative of W in eq. (3).
    (roll, pitch, _), (dp, dt, ds) = euler, euler_rate
    p, q, r = derived(euler, euler_rate, vehicle=FRICTIONLESS)[0]
    turning = q * np.sin(roll) + r * np.cos(roll)
    expected = (p + turning * np.tan(pitch) + dp * dt * np.tan(pitch) + ds * dt / np.cos(pitch),
                q * np.cos(roll) - r * np.sin(roll) - dp * ds * np.cos(pitch),
                (turning + dp * dt + ds * dt * np.sin(pitch)) / np.cos(pitch))
    # Second differences over 1e-4 s: rounding 1e-16 / 1e-8 and curvature of order 1e-8.
    assert np.allclose(true, expected, atol=2e-6)


def test_left_sides_agree_at_small_angles_and_rates():
    # The missing terms are products of rates and angles: at 1e-3 they are 1e-6.
    small = (1e-3, -1e-3, 1e-3)
    right = printed(small, small, vehicle=FRICTIONLESS)[0]
    assert np.abs(right - euler_acceleration(small, small, FRICTIONLESS)).max() < 1e-5


# Whole motions.

@pytest.mark.parametrize(('column', 'angle_name'), [(1, 'phi'), (2, 'theta')])
def test_positive_roll_or_pitch_alone_is_the_same_motion(column, angle_name):
    inputs = np.tile(PAPER.hover_input, (501, 1))
    inputs[:, column] = 0.1
    one, other = (simulate(PAPER, model, inputs, 0.01).record.columns[angle_name]
                  for model in ('newton_euler', 'paper'))
    # Both are the closed form ln cosh; fourth order leaves 1e-12 of it.
    assert np.abs(one - other).max() < 1e-9 * one[-1]


def test_yaw_alone_is_the_same_motion_only_while_friction_is_small():
    inputs = np.tile([*PAPER.hover_input[:3], 1e-3], (11, 1))
    one, other = (simulate(PAPER, model, inputs, 0.01).record.columns['wz']
                  for model in ('newton_euler', 'paper'))
    # Friction is Kfaz psi'^2 of U4, 0.4 % at 0.077 rad/s after 0.1 s: once minus, once plus.
    assert one[-1] < 1e-3 / PAPER.inertia[2] * 0.1 < other[-1]
    assert np.abs(one - other).max() < 5e-3 * one[-1]
