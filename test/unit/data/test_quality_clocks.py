# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Clocks of the streams of a record: offsets and drifts are found, and none is made up."""

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest
from quality_records import A, CMD, codes, named, P, Q, V, W
from real import needs_real_flights, real_flight

from quad_ident_ros.data.quality import clock_offset, command_offset, findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle


def late(record, names, offset, drift=0.0):
    """Return the record with columns stamped late: by offset (s) in the middle and drift."""
    t = record.t
    at = t - offset - drift * (t - t.mean())
    inside = (at > t[0]) & (at < t[-1])
    shifted = {name: np.interp(at, t, record.columns[name]) for name in names}
    moved = changed(record, **shifted)
    return FlightRecord(t[inside], {name: values[inside] for name, values in
                                    moved.columns.items()}, record.info)


@pytest.mark.parametrize('offset', [-0.2, -0.033, -0.0045, 0.0045, 0.0173, 0.12])
def test_an_offset_is_estimated_to_a_fraction_of_a_sample(offset):
    record = late(flight(seconds=30.0), (*P, *V, *Q), offset)
    clock = clock_offset(record)
    assert abs(clock.offset - offset) < 4 * clock.std < 0.004
    [finding] = [f for f in findings(record, VEHICLE) if f.code == 'clock_offset']
    assert ('later' in finding.message) == (offset > 0)
    assert finding.severity == ('error' if abs(offset) > 0.1 else 'warning')


@pytest.mark.slow
def test_a_drift_is_estimated_with_its_uncertainty():
    record = late(flight(seconds=60.0), (*P, *V, *Q), 0.02, 0.001)
    clock = clock_offset(record)
    assert abs(clock.drift - 0.001) < 4 * clock.drift_std < 2e-4
    assert abs(clock.offset - 0.02) < 4 * clock.std
    assert 'clock_drift' in codes(record)
    truth = 0.02 + 0.001 * (clock.t - record.t.mean())
    assert np.abs((clock.offsets - truth) / clock.stds).max() < 5


@pytest.mark.slow
def test_standard_errors_of_the_offset_are_honest():
    """Over 60 draws of the noise the errors scatter as the standard errors say."""
    pulls = []
    for seed in range(60):
        clock = clock_offset(flight(seconds=16.0, seed=100 + seed))
        pulls.append(clock.offset / clock.std)
    assert 0.6 < np.std(pulls) < 1.5 and abs(np.mean(pulls)) < 0.5


@pytest.mark.slow
@pytest.mark.parametrize('trajectory', ['figure8', 'lissajous', 'circle'])
def test_standard_errors_know_that_an_autopilot_follows_errors_of_the_attitude(trajectory):
    """Coloured errors of the attitude move the vehicle, and so hang together with its gyro."""
    pulls = []
    for seed in range(5):
        record = fly_closed_loop(load_vehicle('crazyflie'), {}, trajectory, duration=20.0,
                                 seed=seed, noise=MOCAP_IMU)
        clock = clock_offset(record)
        pulls.append(clock.offset / clock.std)
        assert 'clock_offset' not in codes(record)
    assert np.sqrt(np.mean(np.square(pulls))) < 1.5


@pytest.mark.slow
def test_a_wandering_offset_is_found():
    record = flight(seconds=60.0)
    at = record.t - 0.02 * np.sin(2 * np.pi * record.t / 30)
    names = (*P, *V, *Q)
    wander = changed(record, **{n: np.interp(at, record.t, record.columns[n]) for n in names})
    assert 'clock_wander' in codes(wander)


def test_commands_that_act_before_they_are_given_are_found():
    record = late(flight(), CMD, 0.05)
    clock = command_offset(record)
    assert abs(clock.offset + 0.05) < 4 * clock.std
    assert 'command_offset' in codes(record)


@pytest.mark.slow
@pytest.mark.parametrize('effects', [
    {'rotor_drag': {'x': 0.3, 'y': 0.3, 'z': 0.3}},
    {'body_drag': {'horizontal': 0.1, 'vertical': 0.1}},
    {'inflow': {'axial': 0.3, 'translational': 0.03}}], ids=lambda effects: [*effects][0])
@pytest.mark.parametrize('trajectory', ['lissajous', 'figure8'])
def test_a_force_of_the_air_along_z_is_no_early_thrust(trajectory, effects):
    """It follows the velocity, a quarter of a period after the thrust of a smooth path."""
    record = fly_closed_loop(load_vehicle('hummingbird'), effects, trajectory, duration=20.0,
                             seed=1, noise=MOCAP_IMU)
    clock = command_offset(record)
    assert 'command_offset' not in codes(record)
    assert clock is None or abs(clock.offset) < 4 * clock.std


@pytest.mark.slow
def test_the_lag_of_motors_is_no_fault():
    record = late(flight(), (*P, *V, *Q, *W, *A), 0.04)
    assert abs(command_offset(record).offset - 0.04) < 0.008
    assert 'command_offset' not in codes(record)


@pytest.mark.slow
def test_a_thrust_later_than_motors_take_is_found():
    assert 'command_offset' in codes(late(flight(), (*P, *V, *Q, *W, *A), 0.25))


@pytest.mark.slow
@needs_real_flights
@pytest.mark.parametrize('name', ['star_fast', 'oval_fast'])
def test_an_offset_put_into_a_real_flight_is_found(name):
    record = real_flight(name)
    moved = late(record, (*P, *V, *Q), 0.06)
    before, after = clock_offset(record), clock_offset(moved)
    assert 'clock_offset' in codes(moved)
    assert abs(after.offset - before.offset - 0.06) < 2 * before.std
    assert abs(before.offset) < 3 * before.std + 0.01


def test_no_offset_is_made_up():
    rest = flight()
    assert clock_offset(changed(rest, wx=None)) is None
    random = np.random.default_rng(0)
    assert clock_offset(changed(rest, **named(W, random.normal(size=(len(rest), 3))))) is None
