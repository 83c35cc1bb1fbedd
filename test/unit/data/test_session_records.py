# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which of the recorder's records belong together."""

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.nodes.records import Records


def record(samples=10, **info):
    return FlightRecord(np.arange(samples) * 0.01, {}, info)


def run(index, samples=10, session=1, count=2):
    return record(samples, session=session, run_index=index, run_count=count)


def test_an_experiment_is_complete_with_a_record_of_each_run_in_their_order():
    records = Records()
    assert len(records) == 0
    second, first = run(1), run(0)
    assert records.add(second, longest=True)    # another session than none
    assert not records.complete
    assert not records.add(first, longest=True)
    assert records.complete and records.all() == [first, second]
    assert records.newest is first


def test_of_the_parts_of_a_run_the_longest_or_the_newest_has_the_say():
    for longest, expected in ((True, 20), (False, 5)):
        records = Records()
        for samples in (10, 20, 5):
            records.add(run(0, samples, count=1), longest=longest)
        assert [len(one) for one in records.all()] == [expected]


def test_a_record_of_no_run_gives_way_to_the_next():
    records = Records()
    for samples in (20, 5):
        records.add(record(samples), longest=True)
        assert records.complete
    assert [len(one) for one in records.all()] == [5]


def test_another_session_begins_anew():
    records = Records()
    for index in (0, 1):
        records.add(run(index), longest=True)
    late = run(1, session=2)
    assert records.add(late, longest=True)
    assert records.all() == [late] and not records.complete
