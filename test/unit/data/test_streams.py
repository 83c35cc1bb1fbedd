# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams of different rates joined on one time base, and their frames."""

from flightmaker import ned
import numpy as np
import pytest

from quad_ident_ros.data.frames import attitude
from quad_ident_ros.data.streams import HELD, join, slerp, SLOW, Stream
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import rotate


def stream(t, between='interpolated', **columns):
    return Stream('s', np.round(np.asarray(t) * 1e9).astype(np.int64), columns, between)


def test_commands_are_held_and_states_interpolated():
    start, t, columns, notes = join('f', [
        stream([0.0, 1.0, 2.0], a=np.array([0.0, 10.0, 30.0])),
        stream([0.5, 1.5, 1.75], HELD, b=np.array([1.0, 2.0, 3.0])),
        stream([0.6, 1.6], SLOW, c=np.array([5.0, 6.0]))])
    assert start == 500_000_000 and notes == ()
    np.testing.assert_allclose(t, [0.0, 1.0, 1.25])
    np.testing.assert_allclose(columns['a'], [5, 20, 25])
    np.testing.assert_array_equal(columns['b'], [1, 2, 3])
    np.testing.assert_array_equal(columns['c'], [5, 5, 6])


def test_a_silence_is_not_bridged():
    t = np.arange(100) * 0.01
    silent = np.delete(t, np.arange(40, 60))
    _, at, _, notes = join('f', [stream(silent, a=silent), stream(t, HELD, b=t)])
    np.testing.assert_allclose(at, silent, atol=1e-12)
    assert '20 of 100 samples' in notes[0]


def test_samples_that_cannot_be_are_left_out_and_counted():
    t = [0.0, 0.1, 0.1, 0.3, 0.2, 0.4]
    values = np.array([0.0, 1.0, 7.0, 3.0, 2.0, np.nan])
    _, at, columns, notes = join('f', [stream(t, a=values)])
    np.testing.assert_allclose(at, [0.0, 0.1, 0.2, 0.3])
    np.testing.assert_allclose(columns['a'], [0, 1, 2, 3])
    assert [note.split(': ')[1] for note in notes] == [
        '1 sample without a finite value', '1 sample out of order',
        '1 sample with the stamp of another']


@pytest.mark.parametrize('voltage', [0.0, -1.0, np.nan])
def test_a_battery_that_is_not_measured_is_left_out(voltage):
    """Autopilots without a sensor log 0 V, or -1."""
    t = np.arange(10) * 0.1
    _, _, columns, notes = join('f', [stream(t, HELD, b=t),
                                      stream(t, SLOW, vbat=np.full(10, voltage))])
    assert list(columns) == ['b'] and 'voltage is not above zero' in notes[0]


def test_streams_that_share_no_time_are_refused():
    with pytest.raises(InputError, match='share no time'):
        join('f', [stream([0.0, 1.0], a=np.zeros(2)), stream([2.0, 3.0], HELD, b=np.zeros(2))])
    with pytest.raises(InputError, match='at least 2'):
        join('f', [stream([0.0], a=np.zeros(1))])


def test_attitudes_turn_at_a_constant_rate():
    angle = np.array([0.0, 2.0])
    q = np.stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)], axis=-1)
    at = np.linspace(0, 1, 11)
    turned = slerp(np.array([0.0, 1.0]), q, at)
    np.testing.assert_allclose(2 * np.arctan2(turned[:, 3], turned[:, 0]), 2.0 * at, atol=1e-12)
    jumping = stream([0.0, 1.0], qw=np.array([1.0, -np.cos(0.1)]), qx=np.zeros(2),
                     qy=np.zeros(2), qz=np.array([0.0, -np.sin(0.1)]))
    _, _, columns, _ = join('f', [stream([0.5, 0.75], HELD, a=np.zeros(2)), jumping])
    np.testing.assert_allclose(columns['qz'], np.sin([0.05, 0.075]), atol=1e-12)


def test_frames_agree_with_their_definition():
    random = np.random.default_rng(0)
    q = random.normal(size=4)
    q /= np.linalg.norm(q)
    v = random.normal(size=3)
    in_ned = rotate(q, v * [1, -1, -1])
    np.testing.assert_allclose(rotate(attitude(q, 'NED', 'FRD'), v), ned(in_ned[None])[0],
                               atol=1e-12)
