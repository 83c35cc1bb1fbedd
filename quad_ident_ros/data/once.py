# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is asked of one record several times, worked out once."""

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

from quad_ident_ros.data.record import FlightRecord

Answer = TypeVar('Answer')
Given = ParamSpec('Given')


def once(function: Callable[Concatenate[FlightRecord, Given], Answer]
         ) -> Callable[Concatenate[FlightRecord, Given], Answer]:
    """
    Return a function that works out its answer on a record once, for as long as that lives.

    What else it is given, as a vehicle, has to be the same object: for another one the answer is
    worked out anew. An answer that holds its record would keep it for ever.
    """
    known: WeakKeyDictionary[FlightRecord, tuple[tuple, Answer]] = WeakKeyDictionary()

    @wraps(function)
    def answer(record: FlightRecord, *args: Given.args, **kwargs: Given.kwargs) -> Answer:
        given = (*args, *kwargs.values())
        before = known.get(record)
        if before is None or len(before[0]) != len(given) or any(
                one is not other for one, other in zip(before[0], given, strict=True)):
            before = known[record] = given, function(record, *args, **kwargs)
        return before[1]
    return answer
