# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification from window to window: warm starts, and changes of the vehicle."""

from functools import cache

import numpy as np
from payload import climb, GRAVITY, MASS, PAYLOAD, PICKED_UP, START_NS
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.online import Tracker

pytestmark = pytest.mark.slow
WINDOW, STRIDE = 500, 5     # 20 windows a second
SETTINGS = Settings(methods=('vp',), initial_state='free')


def windows(flight):
    """Return the sliding windows of a flight as the recorder publishes them, and their ends."""
    for end in range(WINDOW, len(flight), STRIDE):
        yield flight.starting(end - WINDOW).slice(0, WINDOW), flight.t[end - 1]


@cache
def tracked(payload, noise=0.005, seed=0, dropped=np.inf):
    """Return (end of window, Identification) of all windows of a flight."""
    tracker = Tracker()
    return [(end, tracker.update([window], SETTINGS))
            for window, end in windows(climb(payload, noise, seed, dropped=dropped))]


@pytest.mark.parametrize('seed', range(5))
def test_a_payload_picked_up_in_flight_is_found_within_2_s(seed):
    results = tracked(PAYLOAD, seed=seed)
    assert not [end for end, result in results if result.changes and end < PICKED_UP]
    end, result = next((end, result) for end, result in results if result.changes)
    assert end - PICKED_UP < 2.0
    [change] = result.changes
    assert change.output == 'z' and change.moved
    when = (change.stamp_ns - START_NS) * 1e-9
    assert abs(when - PICKED_UP) < 1.0


@pytest.mark.parametrize('seed', range(5))
def test_after_the_change_the_parameters_are_those_of_the_vehicle_as_it_is(seed):
    results = tracked(PAYLOAD, seed=seed)
    before = [result.methods['vp'].outputs['z'] for end, result in results if end < PICKED_UP]
    for fit in before[:: 20]:
        assert fit.model.gain == pytest.approx(1 / MASS, rel=0.1)
    _, last = results[-1]
    fit = last.methods['vp'].outputs['z']
    assert fit.model.gain == pytest.approx(1 / (MASS + PAYLOAD), rel=0.05)
    # The payload's weight is what the trim does not carry.
    assert fit.disturbance == pytest.approx(
        MASS * GRAVITY / (MASS + PAYLOAD) - GRAVITY, rel=0.2)


@pytest.mark.parametrize('seed', range(5))
def test_a_payload_dropped_soon_after_is_found_within_2_s_too(seed):
    """What is usual was learnt before the first change: it need not be learnt again."""
    dropped = PICKED_UP + 3.0
    found = [end for end, result in tracked(PAYLOAD, seed=seed, dropped=dropped)
             if result.changes]
    assert len(found) == 2
    assert 0 < found[0] - PICKED_UP < 2.0 and 0 < found[1] - dropped < 2.0


def test_the_errors_after_a_change_hold():
    """Of four seconds of results less than 2 % are off by more than four standard errors."""
    off = []
    for payload in (PAYLOAD, 1.0):
        for seed in range(5):
            results = tracked(payload, seed=seed)
            found = next(end for end, result in results if result.changes)
            for end, result in results:
                if found <= end < found + 4.0:
                    fit = result.methods['vp'].outputs['z']
                    error = fit.standard_errors['K']
                    # Without an error nothing is claimed.
                    off.append(error is not None
                               and abs(fit.model.gain - 1 / (MASS + payload)) > 4 * error)
    assert len(off) > 700 and np.mean(off) < 0.02


@pytest.mark.parametrize('noise', [0.001, 0.01])
@pytest.mark.parametrize('seed', range(3))
def test_a_vehicle_that_stays_as_it_is_shows_no_change(noise, seed):
    assert not [end for end, result in tracked(0.0, noise, seed) if result.changes]


def test_windows_are_fitted_as_well_as_from_scratch():
    worse = 0
    flight = climb(0.0)
    tracker = Tracker()
    for number, (window, _) in enumerate(windows(flight)):
        warm = tracker.update([window], SETTINGS).methods['vp'].outputs['z']
        if number % 10 == 0:
            cold = identify([window], SETTINGS).methods['vp'].outputs['z']
            worse += warm.cost > cold.cost * 1.001
    assert worse == 0


def test_other_methods_are_tracked_too():
    flight = climb(PAYLOAD)
    tracker = Tracker()
    settings = Settings(methods=('ls',), initial_state='free')
    found = [result for window, end in windows(flight) if end > 6.5
             for result in [tracker.update([window], settings)] if result.changes]
    assert found and all(list(result.methods) == ['ls'] for result in found)


def test_a_window_that_does_not_say_when_it_begins_is_taken_whole():
    flight = climb(PAYLOAD)
    [window] = [window for window, end in windows(flight) if end == pytest.approx(14.04)]
    info = {key: value for key, value in window.info.items() if key != 'start_ns'}
    result = Tracker().update([FlightRecord(window.t, window.columns, info)], SETTINGS)
    assert result.changes == () and len(result.signals['z'].y) == WINDOW
