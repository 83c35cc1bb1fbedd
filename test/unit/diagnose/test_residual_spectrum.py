# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""At which frequencies the residual acceleration lies."""

import numpy as np
import pytest

from quad_ident_ros.diagnose.residual_spectrum import residual_spectrum
from quad_ident_ros.diagnose.residual_wrench import EVERY, ResidualWrench
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')


def flight(force, stretch=None):
    """Return the residual of a flight whose force (N,) N acts along x, the same moment about z."""
    values = np.zeros((len(force), 6))
    values[:, 0] = force
    values[:, 5] = force
    return ResidualWrench(values, np.full(values.shape, 1e-3), EVERY * np.arange(len(force)), {},
                          np.zeros(len(force), int) if stretch is None else stretch)


def sine(frequency, count=800):
    return np.sin(2.0 * np.pi * frequency * EVERY * np.arange(count))


def test_a_sine_lies_at_its_frequency_with_its_power():
    frequency, density = residual_spectrum([flight(0.3 * sine(1.0))], VEHICLE)
    assert frequency[np.argmax(density[:, 0])] == pytest.approx(1.0)
    power = density.sum(axis=0) * (frequency[1] - frequency[0])
    assert power[0] == pytest.approx((0.3 / VEHICLE.mass) ** 2 / 2, rel=0.01)
    assert power[5] == pytest.approx((0.3 / VEHICLE.inertia[2]) ** 2 / 2, rel=0.01)
    assert not density[:, 1:5].any()


def test_white_noise_has_the_same_density_everywhere():
    """Its variance over the band up to half the rate of the windows: 2 dt sigma^2."""
    noise = np.random.default_rng(0).normal(0.0, 0.2, 40000)
    _, density = residual_spectrum([flight(noise)], VEHICLE)
    np.testing.assert_allclose(density[:, 0], 2 * EVERY * (0.2 / VEHICLE.mass) ** 2, rtol=0.2)


def test_an_offset_is_no_oscillation():
    _, plain = residual_spectrum([flight(sine(0.8))], VEHICLE)
    _, shifted = residual_spectrum([flight(sine(0.8) + 5.0)], VEHICLE)
    np.testing.assert_allclose(shifted, plain, rtol=1e-6, atol=1e-12)


def test_flights_count_by_their_length_and_breaks_are_none_of_it():
    loud, silent = flight(sine(1.0, 600)), flight(np.zeros(200))
    _, alone = residual_spectrum([loud], VEHICLE)
    _, both = residual_spectrum([loud, silent], VEHICLE)
    np.testing.assert_allclose(both, 0.75 * alone, rtol=1e-9, atol=1e-15)
    # A step between two stretches, each of which is constant, is no force that oscillates.
    stretch = np.repeat([0, 1], 200)
    _, density = residual_spectrum([flight(1.0 * stretch, stretch)], VEHICLE)
    assert density.max() < 1e-20


def test_stretches_of_two_seconds_have_a_spectrum_too():
    """Those of a single flight of which blocks are held out."""
    stretch = np.repeat(np.arange(5), 40)
    frequency, density = residual_spectrum([flight(np.tile(sine(1.0, 40), 5), stretch)], VEHICLE)
    assert frequency[0] == pytest.approx(0.5)
    assert frequency[np.argmax(density[:, 0])] == pytest.approx(1.0)
