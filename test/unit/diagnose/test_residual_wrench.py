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
    shared_features,
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


FORCE = ('ax', 'ay', 'az')


@pytest.fixture(scope='module')
def felt():
    """Return a hover with an accelerometer, longer than what spectra are taken of."""
    return fly_closed_loop(VEHICLE, {}, 'hover', duration=130.0, seed=1,
                           noise=Sensors(white=replace(SIZES, force=0.05)))


@pytest.fixture(scope='module')
def hover(felt):
    """Return the same without the accelerometer."""
    return replace(felt, columns={name: column for name, column in felt.columns.items()
                                  if name not in FORCE})


def pushed(record, frequency):
    """Return a record whose thrust is recorded without a wave (Hz) that it had."""
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


@pytest.mark.slow
def test_the_accelerometer_shows_small_forces_more_clearly(hover, felt):
    with_it, without = (residual_wrench(track_of(one, VEHICLE), VEHICLE, nominal(VEHICLE), NOISE)
                        for one in (felt, hover))
    # 0.05 m/s^2 over the 20 samples of a window; half of the noise of the velocity's slope is
    # larger by far.
    expected = VEHICLE.mass * 0.05 / np.sqrt(20.0)
    np.testing.assert_allclose(with_it.errors[:, :3], expected, rtol=0.3)
    assert (without.errors[:, :3] > 2.0 * with_it.errors[:, :3]).all()
    np.testing.assert_allclose(np.std(with_it.values[:, :3], axis=0), expected, rtol=0.4)
    np.testing.assert_array_equal(with_it.values[:, 3:], without.values[:, 3:])


@pytest.mark.slow
def test_a_wave_has_its_size_by_the_accelerometer(felt):
    """The mean over a window of 0.2 s takes of 3 Hz what a sinc says."""
    track = track_of(pushed(felt, 3.0), VEHICLE)
    found = residual_wrench(track, VEHICLE, nominal(VEHICLE), NOISE)
    rms = np.sqrt(np.mean(found.values[:, 2] ** 2 - found.errors[:, 2] ** 2))
    whole = WAVE * VEHICLE.mass * VEHICLE.gravity / np.sqrt(2.0)
    assert rms == pytest.approx(whole * np.sinc(3.0 * 0.2), rel=0.1)


@pytest.mark.slow
def test_an_offset_of_the_accelerometer_is_no_force(felt):
    shifted = replace(felt, columns=felt.columns | {'ax': felt.columns['ax'] + 0.5})
    one, other = (residual_wrench(track_of(record, VEHICLE), VEHICLE, nominal(VEHICLE), NOISE)
                  for record in (felt, shifted))
    np.testing.assert_allclose(other.values, one.values, atol=1e-9)


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


def test_the_force_is_told_at_ten_samples_a_second():
    """Logs of autopilots have no more by default; a window has two samples then."""
    record = fly_closed_loop(VEHICLE, {}, 'lissajous', duration=20.0)
    tenth = replace(record, t=record.t[::10], columns={
        name: values[::10] for name, values in record.columns.items()})
    track = track_of(tenth, VEHICLE)
    found = residual_wrench(track, VEHICLE, nominal(VEHICLE), NOISE)
    assert np.isfinite(found.values).all() and np.isfinite(found.errors).all()


def test_a_regime_is_one_that_all_flights_can_have():
    """Where one flight has no height, as without a position, the others' is no regime."""
    rng = np.random.default_rng(2)
    height = np.linspace(0.2, 2.2, 200)
    values = 1e-3 * rng.normal(size=(200, 6))
    values[height < 0.7, 2] += 0.1
    features = {'speed': ('m/s', rng.uniform(0.0, 1.0, 200)), 'height': ('m', height)}
    low, unknown = (ResidualWrench(values, np.full((200, 6), 1e-3), 0.05 * np.arange(200), some,
                                   np.zeros(200, int))
                    for some in (features, {'speed': features['speed']}))
    assert regime((low,), 'Fz', RULES.regime)[0].startswith('height')
    for flights in ((low, unknown), (unknown, low)):
        assert shared_features(flights) == ['speed']
        assert not regime(flights, 'Fz', RULES.regime)[0].startswith('height')
