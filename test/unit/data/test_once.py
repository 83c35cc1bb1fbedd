# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What checks ask of a record is worked out once, and forgotten with the record."""

import gc
import weakref

from flightmaker import changed, flight

from quad_ident_ros.data.once import once


def test_a_record_is_looked_at_once():
    asked = []

    @once
    def samples(record):
        asked.append(record)
        return len(record)

    record = flight(seconds=1.0)
    assert [samples(record), samples(record)] == [100, 100]
    assert len(asked) == 1
    assert samples(flight(seconds=2.0)) == 200
    assert len(asked) == 2


def test_with_another_vehicle_it_is_looked_at_anew():
    asked = []

    @once
    def look(record, vehicle, name=None):
        asked.append((vehicle, name))
        return len(asked)

    record, one, other = flight(seconds=1.0), {'mass': 1.0}, {'mass': 1.0}
    assert [look(record, one), look(record, one), look(record, other)] == [1, 1, 2]
    assert [look(record, other, name='a'), look(record, other, name='a')] == [3, 3]
    assert look(record, one) == 4


def test_no_record_is_kept():
    look = once(len)
    record = changed(flight(seconds=1.0))
    kept = weakref.ref(record)
    look(record)
    del record
    gc.collect()
    assert kept() is None
