# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitude conversions, against SciPy's and against motions whose angles are known."""

from hypothesis import assume, given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quad_ident_ros.model.attitude import (
    body_rate,
    conjugate,
    continuous,
    euler_from_quaternion,
    product,
    quaternion_from_euler,
    rotate,
    rotation_matrix,
    turn,
    turned_on,
    unwrap_euler,
)

FAST = settings(deadline=None, max_examples=100)
angle = st.floats(-10, 10)
steep = st.floats(-1.5, 1.5)


@FAST
@given(angle, angle, angle)
def test_conversions_agree_with_scipy(roll, pitch, yaw):
    other = Rotation.from_euler('ZYX', [yaw, pitch, roll])
    found = quaternion_from_euler([roll, pitch, yaw])
    expected = other.as_quat()[[3, 0, 1, 2]]
    assert abs(abs(found @ expected) - 1) < 1e-14
    assert np.allclose(rotation_matrix(found), other.as_matrix(), atol=1e-14)


@FAST
@given(angle, steep, angle)
def test_angles_come_back_up_to_whole_turns(roll, pitch, yaw):
    found = euler_from_quaternion(quaternion_from_euler([roll, pitch, yaw]))
    # asin has lost half the digits of the pitch at 1.5 rad, and no more.
    difference = found - [roll, pitch, yaw]
    assert np.abs(difference - 2 * np.pi * np.round(difference / (2 * np.pi))).max() < 1e-8


@FAST
@given(angle, steep, angle)
def test_q_and_minus_q_are_one_attitude(roll, pitch, yaw):
    quaternion = quaternion_from_euler([roll, pitch, yaw])
    assert (euler_from_quaternion(-quaternion) == euler_from_quaternion(quaternion)).all()
    assert (rotation_matrix(-quaternion) == rotation_matrix(quaternion)).all()


def test_the_poles_of_the_angles_are_no_error():
    for pitch in (np.pi / 2, -np.pi / 2):
        found = euler_from_quaternion(quaternion_from_euler([0.3, pitch, 0.3]))
        assert found[1] == pytest.approx(pitch, abs=1e-7) and np.isfinite(found).all()


@pytest.mark.parametrize('axis', range(3))
@pytest.mark.parametrize('speed', [1.0, -1.0, 6.0, -29.0])
def test_unwrapping_follows_many_turns_about_one_axis(axis, speed):
    # Also over the top in pitch, where the folded angle turns back at 90 degrees; 0.29 rad a
    # sample is far below the half turn at which the sign is open.
    angles = np.zeros((1000, 3))
    angles[:, axis] = speed * 0.01 * np.arange(1000)
    folded = euler_from_quaternion(quaternion_from_euler(angles))
    # 1e-7: asin next to 90 degrees.
    assert np.abs(unwrap_euler(folded) - angles).max() < 1e-7


@pytest.mark.slow
@FAST
@given(st.integers(0, 2 ** 32 - 1))
def test_unwrapping_follows_a_smooth_motion_of_all_axes(seed):
    random = np.random.default_rng(seed)
    t = np.linspace(0, 1, 800)[:, None]
    angles = (random.normal(size=3) * 15 * t + random.normal(size=3) * t ** 2)
    # Through +-90 degrees of pitch with another angle off zero the angles themselves jump.
    angles[:, 1] = 1.2 * np.sin(angles[:, 1])
    found = unwrap_euler(euler_from_quaternion(quaternion_from_euler(angles)))
    assert np.abs(found - angles).max() < 1e-9


def test_unwrapping_starts_near_its_reference():
    angles = np.array([[0.1, 0.0, 0.2], [0.1, 0.0, 0.3]])
    found = unwrap_euler(angles, reference=(0.0, 0.0, 4 * np.pi))
    assert np.allclose(found - angles, [0, 0, 4 * np.pi])


@FAST
@given(steep, steep, angle, st.tuples(angle, angle, angle))
def test_body_rate_is_that_of_the_turning_matrix(roll, pitch, yaw, euler_rate):
    # R^T R' = S(Omega): by central differences, whose error is of order (h |rate|)^2.
    assume(abs(pitch) < 1.5)
    euler, step = np.array([roll, pitch, yaw]), 1e-6
    ahead, behind = (rotation_matrix(quaternion_from_euler(euler + s * step
                                                           * np.array(euler_rate)))
                     for s in (1, -1))
    skew = rotation_matrix(quaternion_from_euler(euler)).T @ (ahead - behind) / (2 * step)
    found = body_rate(euler[None], np.array([euler_rate]))[0]
    assert np.allclose(found, [skew[2, 1], skew[0, 2], skew[1, 0]], atol=1e-6)


@FAST
@given(st.lists(angle, min_size=9, max_size=9))
def test_products_are_turns_one_after_another(numbers):
    first, second, vector = np.reshape(numbers, (3, 3))
    one, two = Rotation.from_rotvec(first), Rotation.from_rotvec(second)
    both = product(turn(first), turn(second))
    assert np.allclose(rotation_matrix(both), (one * two).as_matrix(), atol=1e-13)
    assert np.allclose(rotate(both, vector), (one * two).apply(vector), atol=1e-12)
    assert np.allclose(product(both, conjugate(both)), [1, 0, 0, 0], atol=1e-14)
    assert np.allclose(turned_on(turn([first, second]))[-1], both, atol=1e-14)


def test_one_quaternion_is_multiplied_with_each_of_many():
    many = np.random.default_rng(0).normal(size=(2, 3, 4))
    half = [0, 0, 0, 1]
    for place in np.ndindex(2, 3):
        assert (product(half, many)[place] == product(half, many[place])).all()
    assert product(half, half).tolist() == [-1, 0, 0, 0]


def test_signs_are_continued_through_a_whole_turn():
    path = turn(np.linspace(0, 2 * np.pi, 50)[:, None] * [0, 0, 1])
    jumping = path * np.where(np.arange(50) % 3 == 1, -1, 1)[:, None]
    assert np.allclose(continuous(jumping), path)
