# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The force and moment that the model does not explain: their channel, size and band."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.diagnose.residual_wrench import (
    band,
    regime,
    residual_wrench,
    ResidualWrench,
    shares,
)
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import Noise, Sensors
from quad_ident_ros.greybox.flights import track_of
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
SIZES = Noise(position=7e-4, velocity=7e-3, attitude=1.4e-3, rate=7e-3)
NOISE = np.repeat([7e-4, 7e-3, 1.4e-3, 7e-3], 3)
WAVE = 0.05     # of the thrust


@pytest.fixture(scope='module')
def hover():
    """Return a hover that is longer than what spectra are taken of."""
    return fly_closed_loop(VEHICLE, {}, 'hover', duration=130.0, seed=1,
                           noise=Sensors(white=SIZES))


def pushed(record, frequency):
    """Return a record whose thrust is told without a wave (Hz) that it had."""
    factor = np.sqrt(1.0 + WAVE * np.sin(2.0 * np.pi * frequency * record.t))
    return replace(record, columns=record.columns | {
        f'cmd{j}': record.columns[f'cmd{j}'] * factor for j in range(1, 5)})


@pytest.mark.slow
@pytest.mark.parametrize('frequency', [0.4, 3.0])
def test_a_line_is_found_where_it_is_in_a_long_flight(hover, frequency):
    track = track_of(pushed(hover, frequency), VEHICLE)
    found = (residual_wrench(track, VEHICLE, nominal(VEHICLE), NOISE),)
    low, high = band(found, 'Fz')
    assert low == pytest.approx(frequency, abs=0.1) and high == pytest.approx(frequency, abs=0.1)
    assert shares(found, VEHICLE)['Fz'] > 0.8


@pytest.mark.slow
@pytest.mark.parametrize('frequency', [0.4, 3.0])
def test_it_has_the_size_of_the_force_over_a_window(hover, frequency):
    """The slope of the velocity over a window weighs a force by a parabola."""
    track = track_of(pushed(hover, frequency), VEHICLE)
    found = residual_wrench(track, VEHICLE, nominal(VEHICLE), NOISE)
    rms = np.sqrt(np.mean(found.values[:, 2] ** 2 - found.errors[:, 2] ** 2))
    turn = np.pi * frequency * 0.2
    smoothed = 3.0 * (np.sin(turn) - turn * np.cos(turn)) / turn ** 3
    whole = WAVE * VEHICLE.mass * VEHICLE.gravity / np.sqrt(2.0)
    assert rms == pytest.approx(whole * smoothed, rel=0.1)


@pytest.mark.slow
def test_what_noise_makes_is_the_error_that_is_told(hover):
    found = residual_wrench(track_of(hover, VEHICLE), VEHICLE, nominal(VEHICLE), NOISE)
    np.testing.assert_allclose(np.std(found.values, axis=0),
                               np.sqrt(np.mean(found.errors ** 2, axis=0)), rtol=0.15)


def test_the_regime_is_the_part_that_has_most_of_it():
    height = np.tile(np.linspace(0.2, 2.2, 200), 3)
    values = 1e-3 * np.random.default_rng(1).normal(size=(600, 6))
    values[height < 0.7, 2] += 0.1
    found = (ResidualWrench(values, np.full((600, 6), 1e-3), 0.05 * np.arange(600),
                            {'speed': ('m/s', np.linspace(0.0, 1.0, 600)),
                             'height': ('m', height)}, np.zeros(600, int)),)
    text, share = regime(found, 'Fz', RULES.regime)
    assert text == f'height under {np.quantile(height, 0.25):.3g} m' and share > 0.9
    assert regime(found, 'Mx', RULES.regime)[0] in ('everywhere', 'nowhere above the noise')
