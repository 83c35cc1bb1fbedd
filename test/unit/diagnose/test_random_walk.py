# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forces and moments that no logged command explains: how fast variances grow by them."""

import numpy as np
import pytest
from scipy.signal import lfilter

from quad_ident_ros.diagnose.noise import random_walk
from quad_ident_ros.diagnose.rules import RULES

PERIOD, COUNT, ROLLOUTS, SIGMA = 0.01, 50, 240, 0.01
FORGOTTEN = np.zeros(3)


def white(seed=1, period=PERIOD):
    count = round(0.5 / period)
    return SIGMA * np.random.default_rng(seed).standard_normal((ROLLOUTS, count + 1, 3))


# Ten samples of a rollout at 20 Hz do not show the smaller one in this noise.
@pytest.mark.parametrize(('growth', 'period'), [(1e-3, 0.002), (1e-3, 0.01), (1e-2, 0.002),
                                                (1e-2, 0.01), (1e-2, 0.05)])
def test_a_random_walk_grows_by_what_its_steps_have(growth, period):
    noise = white(period=period)
    steps = np.sqrt(growth * period) * np.random.default_rng(2).standard_normal(noise.shape)
    found = random_walk([(noise + np.cumsum(steps, axis=1), period)], FORGOTTEN, RULES)
    # The smaller of two slopes is taken: a little low where both are as noisy.
    assert np.all((0.5 * growth < found) & (found < 1.25 * growth))


def test_nothing_is_a_walk_beside_noise_that_may_be_remembered_for_any_time():
    steps = np.sqrt(1e-2 * PERIOD) * np.random.default_rng(2).standard_normal(white().shape)
    parts = [(white() + np.cumsum(steps, axis=1), PERIOD)]
    assert np.all(random_walk(parts, FORGOTTEN, RULES) > 0.0)
    assert np.all(random_walk(parts, np.full(3, np.inf), RULES) == 0.0)


def test_noise_of_the_sensor_is_no_walk():
    assert np.all(random_walk([(white(), PERIOD)], FORGOTTEN, RULES) == 0.0)


def test_filtered_noise_is_no_walk():
    share = 1.0 - np.exp(-2.0 * np.pi * 20.0 * PERIOD)
    filtered = lfilter([share], [1.0, share - 1.0], white(), axis=1)[:, 10:]
    assert np.all(random_walk([(filtered, PERIOD)], FORGOTTEN, RULES) == 0.0)


@pytest.mark.parametrize('memory', [0.05, 0.1, 0.2, 0.3])
def test_noise_that_is_remembered_for_longer_than_the_lags_is_no_walk(memory):
    """It changes in proportion to a lag, too, up to twice its variance (Ornstein-Uhlenbeck)."""
    keeps = np.exp(-PERIOD / memory)
    steps = np.sqrt(1.0 - keeps ** 2) * SIGMA * np.random.default_rng(4).standard_normal(
        (ROLLOUTS, 200 + COUNT, 3))
    noise = lfilter([1.0], [1.0, -keeps], steps, axis=1)[:, 199:] + white()
    deviation = np.full(3, np.sqrt(2.0) * SIGMA)
    assert np.all(random_walk([(noise, PERIOD)], deviation, RULES) == 0.0)


@pytest.mark.parametrize(('size', 'growth'), [(4.0, 5e-3), (4.0, 1e-2), (6.0, 1e-2), (8.0, 2e-2)])
def test_a_walk_shows_beside_a_swing_between_the_samples(size, growth):
    """As that of a control loop which is faster than the log, here at a quarter of its rate."""
    noise = size * SIGMA * np.random.default_rng(5).standard_normal((ROLLOUTS, 2 * COUNT + 1, 3))
    swing = lfilter([0.3], [1.0, 0.1, 0.64], noise, axis=1)[:, COUNT:]
    steps = np.sqrt(growth * PERIOD) * np.random.default_rng(2).standard_normal(swing.shape)
    found = random_walk([(swing + np.cumsum(steps, axis=1), PERIOD)], FORGOTTEN, RULES)
    assert np.all((0.5 * growth < found) & (found < 1.25 * growth))
    assert np.all(random_walk([(swing, PERIOD)], FORGOTTEN, RULES) < 0.1 * growth)


@pytest.mark.parametrize('frequency', [0.0, 0.5, 1.0])
def test_slow_moments_are_little_of_a_walk(frequency):
    """What an effect that is missing makes stays a gap: a tenth of it at most counts as noise."""
    t = PERIOD * np.arange(COUNT + 1)
    phase = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, (ROLLOUTS, 1, 3))
    moment = np.cos(2.0 * np.pi * frequency * t[:, None] + phase)
    error = np.cumsum(moment, axis=1) * PERIOD
    made = np.mean((error[:, -1] - error[:, 0]) ** 2, axis=0)
    assert np.all(random_walk([(error + white(), PERIOD)], FORGOTTEN, RULES) * t[-1] < 0.1 * made)


def test_lags_are_as_much_longer_in_a_slow_log():
    """At 20 Hz they are 1, 2 and 3 samples, or else 2, 4 and 6."""
    growth, period = 3e-2, 0.05
    noise = 6.0 * SIGMA * np.random.default_rng(5).standard_normal((ROLLOUTS, 40, 3))
    swing = lfilter([0.3], [1.0, 0.8, 0.16], noise, axis=1)[:, 29:]
    steps = np.sqrt(growth * period) * np.random.default_rng(2).standard_normal(swing.shape)
    found = random_walk([(swing + np.cumsum(steps, axis=1), period)], FORGOTTEN, RULES)
    assert np.all((0.5 * growth < found) & (found < 1.5 * growth))


def test_rollouts_that_are_too_short_tell_nothing():
    assert np.all(random_walk([(white()[:, :5], PERIOD)], FORGOTTEN, RULES) == 0.0)


def test_a_single_rollout_tells_nothing():
    walk = np.cumsum(white()[:1], axis=1)
    assert np.all(random_walk([(walk, PERIOD)], FORGOTTEN, RULES) == 0.0)
