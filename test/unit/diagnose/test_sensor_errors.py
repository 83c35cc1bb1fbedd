# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of sensors that go with the motion are errors of what is fitted to it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter, savgol_filter
from scipy.spatial.transform import Rotation

from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.sensor_errors import _patterns
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import Noise, Sensors
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.model.vehicle import load_vehicle

HUMMINGBIRD = load_vehicle('hummingbird')
FILTER = Sensors(white=Noise(position=5e-4, velocity=1e-2, attitude=2e-4, rate=1e-2))
LEVELLED = Sensors(white=Noise(position=2e-2, velocity=2e-2, attitude=2e-4, rate=1e-2))
TRACKED = Sensors(white=Noise(position=5e-4, velocity=1e-2, attitude=2e-3, rate=1e-2))
INERTIA = {'inertia_mismatch': {'factor_x': 1.1, 'factor_y': 1.1}}
RATES, ATTITUDE = ('wx', 'wy', 'wz'), ('qw', 'qx', 'qy', 'qz')


def flights(effects, sensors):
    """Return three flights of a vehicle with effects."""
    return [fly_closed_loop(HUMMINGBIRD, effects, course, duration=12.0, seed=seed, noise=sensors)
            for seed, course in enumerate(('lissajous', 'figure8', 'lissajous'))]


def parameters_of(found, effect):
    """Return the first two parameters of an effect."""
    return list(next(row for row in found.ranking if row.effect == effect).parameters.values())[:2]


def with_columns(record, **columns):
    return replace(record, columns={**record.columns, **columns})


def turned(record, errors):
    """Return a record whose attitude is off by rotations (N, 3) in the world."""
    told = Rotation.from_rotvec(errors) * Rotation.from_quat(
        np.column_stack([record.columns[name] for name in ATTITUDE]), scalar_first=True)
    return with_columns(record, **dict(zip(ATTITUDE, told.as_quat(scalar_first=True).T,
                                           strict=True)))


def followed(pushed, t, gain):
    """Return (N, 3) what a filter has that forgets what pushes it with a gain, 1/s."""
    found = np.zeros(pushed.shape)
    for k, step in enumerate(np.diff(t)):
        found[k + 1] = found[k] + step * (pushed[k] - gain * found[k])
    return found


def by_filter(record, off):
    """Return a record whose gyro reads high by a share, and whose attitude follows it for 2 s."""
    rates = np.column_stack([record.columns[name] for name in RATES])
    to_world = Rotation.from_quat(np.column_stack([record.columns[name] for name in ATTITUDE]),
                                  scalar_first=True)
    return with_columns(turned(record, followed(to_world.apply(off * rates), record.t, 0.5)), **{
        name: (1.0 + off) * record.columns[name] for name in RATES})


def levelled(record):
    """Return a record whose level follows the acceleration, which it takes for gravity."""
    speed = np.column_stack([record.columns[name] for name in ('vx', 'vy')])
    force = savgol_filter(speed, 25, 2, deriv=1, delta=float(np.median(np.diff(record.t))), axis=0)
    lean = followed(np.column_stack([-force[:, 1], force[:, 0], 0.0 * record.t]), record.t, 0.3)
    return turned(record, RULES.levelling * lean / np.sqrt(np.mean(lean[:, :2] ** 2)))


@pytest.mark.slow
def test_inertia_is_known_no_better_than_the_sensitivity_of_a_gyro_that_a_filter_follows():
    """Rates that read high by half of the tolerance look like a vehicle with less inertia."""
    found = diagnose([by_filter(one, 0.5 * RULES.sensitivity) for one in flights(INERTIA, FILTER)],
                     HUMMINGBIRD)
    for value in parameters_of(found, 'inertia_mismatch'):
        assert abs(value.value - 1.1) <= 2.0 * value.std
        assert value.std >= 0.5 * RULES.sensitivity


@pytest.mark.slow
def test_inertia_is_known_as_well_as_the_noise_lets_it_where_the_attitude_follows_no_gyro():
    found = diagnose(flights(INERTIA, TRACKED), HUMMINGBIRD)
    for value in parameters_of(found, 'inertia_mismatch'):
        assert abs(value.value - 1.1) <= 3.0 * value.std
        assert value.std < 0.3 * RULES.sensitivity


def patterns_of(flight):
    """Return the patterns of a flight, as one array."""
    return np.array([pattern for [pattern] in _patterns([flight], 9.81, RULES.levelling, RULES)])


@pytest.mark.parametrize(('column', 'error', 'spike'), [(11, 10, 30.0), (1, 1, 20.0)])
def test_a_sample_that_is_not_seen_has_no_part_in_a_pattern(column, error, spike):
    """A glitch of the rate, or of the position, has no weight: its neighbours have."""
    [record, *_] = flights({}, TRACKED)
    flight = flight_of(track_of(record, HUMMINGBIRD))
    place = int(flight.first[5] + flight.count)
    states, seen = flight.states.copy(), flight.seen.copy()
    states[place, column] += spike
    seen[place, error] = False
    right, wrong = patterns_of(flight), patterns_of(replace(flight, states=states, seen=seen))
    scale = np.sqrt(np.mean(right ** 2, axis=(1, 2), keepdims=True))
    assert np.max(np.abs(wrong - right) / np.maximum(scale, 1e-12)) < 1.0
    seen[:] = True
    glitch = patterns_of(replace(flight, states=states, seen=seen))
    assert np.max(np.abs(glitch - right) / np.maximum(scale, 1e-12)) > 10.0


def test_the_level_of_a_vehicle_that_stands_still_has_no_pattern():
    record = fly_closed_loop(HUMMINGBIRD, {}, 'hover', duration=5.0, seed=0)
    flight = flight_of(track_of(record, HUMMINGBIRD))
    still = np.zeros(flight.states.shape)
    still[:, 6] = 1.0
    assert len(list(_patterns([replace(flight, states=still)], 9.81, RULES.levelling, RULES))) == 2


@pytest.mark.slow
def test_a_level_that_follows_the_acceleration_is_no_effect():
    """A filter takes some of each acceleration for gravity: its level leans with it."""
    records = [levelled(one) for one in flights({}, LEVELLED)]
    assert diagnose(records, HUMMINGBIRD).verdict == ('none',)


@pytest.mark.slow
def test_a_flight_whose_filter_wanders_more_than_that_of_the_others_is_not_unknown():
    """Its position says that its velocity is wrong: no force needs to be looked for."""
    records = flights({}, TRACKED)
    wanders, random = records[1], np.random.default_rng(5)
    keep = np.exp(-np.median(np.diff(wanders.t)) / 0.3)
    records[1] = with_columns(wanders, **{
        name: wanders.columns[name] + 0.1 * lfilter([np.sqrt(1.0 - keep ** 2)], [1.0, -keep],
                                                    random.normal(size=len(wanders.t)))
        for name in ('vx', 'vy', 'vz')})
    found = diagnose(records, HUMMINGBIRD)
    assert found.verdict == ('none',)
    assert found.flight_checks[1].gap_over_noise['velocity'] == pytest.approx(1.0, abs=0.2)
