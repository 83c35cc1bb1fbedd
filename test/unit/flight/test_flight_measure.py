# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sensors: noise of the stated size and memory, delays, rates and faults as stated."""

from dataclasses import replace

from flying import PAPER
import numpy as np
import pytest

from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import (
    CLEAN,
    errors_of,
    FAULTY,
    gauss_markov,
    measured,
    MOCAP_IMU,
    Noise,
    Sensors,
    Stream,
)
from quad_ident_ros.model.attitude import rotation_matrix, turn

COUNT = 20000
T = np.arange(COUNT) / 100
LEVELS = Noise(position=1.0, velocity=2.0, attitude=3.0, rate=4.0, force=5.0)


def motion(t):
    """Return states (N, 13) and forces (N, 3) of a smooth motion with a turn about x."""
    states = np.zeros((len(t), 13))
    states[:, 0], states[:, 3] = np.sin(t), np.cos(t)
    angle, states[:, 10] = 0.5 * np.sin(2 * t), np.cos(2 * t)
    states[:, 6:10] = turn(np.stack([angle, 0 * t, 0 * t], axis=1))
    return states, np.stack([np.sin(3 * t), 0 * t, 9.8 + 0 * t], axis=1)


def shown(sensors, t=T, seed=0):
    return measured(sensors, t, *motion(t), errors_of(sensors, len(t), 0.01, seed), seed)


def test_white_noise_has_the_stated_deviation_and_no_memory():
    errors = errors_of(Sensors(white=LEVELS), COUNT, 0.01, 3)
    expected = np.repeat([1.0, 2.0, 3.0, 4.0, 5.0], 3)
    # Five standard errors of a deviation, and of a correlation.
    np.testing.assert_allclose(errors.std(axis=0), expected, rtol=5 / np.sqrt(2 * COUNT))
    unit = errors / expected
    assert np.abs(np.mean(unit[1:] * unit[:-1], axis=0)).max() < 5 / np.sqrt(COUNT)
    between = unit.T @ unit / COUNT - np.eye(15)
    assert np.abs(between).max() < 5 * np.sqrt(2 / COUNT)


def test_coloured_noise_forgets_with_its_correlation_time():
    noise = gauss_markov(np.random.default_rng(1), COUNT, 50, 0.01, 0.5)
    np.testing.assert_allclose(noise.std(), 1.0, atol=0.03)
    for lag in (10, 50, 100):
        found = np.mean(noise[lag:] * noise[:-lag])
        assert found == pytest.approx(np.exp(-lag * 0.01 / 0.5), abs=0.03)
    # Stationary from the first sample on.
    first = gauss_markov(np.random.default_rng(2), 1000, 5000, 0.01, 0.5)[0]
    assert first.std() == pytest.approx(1.0, rel=5 / np.sqrt(2 * 5000))


def test_white_and_coloured_noise_add():
    both = Sensors(white=Noise(rate=3.0), coloured=Noise(rate=4.0))
    errors = errors_of(both, COUNT, 0.01, 5)
    assert errors[:, 9:12].std() == pytest.approx(5.0, rel=0.05)
    assert not errors[:, :9].any()


def test_what_is_clean_is_the_truth_to_the_last_bit():
    states, forces, rows = shown(CLEAN)
    truth = motion(T)
    np.testing.assert_allclose(states, truth[0], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(forces, truth[1])
    assert rows.all()


def test_noise_of_the_record_is_what_the_sensors_state():
    t = np.arange(3001) / 100
    sensors = Sensors(white=Noise(position=0.01, attitude=0.02, rate=0.03, force=0.1))
    states, forces, _ = shown(sensors, t)
    truth, true_forces = motion(t)
    few = 5 / np.sqrt(2 * 3 * len(t))
    assert (states - truth)[:, :3].std() == pytest.approx(0.01, rel=few)
    assert (states - truth)[:, 10:].std() == pytest.approx(0.03, rel=few)
    assert (forces - true_forces).std() == pytest.approx(0.1, rel=few)
    between = np.swapaxes(rotation_matrix(truth[:, 6:10]), 1, 2) @ rotation_matrix(states[:, 6:10])
    vee = np.stack([between[:, 2, 1], between[:, 0, 2], between[:, 1, 0]], axis=1)
    assert vee.std() == pytest.approx(0.02, rel=few)


@pytest.mark.parametrize('delay, drift', ((0.013, 0.0), (0.02, 1e-3)))
def test_streams_are_late_as_stated(delay, drift):
    t = np.arange(2001) / 100
    states, forces, _ = shown(Sensors(mocap=Stream(delay, drift)), t)
    then = motion(np.maximum(t - delay - drift * t, 0.0))[0]
    np.testing.assert_allclose(states[:, :3], then[:, :3], atol=1e-8)
    np.testing.assert_allclose(states[:, 6:10], then[:, 6:10], atol=1e-7)
    # Velocity lies straight between samples: h^2 / 8 of its second derivative.
    np.testing.assert_allclose(states[:, 3:6], then[:, 3:6], atol=0.01 ** 2 / 8)
    truth = motion(t)
    np.testing.assert_array_equal(states[:, 10:], truth[0][:, 10:])
    states, forces, _ = shown(Sensors(imu=Stream(delay, drift)), t)
    np.testing.assert_allclose(states[:, 10:], then[:, 10:], atol=4 * 0.01 ** 2 / 8)
    np.testing.assert_allclose(states[:, :10], truth[0][:, :10], atol=1e-15)
    assert np.abs(forces - truth[1]).max() > 0.02


def test_a_slower_sensor_repeats_its_sample_with_its_noise():
    sensors = Sensors(white=Noise(position=0.1), mocap=Stream(rate=25.0))
    states, _, _ = shown(sensors, np.arange(1000) / 100)
    blocks = states[:, :10].reshape(250, 4, 10)
    np.testing.assert_array_equal(blocks, np.repeat(blocks[:, :1], 4, axis=1))
    assert (np.diff(blocks[:, 0, 0]) != 0).all()


def test_a_slower_sensor_may_lie_straight_between_its_samples():
    t = np.arange(1001) / 100
    states, _, _ = shown(Sensors(mocap=Stream(rate=25.0, held=False)), t)
    truth = motion(t)[0]
    np.testing.assert_allclose(states[::4], truth[::4], atol=1e-12)
    middle = (truth[:-4:4, 0] + truth[4::4, 0]) / 2
    np.testing.assert_allclose(states[2::4, 0], middle, atol=1e-12)


def test_differentiated_velocity_amplifies_the_noise_of_position():
    sensors = Sensors(white=Noise(position=1e-3), differentiated=True)
    states, _, _ = shown(sensors)
    error = (states[:, 3:6] - motion(T)[0][:, 3:6])[1:-1]
    # Central differences over two samples of 10 ms.
    assert error.std() == pytest.approx(1e-3 / (np.sqrt(2) * 0.01), rel=0.05)


def test_rows_are_lost_and_attitude_jumps_as_often_as_stated():
    sensors = Sensors(lost=0.1, glitches=0.5, glitch_angle=0.3, glitch_time=0.05)
    states, _, rows = shown(sensors)
    assert np.mean(~rows) == pytest.approx(0.1, abs=5 * np.sqrt(0.09 / COUNT))
    assert rows[[0, -1]].all()
    between = np.abs(np.sum(states[:, 6:10] * motion(T)[0][:, 6:10], axis=1))
    jumped = between < np.cos(0.14)
    assert 2 * np.arccos(between[jumped]) == pytest.approx(0.3, abs=1e-6)
    # 200 s with 0.5 a second of 5 samples each: a Poisson number.
    assert jumped.sum() / 5 == pytest.approx(100, abs=50)


def test_a_faulty_record_lacks_what_it_lacks():
    record = fly_closed_loop(PAPER, {}, 'figure8', duration=10.0, noise=FAULTY)
    assert not record.has('vbat') and not record.has('rotor1')
    assert np.diff(record.t).max() > 0.015
    assert (np.diff(record.columns['px']) == 0).any()


def test_rotor_speeds_and_voltage_have_their_noise():
    record = fly_closed_loop(PAPER, {}, 'hover', duration=30.0, noise=MOCAP_IMU)
    few = 5 / np.sqrt(2 * len(record))
    ratio = record.columns['rotor1'] / record.columns['cmd1'] - 1
    assert ratio.std() == pytest.approx(MOCAP_IMU.white.rotor, rel=few)
    line = np.polynomial.Polynomial.fit(record.t, record.columns['vbat'], 1)
    assert (record.columns['vbat'] - line(record.t)).std() == pytest.approx(
        MOCAP_IMU.white.voltage, rel=few)


def test_the_controller_sees_the_noise_that_is_recorded():
    noisy = replace(CLEAN, white=Noise(position=2e-3, velocity=0.02, attitude=5e-3, rate=0.02))
    quiet, shaken = (fly_closed_loop(PAPER, {}, 'hover', duration=5.0, noise=noise)
                     for noise in (CLEAN, noisy))
    assert shaken.columns['cmd1'].std() > 100 * quiet.columns['cmd1'].std()
