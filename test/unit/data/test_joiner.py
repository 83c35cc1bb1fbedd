# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of joining topics by stamp."""

import math
import random

from hypothesis import given, settings
from hypothesis import strategies as st
import pytest

from quad_ident_ros.data.joiner import Joiner

MS = 1_000_000
SECOND = 1000 * MS


def feed(joiner, messages):
    """Add (topic, stamp in ms) one after the other and return the rows."""
    rows = []
    for topic, stamp in messages:
        rows += joiner.add(topic, stamp * MS, (float(stamp),))
    return rows


def stamps(rows):
    return [stamp // MS for stamp, _ in rows]


def even(topics, start, stop):
    return [(topic, stamp) for stamp in range(start, stop, 10) for topic in topics]


@given(st.permutations('a' * 8 + 'b' * 8 + 'c' * 8))
@settings(max_examples=60, deadline=None)
def test_any_interleaving_gives_the_same_rows(order):
    joiner = Joiner('abc')
    following = dict.fromkeys('abc', 0)
    rows = []
    for topic in order:
        stamp = following[topic]
        following[topic] += 1
        rows += joiner.add(topic, stamp * MS, (stamp + ord(topic) / 1000,))
    assert rows == [(k * MS, (k + 0.097, k + 0.098, k + 0.099)) for k in range(8)]
    assert joiner.counts.problems() == {}
    assert joiner.counts.joined == 8
    assert joiner.counts.received == {'a': 8, 'b': 8, 'c': 8}


def test_a_topic_may_run_ahead_by_any_time():
    joiner = Joiner('ab')
    assert feed(joiner, [('a', 10 * k) for k in range(5000)]) == []
    assert stamps(feed(joiner, [('b', 10 * k) for k in range(5000)])) == list(range(0, 50000, 10))
    assert joiner.counts.problems() == {}


def test_a_topic_may_begin_late():
    joiner = Joiner('ab')
    feed(joiner, [('a', 10 * k) for k in range(30)])
    rows = feed(joiner, even('ab', 300, 600))
    assert stamps(rows) == list(range(300, 600, 10))
    # Nobody can know that b's first messages will not come until it has gone on for long enough.
    assert joiner.counts.dropped == 30


@pytest.mark.parametrize('every', [2, 7, 50])
def test_what_one_topic_lacks_is_dropped_and_counted(every):
    joiner = Joiner('abc')
    lost = set(range(0, 4000, 10 * every))
    messages = [(topic, stamp) for topic, stamp in even('abc', 0, 4000)
                if topic != 'b' or stamp not in lost]
    rows = feed(joiner, messages) + joiner.drain()
    assert stamps(rows) == [stamp for stamp in range(0, 4000, 10) if stamp not in lost]
    assert joiner.counts.problems() == {'dropped': len(lost)}
    assert joiner.counts.joined == 400 - len(lost)


def test_a_late_message_completes_its_row_while_it_is_held():
    messages = even('ab', 0, 1000)
    late = messages.index(('b', 400))
    messages.insert(late + 30, messages.pop(late))    # 15 samples late
    joiner = Joiner('ab', hold=20)
    assert stamps(feed(joiner, messages)) == list(range(0, 1000, 10))
    assert joiner.counts.problems() == {'out_of_order': 1}


def test_a_message_after_its_row_was_given_up_is_late():
    messages = even('ab', 0, 1000)
    late = messages.index(('b', 400))
    messages.insert(late + 50, messages.pop(late))    # 25 samples late
    joiner = Joiner('ab', hold=20)
    assert stamps(feed(joiner, messages)) == [s for s in range(0, 1000, 10) if s != 400]
    assert joiner.counts.problems() == {'dropped': 1, 'out_of_order': 1, 'late': 1}


def test_duplicates_are_counted_and_ignored():
    messages = []
    for topic, stamp in even('ab', 0, 1000):
        messages += [(topic, stamp)] * (2 if stamp % 100 == 0 else 1)
    joiner = Joiner('ab')
    assert stamps(feed(joiner, messages)) == list(range(0, 1000, 10))
    assert joiner.counts.duplicated == 20
    # And one of a row that has long left.
    assert feed(joiner, [('a', 500)]) == []
    assert joiner.counts.duplicated == 21


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf, 1.7e308, -1e200])
def test_what_is_no_finite_number_spoils_its_row_only(bad):
    joiner = Joiner('ab')
    rows = []
    for topic, stamp in even('ab', 0, 500):
        value = bad if (topic, stamp) == ('b', 200) else 1.0
        rows += joiner.add(topic, stamp * MS, (1.0, value))
    assert stamps(rows) == [s for s in range(0, 500, 10) if s != 200]
    assert joiner.counts.problems() == {'nan': 1}


def test_a_clock_that_begins_anew_begins_new_rows():
    joiner = Joiner('ab')
    rows = feed(joiner, even('ab', 5000, 8000)) + feed(joiner, even('ab', 0, 9000))
    assert stamps(rows) == [*range(5000, 8000, 10), *range(0, 9000, 10)]
    assert joiner.counts.problems() == {'restarts': 1}


def test_topics_may_begin_anew_at_different_times():
    joiner = Joiner('ab')
    rows = feed(joiner, even('ab', 5000, 8000))
    rows += feed(joiner, [('a', stamp) for stamp in range(0, 3000, 10)])
    # The last messages of b from before come when a is in its new life already.
    rows += feed(joiner, [('b', stamp) for stamp in [8000, 8010, *range(0, 3000, 10)]])
    assert stamps(rows) == [*range(5000, 8000, 10), *range(0, 3000, 10)]
    assert joiner.counts.problems() == {'restarts': 1, 'dropped': 2}


@pytest.mark.parametrize('topics', ['a', 'ab', 'abc'])
@pytest.mark.parametrize('drain', [False, True])
def test_one_message_from_long_ago_is_no_new_clock(topics, drain):
    joiner = Joiner('abc')
    rows = feed(joiner, even('abc', 5000, 8000))
    rows += feed(joiner, [(topic, 100) for topic in topics])
    rows += feed(joiner, even('abc', 8000, 8010))
    if drain:
        rows += joiner.drain()
    rows += feed(joiner, even('abc', 8010, 9000))
    assert [s for s in stamps(rows) if s != 100] == list(range(5000, 9000, 10))
    assert joiner.counts.dropped == 0


@pytest.mark.parametrize('order', ['abc', 'bac', 'acb', 'random'])
@pytest.mark.parametrize('whose', ['b', 'ab'])
@pytest.mark.parametrize('ahead', [2000, 10 ** 12])
def test_one_message_from_far_ahead_costs_its_row_only(order, whose, ahead):
    """Where it came last in its sample, its topic and the others never met again."""
    draw, joiner = random.Random(1), Joiner('abc')
    rows = []
    for stamp in range(0, 5000, 10):
        topics = draw.sample('abc', 3) if order == 'random' else order
        rows += feed(joiner, [(topic, stamp + ahead * (stamp == 2000 and topic in whose))
                              for topic in topics])
    wanted = [stamp for stamp in range(0, 5000, 10) if stamp != 2000]
    assert set(wanted) - set(stamps(rows)) <= {1990, 2010}
    assert joiner.counts.dropped <= 4


def test_messages_that_nobody_joins_are_bounded():
    joiner = Joiner('ab', most=100)
    feed(joiner, [('a', 10 * k) for k in range(1000)])
    assert joiner.counts.dropped == 900
    assert stamps(feed(joiner, [('b', 10 * k) for k in range(1000)])) == list(range(9000, 10000,
                                                                                    10))


def test_drain_gives_up_what_is_incomplete():
    joiner = Joiner('ab')
    feed(joiner, [('a', 0), ('a', 10), ('b', 10), ('a', 20)])
    assert stamps(joiner.drain()) == [10]
    assert joiner.counts.problems() == {'dropped': 2}
    assert joiner.drain() == []
    assert stamps(feed(joiner, [('b', 20), *even('ab', 30, 50)])) == [30, 40]
    assert joiner.counts.late == 1


def test_it_tells_how_far_all_topics_are():
    joiner = Joiner('ab')
    assert not joiner.has_reached(0)
    feed(joiner, [('a', 100), ('b', 80)])
    assert joiner.has_reached(80 * MS) and not joiner.has_reached(90 * MS)


@pytest.mark.slow
def test_the_cost_does_not_grow_with_what_waits():
    """A topic that is far ahead and one that has lost a message: no work per waiting row."""
    joiner = Joiner('ab')
    feed(joiner, [('a', 10 * k) for k in range(15000)])
    rows = feed(joiner, [('b', 10 * k) for k in range(15000) if k % 10])
    assert len(rows) + joiner.counts.dropped >= 14900
    assert joiner.counts.dropped >= 1490


def test_topics_meet_again_after_the_clock_of_one_alone_went_back():
    joiner = Joiner(['a', 'b'])
    for second in (10, 11, 5, 6):    # a's clock goes back, b is not there yet
        joiner.add('a', second * 10 ** 9, (1.0,))
    rows = []
    for second in range(20, 60):
        rows += joiner.add('a', second * 10 ** 9, (1.0,))
        rows += joiner.add('b', second * 10 ** 9, (2.0,))
    assert [stamp // 10 ** 9 for stamp, _ in rows][-3:] == [57, 58, 59]
