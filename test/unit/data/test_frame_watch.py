# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wrong frames, reported while a vehicle flies."""

from dataclasses import replace
from pathlib import Path
import subprocess
import sys

import numpy as np
import pytest

from quad_ident_ros.data.frame_watch import FrameWatch
from quad_ident_ros.data.topics import raw_columns
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.attitude import conjugate, rotate

COLUMNS = raw_columns(('pose', 'twist'))
FLIGHTS = load_experiment('closed_loop')

ROOT = Path(__file__).resolve().parents[3]
FIRST_LOOK = f"""
import sys
sys.path.insert(0, {str(ROOT)!r})
import numpy as np
from quad_ident_ros.data.frame_watch import FrameWatch
from quad_ident_ros.data.topics import raw_columns

t = np.arange(0.0, 8.0, 0.01)
zero, turn = 0.0 * t, 0.8 * t
table = np.stack([np.cos(t), np.sin(t), zero, np.cos(turn / 2), zero, zero, np.sin(turn / 2),
                  -np.sin(t), np.cos(t), zero, zero, zero, zero + 0.8], axis=1)
rows = [(round(1e9 * when), tuple(row)) for when, row in zip(t, table, strict=True)]
watch = FrameWatch()
before = {{*sys.modules}}
watch.add(rows)
assert watch.look(raw_columns(('pose', 'twist')))    # a twist in the world
print(*({{*sys.modules}} - before))
"""


def rows_of(record, in_world=False, first=10 ** 9):
    """Return the rows that a recorder joins of a flight, whose twist is in body axes or not."""
    q, v = record.stack('qw', 'qx', 'qy', 'qz'), record.stack('vx', 'vy', 'vz')
    table = np.hstack([record.stack('px', 'py', 'pz'), q,
                       v if in_world else rotate(conjugate(q), v), record.stack('wx', 'wy', 'wz')])
    return [(first + round(1e9 * t), tuple(row)) for t, row in zip(record.t, table, strict=True)]


def told(rows, every=100):
    """Return what is said after each so many rows."""
    watch, said = FrameWatch(), []
    for k in range(0, len(rows), every):
        watch.add(rows[k:k + every])
        said.append(watch.look(COLUMNS))
    return said


@pytest.mark.parametrize('number', range(4))
def test_a_twist_in_the_world_is_told_within_six_seconds(number):
    rows = rows_of(fly(FLIGHTS, FLIGHTS.runs[number]).record, in_world=True)
    said = told(rows)
    assert not any(said[:4]) and all('vx, vy, vz' in one for one in said[6:])
    assert all('say frame: world' in one for one in said[6:])


@pytest.mark.slow
@pytest.mark.parametrize('rate', [50.0, 100.0, 500.0])
@pytest.mark.parametrize('number', range(4))
def test_a_good_flight_is_not_doubted(number, rate):
    experiment = replace(FLIGHTS, period=1.0 / rate)
    rows = rows_of(fly(experiment, experiment.runs[number]).record)
    assert not any(told(rows, int(rate)))


def test_a_hover_is_not_doubted():
    experiment = load_experiment('hover_single_axis')
    for run in experiment.runs:
        record = fly(experiment, run, noise={'position': 1e-3, 'velocity': 1e-3}).record
        assert not any(told(rows_of(record)))


def test_it_is_over_once_the_flight_is_right_or_the_clock_begins_anew():
    record = fly(FLIGHTS, FLIGHTS.runs[0]).record
    watch = FrameWatch()
    watch.add(rows_of(record, in_world=True))
    assert watch.look(COLUMNS)
    assert watch.look(COLUMNS) == ''    # nothing came since
    watch.add(rows_of(record, first=0))
    assert watch.look(COLUMNS) == ''


@pytest.mark.slow
def test_the_first_look_loads_nothing_while_messages_wait():
    done = subprocess.run([sys.executable, '-c', FIRST_LOOK], capture_output=True, text=True,
                          check=True)
    assert done.stdout.split() == []
