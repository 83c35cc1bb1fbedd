# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Records split at resets of the estimator, and jumps seen in the data."""

from flightmaker import changed, flight
import numpy as np
import pytest
from real import NANOBENCH, needs_real_flights

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.split import jumps, split
from quad_ident_ros.model.attitude import product

WHOLE = flight(seconds=20.0)


def moved(record, at, by, until=np.inf, over=0.0):
    """Return a record whose place is moved by metres along x from one time to another."""
    ramp = np.clip((record.t - at) / max(over, 1e-9), 0.0, 1.0)
    return changed(record, px=record.columns['px'] + by * ramp * (record.t < until))


def turned(record, at, by):
    """Return a record whose attitude is turned about the vertical from a time on, rad."""
    angle = np.where(record.t >= at, by, 0.0)
    turn = np.stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)], axis=-1)
    q = product(turn, record.stack('qw', 'qx', 'qy', 'qz'))
    return changed(record, **dict(zip(('qw', 'qx', 'qy', 'qz'), q.T, strict=True)))


def test_pieces_are_cut_between_last_and_first_sample():
    one, other = split(WHOLE, [(7.0, 7.05, 'it was reset')])
    assert one.t[-1] == pytest.approx(7.0) and other.t[0] == pytest.approx(7.05)
    assert 'it was reset at t = 7.00 s' in one.info['notes'][0]
    assert other.info['began'] == WHOLE.t[0] and one.info['name'] == 'made_1'
    np.testing.assert_array_equal(other.columns['px'], WHOLE.columns['px'][705:])


def test_short_pieces_are_left_out_and_told():
    [piece] = split(WHOLE, [(2.0, 2.01, 'a'), (18.0, 18.01, 'b')])
    assert piece.t[0] == pytest.approx(2.01) and piece.t[-1] == pytest.approx(18.0)
    assert 'left out: 2 parts shorter than 4 s' in piece.info['notes'][0]
    assert piece.info['name'] == 'made'
    [longest] = split(WHOLE.slice(0, 600), [(2.0, 2.01, 'a'), (3.0, 3.01, 'b')])
    assert longest.t[0] == pytest.approx(3.01)   # of none that is long enough


def test_without_a_reset_a_record_stays_as_it_is():
    assert split(WHOLE, []) == [WHOLE]
    assert split(WHOLE, [(-5.0, -1.0, 'before'), (30.0, 31.0, 'after')]) == [WHOLE]
    assert jumps(WHOLE) == []


@pytest.mark.parametrize('over', [0.0, 0.1])
def test_a_jump_of_the_position_is_seen(over):
    """At once, or interpolated between the samples of a stream of 10 Hz."""
    [(before, after, why)] = jumps(moved(WHOLE, 9.0, 2.5, over=over))
    assert 8.97 <= before <= 9.02 and 9.0 <= after <= 9.0 + over + 0.02
    assert 'position jumps by 2.5 m' in why
    assert jumps(moved(WHOLE, 9.0, 0.6)) == []


def test_a_jump_of_the_heading_is_seen():
    [(before, after, why)] = jumps(turned(WHOLE, 12.0, np.radians(35.0)))
    assert after - before < 0.03 and 'heading jumps by 3' in why
    assert jumps(turned(WHOLE, 12.0, np.radians(12.0))) == []


POSES = changed(WHOLE, **dict.fromkeys(('vx', 'vy', 'vz', 'wx', 'wy', 'wz')))


def test_poses_alone_jump_where_no_vehicle_is_as_fast():
    """As of a motion capture that takes another body, or whose origin is set in flight."""
    [(before, after, why)] = jumps(moved(POSES, 9.0, 2.5))
    assert 8.97 <= before <= 9.0 <= after <= 9.02 and 'position jumps by 2.5 m' in why
    [(before, after, why)] = jumps(turned(POSES, 12.0, np.radians(35.0)))
    assert after - before < 0.03 and 'heading jumps by 3' in why
    assert jumps(POSES) == []
    assert jumps(moved(POSES, 9.0, 6.0, over=0.2)) == []    # at 30 m/s: it may have flown
    assert jumps(moved(POSES, 8.0, 2.5, until=8.3)) == []   # a glitch, which comes back


@pytest.mark.parametrize('every', [10, 33])
def test_poses_that_are_held_do_not_jump(every):
    fast = changed(POSES, **{name: 8.0 * POSES.columns[name] for name in ('px', 'py', 'pz')})
    rows = np.arange(len(POSES)) // every * every
    assert jumps(changed(fast, **{name: values[rows] for name, values in
                                  fast.columns.items()})) == []
    once = np.where((POSES.t > 8.0) & (POSES.t < 9.0), rows, np.arange(len(POSES)))
    assert jumps(changed(fast, **{name: values[once] for name, values in
                                  fast.columns.items()})) == []


def test_a_jump_of_a_heading_in_angles_is_seen(tmp_path):
    record = turned(WHOLE, 12.0, np.radians(35.0))
    angles = changed(record, **dict.fromkeys(('qw', 'qx', 'qy', 'qz')), **dict(zip(
        ('phi', 'theta', 'psi'), record.euler().T, strict=True)))
    [(before, after, why)] = jumps(angles)
    assert after - before < 0.03 and 'heading jumps by 3' in why
    round_and_round = changed(angles, psi=(angles.columns['psi'] + np.pi) % (2 * np.pi))
    assert len(jumps(round_and_round)) == 1


def test_what_comes_back_is_no_reset():
    assert jumps(moved(WHOLE, 9.0, 3.0, until=9.1)) == []


def test_what_is_only_fast_or_in_other_units_is_no_reset():
    """Faults that have findings of their own do not cut a record to pieces."""
    columns = WHOLE.columns
    for factor, names in ((1000, ('px', 'py', 'pz')), (57.3, ('wx', 'wy', 'wz'))):
        assert jumps(changed(WHOLE, **{name: factor * columns[name] for name in names})) == []
    assert jumps(changed(WHOLE, vx=-30 * columns['vx'])) == []
    held = np.repeat(40 * columns['px'][::10], 10)
    assert jumps(changed(WHOLE, px=held, vx=40 * columns['vx'])) == []
    assert jumps(changed(moved(WHOLE, 9.0, 3.0, over=0.1), vx=None)) == []


def test_a_gap_is_no_jump():
    keep = (WHOLE.t < 8.0) | (WHOLE.t > 11.0)
    cut = changed(WHOLE.slice(0, int(keep.sum())), t=WHOLE.t[keep],
                  **{name: values[keep] for name, values in WHOLE.columns.items()})
    assert jumps(cut) == []


def test_every_reader_splits_where_the_data_jump(tmp_path):
    write_csv(tmp_path / 'f.csv', moved(WHOLE, 8.995, 2.5))
    one, other = load_all(tmp_path / 'f.csv')
    assert one.t[-1] < 9.0 <= other.t[0] and len(one) + len(other) >= len(WHOLE) - 2
    assert str(tmp_path / 'f.csv') in other.info['source']


@pytest.mark.slow
@needs_real_flights
def test_real_flights_have_no_jumps():
    for path in sorted(NANOBENCH.glob('*.csv.gz')):
        assert jumps(load(path)) == []
