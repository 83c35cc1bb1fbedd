# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a flight joined by equal stamps, and between their samples where these do not meet."""

import numpy as np
import pytest

from quad_ident_ros.data.flight_joiner import DECIDED, FlightJoiner
from quad_ident_ros.data.joiner import Joiner
from quad_ident_ros.data.topics import FLIGHT_TOPICS, raw_columns

MS = 10 ** 6


def messages(rates, seconds=4.0, offsets=None):
    """Return (topic, stamp, values) in order of time: each value is the time, s, but unit qw."""
    found = []
    for name, rate in rates.items():
        for k in range(round(seconds * rate)):
            stamp = 10 ** 9 + round(k * 10 ** 9 / rate) + (offsets or {}).get(name, 0)
            values = [stamp * 1e-9] * len(FLIGHT_TOPICS[name].columns)
            if name == 'pose':
                values[3:] = [1.0, 0.0, 0.0, 0.0]
            found.append((name, stamp, tuple(values)))
    return sorted(found, key=lambda one: one[1])


def rows_of(joiner, sent):
    rows = []
    for message in sent:
        rows += joiner.add(*message)
    rows += joiner.drain()
    return [row[0] for row in rows], dict(zip(raw_columns(joiner.topics), np.array(
        [row[1] for row in rows]).T, strict=True))


def test_equal_stamps_are_joined_as_they_are_and_losses_counted():
    sent = [one for k, one in enumerate(messages({'pose': 100, 'twist': 100, 'input': 100}))
            if k % 17]
    topics = ('pose', 'twist', 'input')
    joiner, plain = FlightJoiner(topics, 0.1), Joiner(topics)
    stamps, _ = rows_of(joiner, sent)
    assert stamps == rows_of(plain, sent)[0] and not joiner.interpolates
    assert joiner.counts == plain.counts and joiner.counts.dropped > 20


@pytest.mark.parametrize('offsets', [{}, {'twist': 3 * MS, 'input': 1 * MS}])
def test_topics_of_other_rates_are_joined_at_the_stamps_of_the_pose(offsets):
    """Without an offset some stamps are equal: rows come at these until that is decided."""
    joiner = FlightJoiner(('input', 'twist', 'pose'), 0.1)
    stamps, columns = rows_of(joiner, messages({'pose': 100, 'twist': 30, 'input': 45},
                                               offsets=offsets))
    assert joiner.interpolates and joiner.base == 'pose'
    t = np.array(stamps) * 1e-9
    late = t > 1.0 + DECIDED / 100
    np.testing.assert_allclose(np.diff(t[late]), 0.01, atol=1e-9)
    np.testing.assert_allclose(columns['px'], t, atol=1e-9)
    np.testing.assert_allclose(columns['wz'], t, atol=1e-9)
    age = t - columns['u1']     # inputs hold until the next one
    assert age.min() > -1e-9 and age.max() < 1 / 45 + 1e-6
    assert len(t) >= (380 if offsets else 340) and joiner.counts.joined == len(t)
    assert joiner.counts.received == {'pose': 400, 'twist': 120, 'input': 180}


def test_beyond_the_gap_rows_are_dropped_and_counted():
    sent = [one for one in messages({'pose': 100, 'twist': 40}, offsets={'twist': MS})
            if one[0] == 'pose' or not 3 * 10 ** 9 < one[1] < 3.5 * 10 ** 9]
    joiner = FlightJoiner(('pose', 'twist'), 0.1)
    t = np.array(rows_of(joiner, sent)[0]) * 1e-9
    assert not ((t > 3.01) & (t < 3.49)).any() and (t > 3.55).any()
    assert joiner.counts.dropped >= 48


def test_angles_are_interpolated_along_the_shortest_turn():
    joiner, rows = FlightJoiner(('attitude', 'pose'), 0.1), []
    for k in range(200):
        stamp = 10 ** 9 + 10 * k * MS
        psi = np.remainder(0.5 * k + np.pi, 2 * np.pi) - np.pi
        rows += joiner.add('pose', stamp, (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
        rows += joiner.add('attitude', stamp + 5 * MS, (0.0, 0.0, psi))
    psi = np.array([row[1][2] for row in rows[-50:]])
    k = np.rint((np.array([row[0] for row in rows[-50:]]) - 10 ** 9) / (10 * MS))
    np.testing.assert_allclose(np.exp(1j * psi), np.exp(0.5j * (k - 0.5)), atol=1e-9)


def test_what_never_reached_a_joiner_stays_counted():
    joiner = FlightJoiner(('pose', 'twist'), 0.1)
    joiner.counts.lost, joiner.counts.unreadable = 2, 3
    rows_of(joiner, messages({'pose': 100, 'twist': 30}, offsets={'twist': 3 * MS}))
    assert joiner.interpolates
    assert (joiner.counts.lost, joiner.counts.unreadable) == (2, 3)
