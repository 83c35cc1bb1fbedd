# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What several checks ask of one record, worked out once."""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import WeakKeyDictionary

from quad_ident_ros.data.record import FlightRecord

Answer = TypeVar('Answer')


def once(function: Callable[[FlightRecord], Answer]) -> Callable[[FlightRecord], Answer]:
    """Return a function that works out its answer on a record once, for as long as that lives."""
    known: WeakKeyDictionary[FlightRecord, Answer] = WeakKeyDictionary()

    @wraps(function)
    def answer(record: FlightRecord) -> Answer:
        if record not in known:
            known[record] = function(record)
        return known[record]
    return answer
