# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The estimators return the truth where nothing is wrong, and miss it by what is."""

from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from withheld.actuators import Line

if find_spec('rotorpy') is None:
    pytest.skip('rotorpy is not installed', allow_module_level=True)
estimate, flight, low_pass, rotations, sensors, setups = (
    import_module(f'withheld.estimator.{name}')
    for name in ('estimate', 'flight', 'low_pass', 'rotations', 'sensors', 'setups'))
nominal, paths, plant, vehicles = (
    import_module(f'withheld.{name}') for name in ('nominal', 'paths', 'plant', 'vehicles'))

STEP = 0.01
PARAMS = vehicles.vehicle_of('px4_quadrotor', np.random.default_rng(1), True)
SILENT = sensors.Imu(gyro=0.0, accelerometer=0.0, gyro_bias=0.0, accelerometer_bias=0.0,
                     shaking=(0.0, 0.0))
MOCAP, GPS = setups.SETUPS['development']
ALL = [setup for part in setups.SETUPS.values() for setup in part]


@pytest.fixture(autouse=True)
def begin_soon(monkeypatch):
    monkeypatch.setattr(flight, 'BEFORE', 0.2)


def undisturbed(setup, latency=0.0, assumed=0.0):
    """Return a setup whose sensors say the truth, as late as asked for."""
    parts = ('position', 'velocity', 'attitude', 'heading')
    exact = {name: 1e-7 for name in parts if getattr(setup.aid, name) is not None}
    # The filter must not take what is exact for exact: its gains would be those of no filter.
    make = setup.make_filter
    return replace(setup, imu=SILENT, assumed=assumed, cutoff=240.0, order=1,
                   aid=replace(setup.aid, latency=latency, **exact),
                   make_filter=lambda start, aid: make(start, setup.aid))


def flown(setup, seconds=0.5, effects=None, tilt=(0.0, 0.0, 0.0), bias=(0.0, 0.0, 0.0), seed=1):
    path = paths.Sines(np.random.default_rng(3), size=1.5, acceleration=2.0, low=1.0, turn=0.5)
    declared = {'tilt': np.array(tilt), 'bias': np.array(bias)}
    return flight.fly_on_estimate(
        plant.Reality(PARAMS, effects or {}), PARAMS, path, seconds, STEP, setup,
        np.random.default_rng(seed), declared)


def missed(one):
    return nominal.rms(nominal.errors(one.measured, one.exact))


@pytest.mark.parametrize('setup', [MOCAP, setups.SETUPS['evaluation'][0]])
def test_without_noise_and_latency_the_truth_comes_out(setup):
    errors = missed(flown(undisturbed(setup), effects={'com_offset': {'x': 0.01, 'z': 0.02}}))
    assert errors['position'] < 1e-4
    assert errors['velocity'] < 1e-3
    assert errors['attitude'] < 1e-4
    # A step of the IMU is a mean of 2 ms, and the low pass takes another 1 ms.
    assert errors['rate'] < 0.1


def test_levelling_by_the_accelerometer_errs_in_flight_even_without_noise():
    errors = missed(flown(undisturbed(GPS)))
    assert 1e-3 < errors['attitude'] < 0.03


@pytest.mark.parametrize('setup', ALL)
def test_with_all_that_is_wrong_it_still_flies(setup):
    one = flown(setup)
    errors = missed(one)
    assert one.measured.shape == one.exact.shape == (50, 13)
    assert one.commands.shape == (50, 4)
    assert 1e-4 < errors['position'] < 0.2
    assert 1e-3 < errors['attitude'] < 0.1


def test_a_latency_that_the_filter_does_not_know_costs_accuracy():
    known, unknown = (missed(flown(undisturbed(MOCAP, 0.03, assumed)))['position']
                      for assumed in (0.03, 0.0))
    assert known < 1e-4
    assert unknown > 10.0 * known


@pytest.mark.parametrize('setup', [MOCAP, setups.SETUPS['evaluation'][1]])
def test_the_bias_of_the_gyro_is_told_from_a_turn(setup):
    # A vehicle that stands still, whose gyro says that it turns.
    bias = np.array([0.008, -0.005, 0.003])
    start = estimate.Estimate(np.zeros(3), np.zeros(3), np.eye(3), *np.zeros((2, 3)))
    filtered = setup.make_filter(start, setup.aid)
    pause = round(setup.imu.rate / setup.aid.rate)
    for k in range(round(4.0 * setup.imu.rate)):
        filtered.propagate(bias, np.array([0.0, 0.0, 9.81]), 1.0 / setup.imu.rate)
        if k % pause == 0:
            filtered.correct({'position': np.zeros(3), 'attitude': np.eye(3)},
                             replace(filtered.now))
    assert filtered.now.gyro_bias == pytest.approx(bias, rel=0.3)
    assert filtered.now.rotation == pytest.approx(np.eye(3), abs=2e-3)
    assert filtered.now.velocity == pytest.approx(np.zeros(3), abs=0.01)


def test_a_bias_that_is_logged_is_not_taken_out():
    one = flown(MOCAP, bias=(0.1, 0.0, -0.1))
    assert np.mean((one.measured - one.exact)[:, 10:], axis=0) == pytest.approx(
        np.zeros(3), abs=0.02)
    true = one.exact[:, 10:] - one.states[:, 10:]
    assert true == pytest.approx(np.tile([0.1, 0.0, -0.1], (50, 1)))


def test_a_tilt_is_of_the_attitude_alone_or_of_the_whole_block():
    tilt = (0.03, -0.02, 0.0)
    for setup, of_rates in ((MOCAP, False), (setups.SETUPS['evaluation'][0], True)):
        one = flown(setup, tilt=tilt)
        attitude, shown, seen = (Rotation.from_quat(states[:, 6:10])
                                 for states in (one.states, one.exact, one.measured))
        turned = (attitude.inv() * shown).as_euler('ZYX')[:, ::-1]
        assert turned == pytest.approx(np.tile(tilt, (50, 1)), abs=1e-9)
        assert (shown.inv() * seen).magnitude().max() < 0.03
        assert np.allclose(one.states[:, 10:], one.exact[:, 10:]) != of_rates


def test_control_faster_than_the_log_changes_commands_between_rows():
    class Counting(Line):
        given = 0

        def pass_on(self, time, command, step):
            self.given += 1
            return super().pass_on(time, command, step)

    path = paths.Hover(np.random.default_rng(1), 1.0)
    for control, rows in ((100.0, 1), (500.0, 5)):
        reality = plant.Reality(PARAMS, {}, line=Counting(0.005))
        line = reality.line
        flight.fly_on_estimate(
            reality, PARAMS, path, 0.1, STEP, replace(MOCAP, control=control),
            np.random.default_rng(1), {'tilt': np.zeros(3), 'bias': np.zeros(3)})
        assert line.given == rows * round((0.1 + flight.BEFORE) / STEP)


def test_the_low_pass_halves_the_power_at_its_cutoff():
    rate, cutoff = 500.0, 40.0
    smooth = low_pass.LowPass(cutoff, 2, rate, np.zeros(3))
    t = np.arange(2000) / rate
    out = np.array([smooth(np.full(3, np.sin(2.0 * np.pi * cutoff * x))) for x in t])
    assert np.sqrt(2.0) * out[1000:, 0].std() == pytest.approx(np.sqrt(0.5), rel=0.01)
    still = low_pass.LowPass(cutoff, 2, rate, np.full(3, 0.7))
    assert still(np.full(3, 0.7)) == pytest.approx(np.full(3, 0.7))


def test_rotations_agree_with_scipy():
    for one in Rotation.random(50, rng=np.random.default_rng(2)):
        assert abs(rotations.quaternion_of(one.as_matrix()) @ one.as_quat()) == pytest.approx(1.0)
        vector = 0.5 * one.as_rotvec()
        matrix = rotations.exponential(vector)
        assert matrix == pytest.approx(Rotation.from_rotvec(vector).as_matrix())
        assert rotations.logarithm(matrix) == pytest.approx(vector)


@pytest.mark.parametrize('name', ['position', 'velocity', 'attitude', 'heading'])
def test_what_is_seen_grows_with_the_error_as_its_rows_say(name):
    rng = np.random.default_rng(6)
    rotation = Rotation.from_euler('ZYX', [0.4, 0.2, -0.3]).as_matrix()
    then = estimate.Estimate(rng.normal(size=3), rng.normal(size=3), rotation, *np.zeros((2, 3)))
    error = 1e-5 * rng.normal(size=15)
    true = {'position': then.position + error[:3], 'velocity': then.velocity + error[3:6],
            'attitude': rotation @ rotations.exponential(error[6:9])}
    true['heading'] = rotations.heading_of(true['attitude'])
    change, row = estimate.ROWS[name](true[name], then)
    assert change == pytest.approx(row @ error, abs=1e-9)
