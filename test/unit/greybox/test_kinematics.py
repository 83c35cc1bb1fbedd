# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Measurement noise, from the differences between sensors."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

from quad_ident_ros.greybox.errors import GROUPS, moved
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.kinematics import measurement_noise
from quad_ident_ros.greybox.noise import quick_noise
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.dynamics import Course
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
PERIOD, SECONDS = 0.01, 60.0
SIZES = np.repeat([0.001, 0.01, 0.003, 0.01], 3)
TIMES = np.arange(round(SECONDS / PERIOD)) * PERIOD


def motion():
    """Return states (N, 13) that swing and turn, by forces that no model knows."""
    def angles(t):
        return np.stack([0.3 * np.sin(1.9 * t), 0.2 * np.sin(2.7 * t + 1), 0.5 * np.sin(0.4 * t)],
                        axis=1)
    swing = np.array([0.7, 1.1, 1.6])
    position = np.sin(np.outer(TIMES, swing))
    velocity = swing * np.cos(np.outer(TIMES, swing))
    attitude = Rotation.from_euler('xyz', angles(TIMES))
    later, before = (Rotation.from_euler('xyz', angles(TIMES + h)) for h in (1e-4, -1e-4))
    rate = (before.inv() * later).as_rotvec() / 2e-4
    return np.concatenate([position, velocity, attitude.as_quat()[:, [3, 0, 1, 2]], rate], axis=1)


def noise(random, memory):
    """Return noise, (N, 12), of SIZES, half of its power with a memory, s, if there is one."""
    white = random.normal(size=(len(TIMES), 12))
    if not memory:
        return SIZES * white
    keep = np.exp(-PERIOD / memory)
    slow = lfilter([np.sqrt(1 - keep ** 2)], [1, -keep], random.normal(size=white.shape), axis=0)
    return SIZES * np.sqrt(0.5) * (white + slow)


def told(states, error, z=None):
    """Return the noise found for recorded states with an error, (4,) by group."""
    return drifting(states, error, z)[0]


def drifting(states, error, z=None):
    """Return that noise, and the drift of the velocity."""
    count = len(TIMES)
    course = Course(TIMES, np.ones((count, 4)), np.zeros(count))
    flight = Flight('a', course, moved(states, error), np.ones((count, 12), bool),
                    PERIOD, None, np.arange(0, count - 51, 50), 50)
    white = quick_noise(error.reshape(-1, 50, 12))
    found, drift = measurement_noise([flight], [nominal(VEHICLE) if z is None else z], white,
                                     white)
    return np.array([np.sqrt(np.mean(found[part] ** 2)) for part in GROUPS.values()]), drift


TRUE = np.array([np.sqrt(np.mean(SIZES[part] ** 2)) for part in GROUPS.values()])


def test_white_noise_is_told_as_it_is_whatever_moves_the_vehicle():
    """Forces change nothing: only what the sensors contradict one another in is noise."""
    found = told(motion(), noise(np.random.default_rng(1), None))
    np.testing.assert_allclose(found, TRUE, rtol=0.05)


@pytest.mark.slow
@pytest.mark.parametrize('memory', [0.05, 0.1, 0.3])
def test_noise_with_a_memory_is_told_whole(memory):
    """Half of the power hangs together: from sample to sample it does not show."""
    errors = [noise(np.random.default_rng(seed), memory) for seed in range(5)]
    found = np.mean([told(motion(), error) for error in errors], axis=0)
    near = np.mean([quick_noise(error.reshape(-1, 50, 12)) for error in errors], axis=0)[3]
    assert near < 0.8 * SIZES[3]
    velocity, attitude = found[1] / TRUE[1], found[2] / TRUE[2]
    assert 0.75 < velocity < 1.25
    assert 0.8 < attitude < 1.2


@pytest.mark.slow
def test_an_error_of_the_velocity_that_stays_over_a_prediction_is_a_drift():
    white = [noise(np.random.default_rng(seed), None) for seed in range(5)]
    slow = [error.copy() for error in white]
    keep, size = np.exp(-PERIOD / 2.0), 0.05
    for seed, error in enumerate(slow):
        steps = np.random.default_rng(10 + seed).normal(size=(len(TIMES), 3))
        error[:, 3:6] += size * lfilter([np.sqrt(1 - keep ** 2)], [1, -keep], steps, axis=0)
    stays, none = (np.mean([drifting(motion(), error)[1] for error in errors])
                   for errors in (slow, white))
    assert none < 0.1 * size < 0.3 * size < stays < 1.3 * size


def test_a_bias_of_a_sensor_is_no_noise():
    """What is constant shows in all samples alike."""
    bias = np.repeat([0.0, 0.02, 0.0, 0.02], 3)
    found = told(motion(), noise(np.random.default_rng(2), None) + bias)
    np.testing.assert_allclose(found, TRUE, rtol=0.1)


def test_a_tilt_of_the_attitude_that_is_known_is_no_noise():
    """A tilted frame turns about other axes than the rate: undone, nothing is left of it."""
    tilt = np.array([0.08, -0.06, 0.1])
    z = nominal(VEHICLE)
    z[[INDEX[f'attitude_misalignment.{axis}'] for axis in ('roll', 'pitch', 'yaw')]] = tilt
    error = noise(np.random.default_rng(3), None)
    turned = moved(motion(), np.append(np.zeros(6), np.append(tilt, np.zeros(3))))
    assert (told(turned, error) / TRUE).max() > 1.3
    np.testing.assert_allclose(told(turned, error, z), TRUE, rtol=0.05)


@pytest.mark.parametrize('moves', ['height', 'heading'])
def test_exact_states_of_a_motion_along_one_axis_have_no_noise(moves):
    """Along the others nothing drifts at all, not even by what arithmetic makes of it."""
    states = np.zeros((len(TIMES), 13))
    states[:, 6] = 1.0
    if moves == 'height':
        states[:, 2], states[:, 5] = 0.5 * TIMES, 0.5
    else:
        states[:, 6], states[:, 9] = np.cos(0.1 * TIMES), np.sin(0.1 * TIMES)
        states[:, 12] = 0.2
    with np.errstate(divide='raise', over='raise', invalid='raise'):
        found = told(states, np.zeros((len(TIMES), 12)))
    assert np.all(found < 1e-3)
