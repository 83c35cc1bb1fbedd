# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of cutting rows into flight records."""

from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.data.buffer import Limits, RecordBuffer
from quad_ident_ros.data.topics import raw_columns, RunNotice

MS = 1_000_000
COLUMNS = raw_columns(['altitude'])


def rows(start, stop, step=10, without=()):
    """Return rows at even times (ms) whose value is the time."""
    return [(t * MS, (float(t),)) for t in range(start, stop, step) if t not in without]


def times(record):
    """Return the times in ms that the rows of a record were made from."""
    return record.columns['pz'].astype(int).tolist()


def notice(start, stop, step=10, **info):
    return RunNotice(start * MS, stop * MS, (stop - start) // step + 1,
                     {'starts_at_rest': True, 'initial': {'z': 1.0}, 'trim': [0.0] * 4, **info})


def buffer(**limits):
    return RecordBuffer(COLUMNS, Limits(**limits))


def test_rows_become_a_record_on_demand():
    window = buffer()
    assert window.add_rows(rows(5000, 6000)) == []
    assert len(window) == 100
    [record] = window.complete()
    assert times(record) == list(range(5000, 6000, 10))
    np.testing.assert_allclose(record.t, 0.01 * np.arange(100), atol=1e-12)
    assert record.info == {'start_ns': 5000 * MS, 'dropped': 0}
    assert len(window) == 0 and window.complete() == []


def test_one_row_is_no_record():
    window = buffer()
    window.add_rows(rows(0, 10))
    assert window.complete() == []


@pytest.mark.parametrize('limits', [{'samples': 50}, {'seconds': 0.49}])
def test_a_full_window_is_a_record(limits):
    window = buffer(**limits)
    records = window.add_rows(rows(0, 1250))
    assert [times(record) for record in records] == [list(range(0, 500, 10)),
                                                     list(range(500, 1000, 10))]
    assert len(window) == 25


def test_overlapping_windows_slide():
    records = buffer(samples=100, overlap=0.9).add_rows(rows(0, 2000))
    assert [times(record) for record in records] == [list(range(k, k + 1000, 10))
                                                     for k in range(0, 1001, 100)]


def test_a_run_ends_with_its_last_sample():
    window = buffer()
    assert window.add_run(notice(1000, 2000, name='one')) == []
    records = window.add_rows(rows(1000, 2010) + rows(3000, 3100))
    assert [times(record) for record in records] == [list(range(1000, 2010, 10))]
    assert records[0].info == {'name': 'one', 'starts_at_rest': True, 'initial': {'z': 1.0},
                               'trim': [0.0] * 4, 'start_ns': 1000 * MS, 'dropped': 0}
    assert len(window) == 10 and not window.run_name


def test_a_run_without_a_name_is_one_all_the_same():
    window = buffer()
    window.add_run(notice(0, 1000, name=''))
    window.add_rows(rows(0, 900))
    assert window.run_name == 'unnamed'


def test_the_next_run_ends_one_without_its_last_samples():
    window = buffer()
    window.add_run(notice(0, 1000, name='one'))
    assert window.add_rows(rows(0, 900)) == []
    assert window.run_name
    window.add_run(notice(2000, 3000, name='two'))
    [record] = window.add_rows(rows(2000, 2010))
    assert (record.info['name'], record.info['dropped']) == ('one', 11)
    assert window.missing == 11


def test_a_notice_may_come_after_its_rows():
    window = buffer()
    window.add_rows(rows(0, 500))
    assert window.add_run(notice(0, 1000, name='late')) == []
    [record] = window.add_rows(rows(500, 1010))
    assert record.info['name'] == 'late' and len(record) == 101
    # Even after all of them.
    window.add_rows(rows(2000, 3010))
    [record] = window.add_run(notice(2000, 3000, name='later'))
    assert record.info['name'] == 'later' and len(record) == 101


def test_what_holds_at_the_start_is_said_of_the_start_only():
    window = buffer(samples=60)
    window.add_run(notice(0, 1000))
    first, second = window.add_rows(rows(0, 1010))
    assert {'starts_at_rest', 'initial', 'trim'} <= set(first.info)
    assert 'trim' in second.info
    assert not {'starts_at_rest', 'initial'} & set(second.info)
    # A run whose first sample was lost is not known to begin at rest.
    window = buffer()
    window.add_run(notice(0, 1000))
    [record] = window.add_rows(rows(10, 1010))
    assert 'starts_at_rest' not in record.info
    assert record.info['dropped'] == 1


def test_a_clock_that_begins_anew_ends_a_record():
    window = buffer()
    [record] = window.add_rows(rows(5000, 6000) + rows(0, 500))
    assert times(record) == list(range(5000, 6000, 10))
    assert len(window) == 50


def test_notices_of_runs_that_are_over_are_not_kept():
    window = buffer()
    for start in range(0, 100_000, 1000):
        window.add_run(notice(start, start + 500))
        window.add_rows(rows(start, start + 400))    # the last samples never come
    assert len(window._runs) == 1


def test_the_same_run_flown_again_is_another_record():
    window = buffer()
    window.add_run(notice(0, 1000, name='one'))
    assert window.add_rows(rows(0, 800)) == []
    window.add_run(notice(0, 1000, name='one'))
    first, second = window.add_rows(rows(0, 1010))
    assert (len(first), first.info['dropped']) == (80, 21)
    assert (len(second), second.info['dropped']) == (101, 0)


def test_another_run_at_the_same_time_does_not_take_the_rows_of_the_first():
    window = buffer()
    window.add_run(notice(0, 1000, name='old'))
    window.add_rows(rows(0, 800))
    [record] = window.add_run(notice(0, 500, name='new'))
    assert (record.info['name'], len(record)) == ('old', 80)
    [record] = window.add_rows(rows(0, 510))
    assert (record.info['name'], len(record), record.info['dropped']) == ('new', 51, 0)


def test_a_run_that_begins_within_another_cuts_it_short():
    """The simulator was killed, and started again before the first flight would have ended."""
    window = buffer()
    window.add_run(notice(0, 1000, name='killed'))
    window.add_rows(rows(0, 400))
    window.add_run(notice(700, 1700, name='again'))
    cut, whole = window.add_rows(rows(700, 1710))
    assert (cut.info['name'], len(cut), cut.info['dropped']) == ('killed', 40, 61)
    assert (whole.info['name'], len(whole), whole.info['dropped']) == ('again', 101, 0)


def test_missing_samples_are_counted_without_a_notice():
    window = buffer()
    window.add_rows(rows(0, 1000, without=(100, 110, 500)))
    [record] = window.complete()
    assert record.info['dropped'] == window.missing == 3


def test_missing_samples_are_counted_by_the_notice():
    window = buffer()
    window.add_run(notice(0, 1000))
    window.add_rows(rows(30, 900, without=(100, 110, 500)))
    [record] = window.complete(run_over=True)
    assert record.info['dropped'] == window.missing == 3 + 3 + 11


def test_a_run_that_goes_on_after_it_was_given_up():
    window = buffer()
    window.add_run(notice(0, 1000))
    window.add_rows(rows(0, 500))
    [record] = window.complete(run_over=True)
    assert record.info['dropped'] == 51
    [record] = window.add_rows(rows(500, 1010))
    assert record.info['dropped'] == 0


@pytest.mark.slow
@given(st.sets(st.integers(0, 100)), st.sampled_from([0.0, 0.3, 0.5, 0.9]),
       st.integers(5, 120), st.booleans())
@settings(max_examples=150, deadline=None)
def test_each_missing_sample_is_counted_once(lost, overlap, samples, announced):
    """Whatever the windows: the sum is right, and what is not lost is in some record."""
    window = buffer(samples=samples, overlap=overlap)
    if announced:
        window.add_run(notice(0, 1000))
    given_rows = rows(0, 1010, without={10 * k for k in lost})
    records = window.add_rows(given_rows) + window.complete(run_over=True)
    assert all(record.info['dropped'] >= 0 for record in records)
    present = sorted(set(range(0, 1010, 10)) - {10 * k for k in lost})
    seen = {t for record in records for t in times(record)}
    assert seen <= set(present)
    if overlap:   # windows without overlap may end with one row, which is no record
        assert seen == set(present) or len(present) < 2
    if announced and present:
        assert window.missing == len(lost)
