# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Records of more samples than the checks look at: they look at some, from begin to end."""

from flightmaker import changed, flight
import numpy as np
import pytest
from quality_records import codes, Q

from quad_ident_ros.data.quality import clock_offset, series
from quad_ident_ros.data.record import FlightRecord


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(series, 'MOST', 2000)


@pytest.mark.slow
@pytest.mark.parametrize('seconds', [15.0, 30.0, 60.0])
def test_the_whole_record_is_looked_at(seconds):
    record = flight(seconds=seconds, rate=250.0)
    grid = series.Grid.of(record)
    assert grid.t[0] == record.t[0] and record.t[-1] - grid.t[-1] < grid.period
    assert len(grid.t) <= max(2000, seconds / series.COARSEST + 1)
    assert grid.good.mean() > 0.9
    assert codes(record) == set()


def test_what_begins_late_in_a_long_record_is_seen():
    record = flight(seconds=60.0)
    late = np.where(record.t > 40.0, 0.03, 0.0)
    clock = clock_offset(changed(record, **{
        name: np.interp(record.t - late, record.t, record.columns[name]) for name in Q}))
    after, before = clock.offsets[clock.t > 44.0], clock.offsets[clock.t < 36.0]
    assert len(after) >= 3 and np.abs(after - 0.03).max() < 0.01
    assert np.abs(before).max() < 0.01


def test_one_bad_stamp_makes_no_grid_without_end():
    record = flight(seconds=20.0)
    t = np.append(record.t[:-1], 1e9)
    assert len(series.Grid.of(FlightRecord(t, record.columns, record.info)).t) <= 2000
