# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Records of PX4 cut where the estimates in them were reset, by the counters of their topics."""

from array import array
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.px4_states import RESET_FIELDS, resets, Topics
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import split

ODOMETRY = 'vehicle_odometry'
POSITIONS = 'vehicle_local_position', 'estimator_local_position'
TOPIC_OF = {'px4_msgs/msg/VehicleOdometry': ODOMETRY,
            'px4_msgs/msg/VehicleAttitude': 'vehicle_attitude',
            'px4_msgs/msg/VehicleLocalPosition': POSITIONS[0]}
"""Types of messages that count resets, and the topic of a log with the same fields."""


def split_at_resets(records: Sequence[FlightRecord], start_ns: int,
                    topics: Topics) -> list[FlightRecord]:
    """
    Return the parts of records between resets of the estimator, with notes.

    Args: records whose t (s) counts from start_ns; topics: those that their position, velocity
    and attitude are taken from, topic -> (stamps (n,) ns, fields name -> (n,)).
    """
    if any('xy_reset_counter' in topics[name][1] for name in POSITIONS if name in topics):
        # It has all resets that an odometry counts, with their sizes.
        topics = {name: found for name, found in topics.items() if name != ODOMETRY}
    found, small = resets(topics)
    times = [((before - start_ns) * 1e-9, (after - start_ns) * 1e-9, what)
             for before, after, what in found]
    passed = [(stamp - start_ns) * 1e-9 for stamp in small]
    return [piece for one in records for piece in split(_passing_over(one, passed), times)]


class Counters:
    """The counters of resets in the messages of a type of TOPIC_OF, and the sizes of these."""

    def __init__(self, msgtype: str) -> None:
        self.topic = TOPIC_OF[msgtype]
        self._names = RESET_FIELDS[self.topic]
        self._numbers = array('d')

    def add(self, message: Message) -> None:
        """Take the counters of a message."""
        self._numbers.extend(self._of(message))

    def add_many(self, message: Message, count: int) -> None:
        """Take the counters of messages in one, with columns (count,) in place of numbers."""
        columns = [np.broadcast_to(value, count) for value in self._of(message)]
        self._numbers.frombytes(np.stack(columns, axis=-1).astype(float).tobytes())

    def _of(self, message: Message) -> list[Any]:
        values = []
        for name in self._names:
            field, _, place = name.partition('[')
            value: Any = getattr(message, field, np.nan)
            if place:
                k = int(place[:-1])
                value = value[k] if np.ndim(value) and len(value) > k else np.nan
            values.append(value)
        return values

    def fields(self) -> dict[str, np.ndarray]:
        """Return the fields that all messages have, name -> (n,)."""
        table = np.frombuffer(self._numbers, float).reshape(-1, len(self._names))
        return {name: values for name, values in zip(self._names, table.T, strict=True)
                if '_counter' not in name or np.isfinite(values).all()}


def _passing_over(record: FlightRecord, times: list[float]) -> FlightRecord:
    """Return a record with a note of the small resets (s) in it."""
    count = sum(bool(record.t[0] < time < record.t[-1]) for time in times)
    if not count:
        return record
    note = (f'{counted(count, "reset")} of the estimator, by less than its noise, '
            f'{"is" if count == 1 else "are"} passed over')
    return replace(record, info={**record.info, 'notes': [*record.info['notes'], note]})
