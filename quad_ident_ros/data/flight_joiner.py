# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Joining of the topics of a flight, by equal stamps or, where these do not meet, between them."""

from collections import deque
from collections.abc import Sequence

from quad_ident_ros.data.joiner import Counts, Joiner
from quad_ident_ros.data.stream_joiner import StreamJoiner
from quad_ident_ros.data.streams import HELD, INTERPOLATED
from quad_ident_ros.data.topics import FLIGHT_TOPICS

DECIDED = 100       # stamps whose fate shows how the topics go together: chance joins few of them
AHEAD = 20000       # interpolated rows that wait for that
STATES = ('pose', 'attitude', 'twist', 'altitude')

Row = tuple[int, tuple[float, ...]]


class FlightJoiner:
    """
    Joins messages of FLIGHT_TOPICS into rows, values of all topics in their order.

    By equal stamps (Joiner), unless more of the first DECIDED stamps come without the others than
    with them: then topics have rates of their own, and are joined between their samples
    (StreamJoiner) at the stamps of the pose, or of the first of STATES that exists, or of
    inputs that come far more often.
    Args: topics: names that a row needs; gap: s between samples beyond which rows are dropped.
    """

    def __init__(self, topics: Sequence[str], gap: float):
        self.topics = tuple(topics)
        self.interpolates = False
        base = next(name for name in (*STATES, *topics) if name in topics)
        self._equal = Joiner(self.topics)
        self._between: StreamJoiner | None = StreamJoiner(
            {name: HELD if name == 'input' else INTERPOLATED for name in topics}, gap, base)
        self._ahead: deque[Row] = deque(maxlen=AHEAD)
        self._last = -1

    @property
    def counts(self) -> Counts:
        """Return the account of the messages."""
        return self._now.counts

    @property
    def base(self) -> str:
        """Return the topic at whose stamps rows are interpolated, '' where stamps are equal."""
        return self._between.base if self._between is not None else ''

    @property
    def _now(self) -> Joiner | StreamJoiner:
        between = self._between
        return between if self.interpolates and between is not None else self._equal

    def add(self, topic: str, stamp_ns: int, values: Sequence[float]) -> list[Row]:
        """Take a message's values and return the rows (stamp_ns, values) that are now complete."""
        if self._between is None:
            return self._equal.add(topic, stamp_ns, values)
        between = self._between.add(topic, stamp_ns, dict(zip(FLIGHT_TOPICS[topic].columns, values,
                                                              strict=True)))
        if self.interpolates:
            return between
        self._ahead += between
        rows = self._equal.add(topic, stamp_ns, values)
        if rows:
            self._last = rows[-1][0]
        return rows + self._decide(self._between)

    def has_reached(self, stamp_ns: int) -> bool:
        """Whether each topic has delivered this stamp or a later one."""
        return self._now.has_reached(stamp_ns)

    def drain(self) -> list[Row]:
        """Return the rows that are complete, giving up those that are not."""
        return self._now.drain()

    def _decide(self, between: StreamJoiner) -> list[Row]:
        """Choose the way to join once that is known; return rows that this completes."""
        counts = self._equal.counts
        if counts.joined + counts.dropped < DECIDED:
            return []
        if counts.dropped <= counts.joined:
            self._between = None
            self._ahead.clear()
            return []
        self.interpolates = True
        rows = [row for row in self._ahead if row[0] > self._last]
        self._ahead.clear()
        between.counts.joined = counts.joined + len(rows)
        for name in ('lost', 'incompatible_qos', 'unreadable'):     # before they reach a joiner
            setattr(between.counts, name, getattr(counts, name))
        return rows
