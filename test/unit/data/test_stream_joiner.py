# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Live streams of different rates joined at the stamps of the first."""

import random

from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from reader_checks import FAST

from quad_ident_ros.data.joiner import RESTART_NS
from quad_ident_ros.data.stream_joiner import StreamJoiner
from quad_ident_ros.data.streams import HELD, INTERPOLATED, join, SLOW, Stream

MS = 10 ** 6
STREAMS = {'pose': INTERPOLATED, 'rate': INTERPOLATED, 'commands': HELD, 'battery': SLOW}


def samples(count=60):
    """Return (stream, stamp, values) of four streams, each at a rate and an offset."""
    found = []
    for name, period, offset, columns in (
            ('pose', 10, 0, ('px', 'qw', 'qx', 'qy', 'qz')), ('rate', 4, 1, ('wx',)),
            ('commands', 7, 2, ('cmd1',)), ('battery', 200, 3, ('vbat',))):
        for k in range(count * 10 // period):
            stamp = 1000 * MS + (period * k + offset) * MS
            t = stamp * 1e-9
            values = ((np.sin(t), np.cos(t), np.sin(t), 0.0, 0.0) if name == 'pose' else
                      (np.cos(3 * t),))
            found.append((name, stamp, dict(zip(columns, map(float, values), strict=True))))
    return found


def rows_of(joiner, messages):
    rows = []
    for message in messages:
        rows += joiner.add(*message)
    return rows + joiner.drain()


def test_values_between_which_no_number_is_are_counted_and_not_joined():
    joiner = StreamJoiner({'pose': INTERPOLATED, 'rate': INTERPOLATED}, 0.1)
    rows = []
    for k in range(100):
        rows += joiner.add('pose', 10 * k * MS, {'px': 0.0})
        huge = 1.7e308 * (-1) ** k
        rows += joiner.add('rate', (10 * k + 5) * MS, {'wx': huge if k in (50, 51) else 1.0})
    assert np.isfinite([row[1] for row in rows + joiner.drain()]).all()
    assert joiner.counts.nan == 2


def test_rows_are_those_of_a_bag_with_the_same_streams():
    """Interpolated and held as data.streams.join does it, at the stamps of the pose."""
    messages = samples()
    rows = rows_of(StreamJoiner(STREAMS, 0.05), sorted(messages, key=lambda one: one[1]))
    streams = [Stream(name, np.array([m[1] for m in messages if m[0] == name]),
                      {column: np.array([m[2][column] for m in messages if m[0] == name])
                       for column in next(m[2] for m in messages if m[0] == name)},
                      between if between == SLOW else INTERPOLATED)
               for name, between in STREAMS.items() if name != 'commands']
    start, t, columns, _ = join('f', streams)
    stamps = np.array([row[0] for row in rows])
    both, here, there = np.intersect1d(stamps, start + np.rint(t * 1e9).astype(int),
                                       return_indices=True)
    assert len(both) > 50
    table = np.array([row[1] for row in rows])
    names = ('px', 'qw', 'qx', 'qy', 'qz', 'wx')
    np.testing.assert_allclose(table[here][:, :6],
                               np.stack([columns[name][there] for name in names], axis=1),
                               atol=1e-12)
    commands = {m[1]: m[2]['cmd1'] for m in messages if m[0] == 'commands'}
    for stamp, values in rows:
        assert values[6] == commands[max(one for one in commands if one <= stamp)]


@FAST
@given(st.integers(0, 10 ** 6))
def test_rows_do_not_depend_on_how_streams_wait_for_one_another(seed):
    messages = samples(30)
    expected = rows_of(StreamJoiner(STREAMS, 0.05), sorted(messages, key=lambda one: one[1]))
    queues = {name: [m for m in messages if m[0] == name] for name in STREAMS}
    chance, shuffled = random.Random(seed), []
    while any(queues.values()):
        name = chance.choice([name for name, queue in queues.items() if queue])
        run = chance.randrange(1, 40)
        shuffled += queues[name][:run]
        queues[name] = queues[name][run:]
    got = rows_of(StreamJoiner(STREAMS, 0.05), shuffled)
    assert [row[0] for row in got] == [row[0] for row in expected]
    # A battery holds what came last, so that it alone depends on the order.
    assert [row[1][:-1] for row in got] == [row[1][:-1] for row in expected]


def test_a_stream_that_is_silent_for_longer_than_the_gap_costs_its_rows():
    messages = [m for m in samples() if m[0] != 'rate' or not 1200 * MS < m[1] < 1300 * MS]
    joiner = StreamJoiner(STREAMS, 0.05)
    stamps = [row[0] for row in rows_of(joiner, sorted(messages, key=lambda one: one[1]))]
    assert not [stamp for stamp in stamps if 1210 * MS < stamp < 1290 * MS]
    assert joiner.counts.dropped >= 9 and max(stamps) > 1500 * MS
    assert joiner.raw_columns() == ('px', 'qw', 'qx', 'qy', 'qz', 'wx', 'cmd1', 'vbat')


def test_what_goes_wrong_is_counted():
    joiner = StreamJoiner({'pose': INTERPOLATED, 'rate': INTERPOLATED}, 0.1)
    for stamp in (10, 20, 20, 15, 30):
        joiner.add('pose', stamp * MS, {'px': 1.0})
    joiner.add('rate', 12 * MS, {'wx': float('nan')})
    joiner.add('rate', -5, {'wx': 1.0})
    assert joiner.add('rate', 20 * MS, {'wx': 2.0}) == [(20 * MS, (1.0, 2.0))]
    counts = joiner.counts
    assert (counts.duplicated, counts.out_of_order, counts.nan) == (1, 2, 1)
    assert counts.dropped == 1 and counts.joined == 1    # the row at 10 ms has nothing before it
    assert joiner.has_reached(20 * MS) and not joiner.has_reached(21 * MS)


def test_a_clock_that_begins_anew_begins_new_rows():
    joiner = StreamJoiner({'pose': INTERPOLATED, 'rate': INTERPOLATED}, 0.1)
    rows = []
    for begin in (5 * RESTART_NS, RESTART_NS):
        for k in range(5):
            rows += joiner.add('pose', begin + k * 10 * MS, {'px': float(k)})
            rows += joiner.add('rate', begin + k * 10 * MS, {'wx': float(k)})
    assert [row[0] for row in rows] == [
        begin + k * 10 * MS for begin in (5 * RESTART_NS, RESTART_NS) for k in range(5)]
    assert joiner.counts.restarts == 1


@pytest.mark.parametrize('period', [5, 10, 40])
def test_no_command_is_lost_where_commands_come_more_often_than_states(period):
    """States each 20 ms: rows at their stamps, or at those of commands that are faster."""
    joiner = StreamJoiner({'pose': INTERPOLATED, 'commands': HELD}, 0.1)
    rows = rows_of(joiner, sorted(
        [('pose', k * 20 * MS, {'px': 0.1 * k}) for k in range(200)]
        + [('commands', k * period * MS + MS, {'cmd1': float(k)}) for k in range(4000 // period)],
        key=lambda one: one[1]))
    stamps, values = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    assert joiner.base == ('commands' if period < 20 else 'pose')
    np.testing.assert_allclose(values[:, 0], 0.005 * stamps / MS, rtol=1e-12)
    np.testing.assert_array_equal(values[:, 1], (stamps - MS) // (period * MS))
    if period < 20:
        assert set(values[:, 1]) >= set(range(1, 3960 // period))


def test_few_samples_are_joined_at_the_end():
    joiner = StreamJoiner({'pose': INTERPOLATED, 'commands': HELD}, 0.1)
    for k in range(10):
        assert joiner.add('commands', k * 10 * MS, {'cmd1': float(k)}) == []
        assert joiner.add('pose', k * 10 * MS, {'px': 0.0}) == []
    assert [row[0] for row in joiner.drain()] == [k * 10 * MS for k in range(10)]


@pytest.mark.parametrize('commands', [False, True])
@pytest.mark.parametrize('alone', ['pose', 'rate'])
def test_a_stream_alone_takes_bounded_memory(alone, commands):
    joiner = StreamJoiner({'pose': INTERPOLATED, 'rate': INTERPOLATED,
                           **({'commands': HELD} if commands else {})}, 0.1, most=100)
    for k in range(1000):
        assert joiner.add(alone, k * MS, {'x': 0.0}) == []
    assert all(len(part._stamps) <= 165 for part in joiner._samples.values())
    assert all(len(stamps) <= 100 for stamps in joiner._stamps.values())
