# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Measurement noise, from what changes between samples."""

import numpy as np
import pytest

from quad_ident_ros.greybox.noise import quick_noise

SHAPE = (1000, 51, 12)   # rollouts, samples, errors
SIZE = 0.02


def white(random):
    return random.normal(size=SHAPE)


def long_tailed(random):
    return random.laplace(scale=np.sqrt(0.5), size=SHAPE)


def swinging(random):
    """Return noise whose deviation changes by a factor of 1.7 along the flight, 1 as a whole."""
    size = np.exp(np.log(1.7) * np.sin(np.linspace(0.0, 40.0, SHAPE[0])))[:, None, None]
    return random.normal(size=SHAPE) * size / np.sqrt(np.mean(size ** 2))


@pytest.mark.parametrize('kind', [white, long_tailed, swinging])
def test_noise_is_the_root_mean_square_whatever_its_distribution(kind):
    """Gaps are root mean squares, so what the noise makes of them is as well."""
    told = quick_noise(SIZE * kind(np.random.default_rng(1)))
    np.testing.assert_allclose(told, SIZE, rtol=0.03)


def test_outliers_are_no_noise():
    random = np.random.default_rng(2)
    errors = SIZE * white(random)
    errors[random.random(SHAPE) < 0.002] += 50.0 * SIZE
    np.testing.assert_allclose(quick_noise(errors), SIZE, rtol=0.03)


def test_what_is_smooth_is_no_noise():
    t = np.linspace(0.0, 0.5, SHAPE[1])[:, None]
    errors = SIZE * white(np.random.default_rng(3)) + 5.0 * t ** 2 + np.sin(6.0 * t)
    np.testing.assert_allclose(quick_noise(errors), SIZE, rtol=0.03)
