# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Velocity and rate of records that have position and attitude alone."""

from dataclasses import replace

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest

from quad_ident_ros.data.differentiated import DIFFERENTIATED, missing_motion, with_motion
from quad_ident_ros.data.quality import cautions, findings
from quad_ident_ros.diagnose.diagnosis import diagnose

V, W = ('vx', 'vy', 'vz'), ('wx', 'wy', 'wz')
NONE = dict.fromkeys((*V, *W, 'ax', 'ay', 'az'))


@pytest.mark.parametrize('rate', [50.0, 100.0, 400.0])
def test_slopes_are_those_of_the_flight(rate):
    """The flight has tones up to 0.6 Hz, of which a cubic over 0.1 s keeps nearly all."""
    record = flight(seconds=6.0, rate=rate, noise=0.0)
    made = with_motion(changed(record, **NONE))
    assert made.info[DIFFERENTIATED] == ('velocity', 'rate')
    np.testing.assert_allclose(made.stack(*V), record.stack(*V), atol=3e-3)
    np.testing.assert_allclose(made.stack(*W)[1:-1], record.stack(*W)[1:-1], atol=1e-2)


def test_slopes_do_not_reach_across_a_gap():
    record = flight(seconds=6.0, noise=0.0)
    use = (record.t < 2.0) | (record.t > 3.0)
    cut = changed(record, t=record.t[use], **{name: values[use] for name, values in
                                              record.columns.items()})
    made = with_motion(changed(cut, **NONE))
    np.testing.assert_allclose(made.stack(*V), cut.stack(*V), atol=1e-2)


def test_what_was_recorded_stays():
    record = flight(seconds=4.0)
    assert with_motion(record) is record and not missing_motion(record)
    made = with_motion(changed(record, **dict.fromkeys(V)))
    assert made.info[DIFFERENTIATED] == ('velocity',)
    np.testing.assert_array_equal(made.stack(*W), record.stack(*W))


def test_it_is_said_before_and_after():
    record = changed(flight(seconds=6.0), **NONE)
    for one in (record, with_motion(record)):
        said = [found for found in findings(one) if found.code == 'differentiated']
        assert [found.where for found in said] == ['vx, vy, vz', 'wx, wy, wz']
    told = [one['code'] for one in cautions(with_motion(record), VEHICLE)]
    assert told.count('differentiated') == 2


@pytest.mark.slow
def test_motion_capture_and_commands_are_enough_for_a_verdict():
    record = changed(flight(seconds=20.0), **NONE)
    assert diagnose([record], VEHICLE).verdict == ('none',)
    assert diagnose([record], replace(VEHICLE, mass=0.6)).verdict[0] == 'mass_offset'
