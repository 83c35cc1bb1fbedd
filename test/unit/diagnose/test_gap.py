# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The gap: which predictions count, and what noise alone makes of it."""

import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.gap import ends, gap, Noise, noise_gap
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.greybox.flights import guided, track_of
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
HORIZON = 0.5   # s


@pytest.fixture(scope='module')
def record():
    """Return a flight whose controller answers the noise, so that its commands are not smooth."""
    return fly_closed_loop(VEHICLE, {}, 'lissajous', duration=20.0, rate=50.0, seed=3,
                           noise=MOCAP_IMU)


def without_rows(record, lost):
    return FlightRecord(record.t[~lost], {name: values[~lost] for name, values
                                          in record.columns.items()}, dict(record.info))


def ends_of(record):
    return ends(guided(track_of(record, VEHICLE)), VEHICLE, nominal(VEHICLE), HORIZON)


def test_commands_of_lost_rows_make_no_gap(record):
    lost = np.zeros(len(record), bool)
    for first in range(70, len(record) - 1, 60):
        lost[first:first + 2] = True
    whole, part = ends_of(record), ends_of(without_rows(record, lost))
    assert 0.25 * len(whole.t) <= len(part.t) < len(whole.t)
    for name, value in gap([part]).items():
        assert value == pytest.approx(gap([whole])[name], rel=0.15)


def test_predictions_over_the_fewest_lost_rows_are_left_where_all_are_over_some(record):
    lost = np.arange(len(record)) % 10 == 5
    whole, part = ends_of(record), ends_of(without_rows(record, lost))
    assert 0.25 * len(whole.t) * 0.9 <= len(part.t) < len(whole.t)


def test_rows_that_are_lost_between_those_of_a_thinned_flight_count_too():
    """Commands of a fast log are all kept, though its states are thinned."""
    fast = fly_closed_loop(VEHICLE, {}, 'lissajous', duration=10.0, rate=250.0, seed=3,
                           noise=MOCAP_IMU)
    lost = np.zeros(len(fast), bool)
    lost[501:2000:250] = True       # odd rows, of which thinning keeps none
    whole, part = ends_of(fast), ends_of(without_rows(fast, lost))
    assert len(part.t) < len(whole.t)
    for when in fast.t[lost] - fast.t[0]:
        assert not np.any((part.t <= when) & (when < part.t + HORIZON - 0.01))


def test_forces_and_moments_between_the_samples_walk(record):
    """The closed forms of a random walk and of its integral (Maybeck 1979)."""
    walk = np.array([1e-2, 2e-2, 3e-2, 0.1, 0.2, 0.3])
    none = Noise(np.zeros(12), np.zeros(12), 0.0, 0.0, walk, False)
    found = noise_gap(guided(track_of(record, VEHICLE)), VEHICLE, nominal(VEHICLE), none, HORIZON)
    pushed, turned = walk[:3].sum(), walk[3:].sum()
    assert found['velocity'] == pytest.approx(np.sqrt(pushed * HORIZON))
    assert found['position'] == pytest.approx(np.sqrt(pushed * HORIZON ** 3 / 3))
    assert found['rate'] == pytest.approx(np.sqrt(turned * HORIZON))
    assert found['attitude'] == pytest.approx(np.sqrt(turned * HORIZON ** 3 / 3))
