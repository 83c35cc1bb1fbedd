# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Between U1..U4 and rotor speeds, eqs. (9), (11), (19), and what no speeds can give."""

from dataclasses import replace
import itertools

from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.model import mixing
from quad_ident_ros.model.simulate import omega_r_of
from quad_ident_ros.model.vehicle import load_vehicle, Rotor

FAST = settings(deadline=None, max_examples=100)
VEHICLE = load_vehicle('paper_quadrotor')
B, D = VEHICLE.thrust_coefficient, VEHICLE.torque_coefficient
HOVER = VEHICLE.hover_input
NO_LIMIT = replace(VEHICLE, speed_max=float('inf'))

angles = np.arange(6) * np.pi / 3
HEXACOPTER = replace(VEHICLE, name='hexacopter', rotors=tuple(
    Rotor((0.25 * np.cos(angle), 0.25 * np.sin(angle), 0.02), 1 if k % 2 else -1)
    for k, angle in enumerate(angles)))


def reason(vehicle, inputs):
    return mixing.infeasibility(vehicle, np.array([inputs], float), np.zeros(1))


def printed_inputs(squared):
    """Return U1..U4 of squared speeds (4,) by eq. (19) as it stands."""
    w1, w2, w3, w4 = squared
    return [B * (w1 + w2 + w3 + w4), B * (w4 - w2), B * (w3 - w1), D * (w1 - w2 + w3 - w4)]


@FAST
@given(st.lists(st.floats(0, 1e6), min_size=4, max_size=4))
def test_squared_speeds_give_their_inputs_back(squared):
    inputs = printed_inputs(squared)
    found = mixing.squared_speeds(VEHICLE, [inputs])[0]
    # Condition of the 4 x 4 allocation is 10; speeds of 1e6 keep 1e-9 of it and more.
    assert np.allclose(found, squared, rtol=0, atol=1e-9 * max(squared) + 1e-12)
    assert np.allclose(mixing.allocation_matrix(VEHICLE) @ squared, inputs, rtol=1e-12, atol=1e-12)


def test_unit_steps_need_the_squared_speeds_of_the_errata():
    found = mixing.squared_speeds(VEHICLE, [[1.0, 1.0, 1.0, 1.0]])[0]
    assert np.allclose(found, [68974, -85729, 102484, -52219], atol=0.5)
    assert found.sum() == pytest.approx(1 / B)


def test_unit_steps_are_infeasible_and_the_message_says_which_rotor():
    message = reason(VEHICLE, [1.0, 1.0, 1.0, 1.0])
    assert 'rotor 2 would need a squared speed of -85728.9' in message
    assert 'U = (1, 1, 1, 1) at t = 0 s' in message and 'which must be 0 to 1e+06' in message
    # Without yaw too: w1^2 + w2^2 = -1/(2b).
    found = mixing.squared_speeds(VEHICLE, [[1.0, 1.0, 1.0, 0.0]])[0]
    assert found[0] + found[1] == pytest.approx(-1 / (2 * B))
    assert reason(VEHICLE, [1.0, 1.0, 1.0, 0.0])


@FAST
@given(st.floats(0, 20), st.floats(-8, 8), st.floats(-8, 8), st.floats(-1.5, 1.5))
def test_feasibility_is_that_of_the_errata(u1, u2, u3, u4):
    margin = min(u1 + B / D * u4 - 2 * abs(u3), u1 - B / D * u4 - 2 * abs(u2))
    if abs(margin) > 1e-6:
        assert (reason(NO_LIMIT, [u1, u2, u3, u4]) is None) == (margin > 0)


@pytest.mark.parametrize(('column', 'limit'), [(1, 3.187), (2, 3.187), (3, 0.690)])
def test_limits_at_hover_are_those_of_the_errata(column, limit):
    for sign in (1, -1):
        inputs = HOVER.copy()
        inputs[column] = sign * (limit - 5e-4)
        assert reason(VEHICLE, inputs) is None
        inputs[column] = sign * (limit + 1e-3)
        assert reason(VEHICLE, inputs)


def test_hover_speed_is_that_of_the_errata():
    assert np.allclose(np.sqrt(mixing.squared_speeds(VEHICLE, [HOVER])), 231.08, atol=5e-3)


@pytest.mark.parametrize(('column', 'size', 'expected'), [
    (1, 0.1, 0.057), (1, 1.0, 5.87), (3, 0.1, 67.1)])
def test_residual_rotor_speed_is_that_of_the_errata(column, size, expected):
    inputs = HOVER.copy()
    inputs[column] = size
    found = mixing.residual_rotor_speed(VEHICLE, [inputs])[0]
    # The table has three digits or two; the sign is that of w1 - w2 + w3 - w4.
    assert abs(found) == pytest.approx(expected, rel=1e-2)
    w = np.sqrt(mixing.squared_speeds(VEHICLE, [inputs])[0])
    assert found == pytest.approx(w[0] - w[1] + w[2] - w[3])


def test_residual_rotor_speed_of_clipped_unit_steps_is_that_of_the_errata():
    assert mixing.residual_rotor_speed(VEHICLE, [[1.0] * 4])[0] == pytest.approx(582.76, abs=5e-3)


def test_speed_limits_count():
    slow = replace(VEHICLE, speed_max=230.0)
    assert 'which must be 0 to 52900' in reason(slow, HOVER)
    assert reason(replace(VEHICLE, speed_max=232.0), HOVER) is None
    assert 'which must be 57600' in reason(replace(VEHICLE, speed_min=240.0), HOVER)


def test_the_first_sample_that_cannot_be_is_named():
    inputs = np.tile(HOVER, (5, 1))
    inputs[3, 3] = 1.0
    assert 'at t = 0.3 s' in mixing.infeasibility(VEHICLE, inputs, np.arange(5) * 0.1)


# Other vehicles.

@FAST
@given(st.lists(st.floats(1e4, 9e5), min_size=6, max_size=6))
def test_hexacopter_speeds_give_the_inputs(squared):
    # Six rotors leave a choice: any choice must give the inputs, and be possible if one is.
    inputs = mixing.allocation_matrix(HEXACOPTER) @ squared
    found = mixing.squared_speeds(HEXACOPTER, [inputs])[0]
    assert np.allclose(mixing.allocation_matrix(HEXACOPTER) @ found, inputs, rtol=1e-6, atol=1e-6)
    assert reason(HEXACOPTER, inputs) is None


def test_hexacopter_moments_have_their_lever_and_sign():
    # Rotors at y > 0 lift the left side: positive roll. Those at x > 0 lift the nose: pitch is
    # positive where it goes down.
    left = np.array([rotor.position[1] > 0.01 for rotor in HEXACOPTER.rotors], float)
    front = np.array([rotor.position[0] > 0.01 for rotor in HEXACOPTER.rotors], float)
    arm = HEXACOPTER.arm_length
    assert arm == pytest.approx(0.25)
    roll = mixing.allocation_matrix(HEXACOPTER) @ left
    pitch = mixing.allocation_matrix(HEXACOPTER) @ front
    assert roll[1] * arm == pytest.approx(2 * B * 0.25 * np.sin(np.pi / 3))
    assert pitch[2] * arm == pytest.approx(-B * 0.25 * (1 + 2 * np.cos(np.pi / 3)))


def test_hexacopter_uses_its_freedom_where_the_smallest_solution_is_impossible():
    # Full speed on some rotors and the least on the others: of the 64 cases, the even split
    # leaves the limits in some, but what speeds within them gave is never impossible.
    matrix = mixing.allocation_matrix(HEXACOPTER)
    for floor in (0.0, 100.0):
        vehicle = replace(HEXACOPTER, speed_min=floor)
        outside = 0
        for corner in itertools.product((floor ** 2, 1e6), repeat=6):
            inputs = matrix @ corner
            even = np.linalg.pinv(matrix) @ inputs
            outside += even.min() < floor ** 2 - 1 or even.max() > 1e6 + 1
            assert reason(vehicle, inputs) is None
        assert outside > 10


def test_hexacopter_has_limits_too():
    assert 'rotor' in reason(HEXACOPTER, [7 * 6 * B * 1e6, 0, 0, 0])
    assert reason(HEXACOPTER, [1.0, 5.0, 0, 0])


def test_inputs_that_the_rotors_cannot_make_at_all_are_infeasible():
    # All spin alike: hover without a yaw moment cannot be, whatever the speeds.
    alike = replace(VEHICLE, rotors=tuple(replace(r, spin=1) for r in VEHICLE.rotors))
    assert 'the 4 rotors, as they are placed and spin, cannot' in reason(alike, HOVER)
    assert reason(alike, [HOVER[0], 0, 0, HOVER[0] * D / B]) is None
    three = replace(VEHICLE, rotors=VEHICLE.rotors[:3])
    assert 'the 3 rotors' in reason(three, [6.0, 1.0, 0.0, 0.0])


# Omega_r of an experiment.

def test_omega_r_settings():
    inputs = np.tile(HOVER + [0, 0, 0, 0.1], (3, 1))
    t = np.arange(3.0)
    assert omega_r_of('zero', VEHICLE, inputs, t) == 0.0
    assert omega_r_of(61.45, VEHICLE, inputs, t) == 61.45
    assert omega_r_of(61.45, VEHICLE, inputs, t, sign=-1) == -61.45
    found = omega_r_of('from_rotors', VEHICLE, inputs, t)
    assert np.allclose(found, 67.1, atol=0.05)
    assert np.allclose(omega_r_of('from_rotors', VEHICLE, inputs, t, sign=-1), -found)


def test_omega_r_from_rotors_refuses_what_they_cannot_give():
    with pytest.raises(InputError, match='from_rotors needs feasible inputs, but no rotor speeds'):
        omega_r_of('from_rotors', VEHICLE, np.ones((3, 4)), np.arange(3.0))
