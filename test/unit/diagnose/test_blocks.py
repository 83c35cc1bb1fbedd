# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A single flight as two: what is held out moves as what is learnt from."""

from dataclasses import replace

from flightmaker import changed
import numpy as np
import pytest

from quad_ident_ros.diagnose.blocks import interleaved, spans_seen
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.gap import ends
from quad_ident_ros.diagnose.result import FlightCheck
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.diagnosis import caution_lines, open_lines
from quad_ident_ros.report.verdict import size_line

VEHICLE = load_vehicle('hummingbird')
DRAG = {'rotor_drag': {'coefficient': 0.2}}


@pytest.fixture(scope='module')
def half_hovered():
    """Return a flight that flies a course and then hovers."""
    course, hover = (fly_closed_loop(VEHICLE, DRAG, name, duration=15.0, seed=3,
                                     noise=SENSORS['mocap_imu']) for name in ('figure8', 'hover'))
    columns = {name: np.concatenate([column, hover.columns[name][1:]])
               for name, column in course.columns.items()}
    t = np.concatenate([course.t, course.t[-1] + hover.t[1:]])
    return replace(changed(course, **{name: columns[name][:len(course)] for name in columns}),
                   t=t, columns=columns)


def test_both_parts_move_alike_and_share_no_row(half_hovered):
    track = track_of(half_hovered, VEHICLE)
    learnt, held_out = interleaved(track, RULES.held_block)
    assert not (learnt.seen & held_out.seen).any()
    np.testing.assert_array_equal(learnt.seen | held_out.seen, track.seen)
    speeds = np.linalg.norm(track.states[:, 3:5], axis=1)
    moved = [np.sum(speeds[part.seen[:, 0]] ** 2) for part in (learnt, held_out)]
    assert 0.6 < moved[0] / moved[1] < 1.0 / 0.6
    assert learnt.name != held_out.name and all(track.name in one.name
                                                for one in (learnt, held_out))


def test_time_between_the_parts_of_a_flight_makes_no_blocks(half_hovered):
    """Five minutes on the ground are five minutes without anything to hold out."""
    later = replace(half_hovered, t=half_hovered.t + 300.0 * (half_hovered.t > 20.0))
    learnt, held_out = interleaved(track_of(later, VEHICLE), RULES.held_block)
    as_one, _ = interleaved(track_of(half_hovered, VEHICLE), RULES.held_block)
    assert learnt.name == as_one.name and 'half of its blocks of 3 s' in learnt.name
    spans = spans_seen(held_out, RULES.held_block)
    assert all(end - begin < 6.5 for begin, end in spans)
    assert any(end < 20.0 for _, end in spans) and any(begin > 300.0 for begin, _ in spans)
    for part in (learnt, held_out):
        inside = np.any([(part.course.t >= begin) & (part.course.t <= end)
                         for begin, end in spans], axis=0)
        assert (inside == part.seen.any(axis=1)).mean() == (part is held_out)
    for rows in (learnt.course.t < 20.0, learnt.course.t > 300.0):
        share = held_out.seen[rows, 0].sum() / rows.sum()
        assert 0.3 < share < 0.7


def test_predictions_of_the_part_held_out_begin_and_end_in_it(half_hovered):
    _, held_out = interleaved(track_of(half_hovered, VEHICLE), RULES.held_block)
    starts = ends(held_out, VEHICLE, nominal(VEHICLE), 0.5).t
    rows = np.searchsorted(held_out.course.t, starts - 1e-9)
    assert held_out.seen[rows].all() and held_out.seen[rows + round(0.5 / held_out.period)].all()
    assert len(flight_of(held_out).first) > 10


@pytest.mark.slow
def test_a_flight_that_hovers_in_the_end_shows_its_drag(half_hovered):
    found = diagnose([half_hovered], VEHICLE)
    assert found.verdict == ('rotor_drag',)
    assert found.gap.closed > 0.8
    data = found.as_data()
    assert 'half of its blocks of 3 s' in data['flights'][0] and 'other' in data['held_out']
    assert 'blocks' in [one['code'] for one in data['findings']]
    lines = open_lines(replace(found, flight_checks=(FlightCheck('f', {'velocity': 3.0}, True),)))
    assert any('differs from the other half of this flight' in line for line in lines)
    assert f'on {found.held_out}, which was not used for fitting' in size_line(found)
    used = {'code': 'kept', 'severity': 'info', 'flight': 'f', 'where': 't = 1 to 9 s',
            'message': 'this part of the recording is used', 'remedy': ''}
    assert caution_lines(replace(found, findings=(used,))) == [
        'f: t = 1 to 9 s: this part of the recording is used']
