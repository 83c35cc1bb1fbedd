# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Gusts have the spectra, deviations and lengths of Dryden's model."""

import numpy as np
import pytest
from scipy.signal import welch

from withheld import gusts


def blowing(size, **options):
    made = gusts.Gusts(size, {}, np.random.default_rng(1), **options)
    made.begin(np.random.default_rng(2))
    return made


@pytest.mark.parametrize('along', [True, False])
def test_the_spectrum_holds_the_variance(along):
    frequency = np.concatenate([[0.0], np.geomspace(1e-5, 1e4, 20000)])
    density = gusts.spectrum(frequency, 20.0, 1.3, 3.0, along)
    assert np.trapezoid(density, frequency) == pytest.approx(1.3 ** 2, rel=1e-3)


@pytest.mark.parametrize('along', [True, False])
def test_samples_have_the_spectrum_in_closed_form(along):
    step, length, deviation, speed = 0.02, 2.0, 0.8, 4.0
    samples = gusts.gust(length, deviation, speed, along, step, 2 ** 15,
                         np.random.default_rng(4))
    frequency, density = welch(samples, 1.0 / step, nperseg=1024)
    band = (frequency > 0.1) & (frequency < 3.0)
    expected = gusts.spectrum(frequency[band], length, deviation, speed, along)
    ratio = density[band] / expected
    # 63 averages: 13 % for each frequency, 1 % for their mean.
    assert ratio == pytest.approx(np.ones(band.sum()), abs=0.55)
    assert ratio.mean() == pytest.approx(1.0, abs=0.06)   # three standard errors
    assert samples.std() == pytest.approx(deviation, rel=0.07)


@pytest.mark.parametrize('along', [True, False])
def test_a_gust_begins_in_balance(along):
    first = [gusts.gust(2.0, 0.8, 4.0, along, 0.02, 2, np.random.default_rng(k))[0]
             for k in range(400)]
    assert np.std(first) == pytest.approx(0.8, rel=0.12)   # three standard errors


def test_what_is_up_tends_to_what_is_along_high_above_the_ground():
    # MIL-F-8785C: both lengths are 1000 feet, both deviations alike, at 1000 feet.
    assert gusts.lengths(1000 * 0.3048) == pytest.approx(np.full(3, 304.8), rel=1e-3)
    assert gusts.intensities(1000 * 0.3048, 10.0) == pytest.approx(np.ones(3), rel=1e-3)


def test_light_turbulence_grows_with_the_wind():
    # A tenth of 15 knots upwards.
    upwards = gusts.intensities(5.0, gusts.LIGHT)[2]
    assert upwards == pytest.approx(0.1 * 15 * 1852 / 3600, rel=1e-3)
    one, two = (blowing(size) for size in (0.5, 1.0))
    assert 2.0 * one.series == pytest.approx(two.series)


def test_gusts_blow_about_a_steady_wind():
    steady = np.array([1.0, -2.0, 0.0])
    blown = blowing(0.3, steady=steady)
    assert blown.wind(0.0, np.zeros(3)) == pytest.approx(steady + blown.series[0])
    between = blown.wind(0.015, np.zeros(3))
    assert between == pytest.approx(steady + 0.5 * (blown.series[1] + blown.series[2]))
    assert np.isfinite(blown.wind(1e3, np.zeros(3))).all()


def test_each_flight_has_its_own():
    blown = blowing(1.0)
    before = blown.series
    blown.begin(np.random.default_rng(3))
    assert np.abs(np.corrcoef(before[:, 0], blown.series[:, 0])[0, 1]) < 0.9
    assert not np.array_equal(before, blown.series)
