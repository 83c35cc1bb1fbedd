# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of readers share: a small record, and checks of what is read and refused."""

from flightmaker import flight
from hypothesis import HealthCheck, settings
import pytest

from quad_ident_ros.data.load import load
from quad_ident_ros.errors import InputError

# How long examples take is the business of whoever else keeps the machine busy.
FAST = settings(deadline=None, max_examples=40,
                suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
SMALL = flight(seconds=1.0, noise=0.0)
CMD = ('cmd1', 'cmd2', 'cmd3', 'cmd4')
ALL_TOPICS = {'topics': {
    'pose': {'topic': '/odom'}, 'velocity': {'topic': '/odom'}, 'rate': {'topic': '/imu'},
    'specific_force': {'topic': '/imu'}, 'commands': {'topic': '/motors'}}}


def same(one, other):
    """Check that two records have the same samples, bit for bit."""
    assert one.t.tobytes() == other.t.tobytes()
    assert set(one.columns) == set(other.columns)
    for name, values in one.columns.items():
        assert values.tobytes() == other.columns[name].tobytes(), name


def refused(path, *parts, mapping=None, vehicle=None):
    """Check that a file is refused in one line that names it and has all of the parts."""
    with pytest.raises(InputError) as caught:
        load(path, mapping, vehicle)
    text = str(caught.value)
    assert len(text.splitlines()) == 1 and str(path) in text and len(text) < 1000
    assert all(part in text for part in parts), text


def log(tmp_path, content):
    """Write the bytes of a PX4 log and return its path."""
    path = tmp_path / 'log.ulg'
    path.write_bytes(content)
    return path
