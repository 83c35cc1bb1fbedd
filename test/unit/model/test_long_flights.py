# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rollouts of a long flight: what they need of it is enough, and memory comes back."""

import subprocess
import sys

from flightmaker import flight, VEHICLE
import numpy as np
import pytest

from quad_ident_ros.effects import registry
from quad_ident_ros.memory import LIBRARY
from quad_ident_ros.model import dynamics
from quad_ident_ros.model.dynamics import course_of, predict, rows_needed, states_of


@pytest.mark.parametrize('effects', [
    {}, {('motor_lag', 'time_constant'): 0.08}, {('motor_lag', 'rise'): 0.05},
    {('actuation_delay', 'delay'): 0.013, ('motor_lag', 'time_constant'): 0.03},
    {('motor_lag', 'mean_lag'): 0.05}, {('motor_lag', 'slew'): 1e-4},
    {('rotor_gyro', 'rotor_inertia'): 1e-5}], ids=str)
@pytest.mark.parametrize('guided', [False, True])
@pytest.mark.parametrize('rate', [100.0, 40.0])
def test_a_part_of_a_flight_is_predicted_as_in_the_whole(monkeypatch, effects, guided, rate):
    record = flight(seconds=30.0, rate=rate)
    course, states = course_of(record, VEHICLE), states_of(record)
    thetas = np.array([registry.NULL, registry.NULL], float)
    for place, value in effects.items():
        thetas[1, registry.PLACE[place]] = value
    first = np.array([900, 420, 700, 424]) * int(rate) // 100
    which = np.array([0, 1, 1, 1])
    guide = states if guided else None

    def predicted():
        return predict(VEHICLE, thetas, course, states[first], first, 20, which, guide=guide)

    assert len(rows_needed(len(course.t), first, 20)) < 100
    part = predicted()
    monkeypatch.setattr(dynamics, 'rows_needed', lambda length, *_: np.arange(length))
    assert part == pytest.approx(predicted(), rel=1e-9, abs=1e-9)


def test_rollouts_over_most_of_a_flight_need_all_of_it():
    assert len(rows_needed(1000, np.arange(100, 900, 50), 49)) == 1000
    assert rows_needed(1000, [500, 300, 500], 2).tolist() == [
        0, 299, 300, 301, 302, 499, 500, 501, 502]
    assert rows_needed(1000, [0, 3], 2).tolist() == [0, 1, 2, 3, 4, 5]


# In a process that has just begun: what others freed in this one may hold an array, too.
LARGE_ARRAYS = """
import ctypes
import numpy as np
from quad_ident_ros.memory import hand_back_large, LIBRARY

NAMES = ('arena', 'ordblks', 'smblks', 'hblks', 'hblkhd', 'usmblks', 'fsmblks', 'uordblks',
         'fordblks', 'keepcost')
Info = type('Info', (ctypes.Structure,), {'_fields_': [(name, ctypes.c_size_t) for name in NAMES]})
LIBRARY.mallinfo2.restype = Info
hand_back_large()
before = LIBRARY.mallinfo2().hblkhd
np.ones(30 * 2 ** 17)
kept = np.ones(16 * 2 ** 17)
print(LIBRARY.mallinfo2().hblkhd - before, kept.nbytes)
"""


@pytest.mark.skipif(not hasattr(LIBRARY, 'mallinfo2'), reason='the C library counts no memory')
def test_large_arrays_go_back_to_the_system():
    """Beside one of 30 MB that was freed before, an array of 16 MB is still mapped apart."""
    printed = subprocess.run([sys.executable, '-c', LARGE_ARRAYS], capture_output=True, text=True,
                             check=True, timeout=120).stdout
    mapped, size = map(int, printed.split())
    assert mapped >= size
