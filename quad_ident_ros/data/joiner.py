# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Joining of topics into rows by stamp, with an account of everything that went wrong."""

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
import heapq
from typing import TypeAlias

# A stamp that goes back by more than this is a clock that restarted, not a late message.
RESTART_NS = 1_000_000_000
LARGEST = 1e100     # of a value: what is computed of larger ones is soon no number any more
REMEMBERED = 2000   # emitted stamps, kept to distinguish a duplicate from a late message

Row: TypeAlias = tuple[int, tuple[float, ...]]
"""A stamp in ns, and the values of all topics at it."""

_Key: TypeAlias = tuple[int, int]
_Parts: TypeAlias = dict[str, Sequence[float] | None]


@dataclass
class Counts:
    """
    What became of the messages.

    received: per topic. joined: rows. dropped: stamps that some topic never delivered. late:
    messages after their row was given up. duplicated: a stamp twice on one topic. out_of_order: a
    stamp older than the one before it on its topic. nan: messages with a value that is no finite
    number or beyond LARGEST, or an attitude that is none. lost and incompatible_qos: as the
    middleware reports them. unreadable: messages that are not what the type of their topic has.
    unread: messages that waited when the recorder was told to end, for
    too long to be joined. restarts: of the clock. missing: samples that the records lack, whatever
    became of them, by the count that the sender announced or else by the sample period.
    """

    received: dict[str, int] = field(default_factory=dict)
    joined: int = 0
    dropped: int = 0
    late: int = 0
    duplicated: int = 0
    out_of_order: int = 0
    nan: int = 0
    lost: int = 0
    incompatible_qos: int = 0
    unreadable: int = 0
    unread: int = 0
    restarts: int = 0
    missing: int = 0

    def add(self, more: Mapping[str, int]) -> None:
        """Add what became of further messages, {name of a count: how many}."""
        for name, count in more.items():
            setattr(self, name, getattr(self, name) + count)

    def problems(self) -> dict[str, int]:
        """Return the counts of what went wrong that are not zero."""
        return {name: count for name, count in vars(self).items()
                if name not in ('received', 'joined') and count}


def are_measured(values: Iterable[float]) -> bool:
    """Return whether values are numbers of a size that measurements can have."""
    return sum(map(abs, values)) < LARGEST


class Joiner:
    """
    Joins messages of several topics that carry the same stamp into rows in stamp order.

    Topics may run ahead of one another by any time: a row is given up only when each topic that
    it lacks has delivered `hold` later stamps, or when `most` rows wait.
    Args: topics: names that a row needs.
    """

    def __init__(self, topics: Iterable[str], hold: int = 20, most: int = 20000) -> None:
        self.topics = tuple(topics)
        self.counts = Counts(received=dict.fromkeys(self.topics, 0))
        self._most = most
        # A row's key is (era, stamp): an era ends where the clock restarts.
        self._pending: dict[_Key, _Parts] = {}
        self._keys: list[_Key] = []
        self._last = dict.fromkeys(self.topics, (0, -1))
        self._before: dict[str, int | None] = dict.fromkeys(self.topics)
        self._newest: dict[str, deque[_Key]] = {name: deque(maxlen=hold) for name in self.topics}
        self._emitted = (0, -1)
        self._recent: deque[_Key] = deque(maxlen=REMEMBERED)

    def add(self, topic: str, stamp_ns: int, values: Sequence[float]) -> list[Row]:
        """
        Take a message's values and return the rows that it completes.

        A row is (stamp_ns, values of all topics in their order). Rows come in rising order of
        stamps; after a restart of the clock they begin again.
        """
        counts = self.counts
        counts.received[topic] += 1
        if stamp_ns < 0:
            counts.out_of_order += 1
            return []
        key = self._place(topic, stamp_ns)
        counts.restarts = max(era for era, _ in self._last.values())
        parts = self._pending.get(key)
        if parts is not None and topic in parts:
            counts.duplicated += 1
            return []
        if parts is None and key <= self._emitted:
            if key in self._recent:
                counts.duplicated += 1
            else:
                counts.late += 1
            return []
        measured = are_measured(values)
        if not measured:
            counts.nan += 1
        if parts is None:
            parts = self._pending[key] = {}
            heapq.heappush(self._keys, key)
        parts[topic] = values if measured else None
        return self._ready(self._given_up)

    def has_reached(self, stamp_ns: int) -> bool:
        """Whether each topic has delivered this stamp or a later one."""
        return all(stamp >= stamp_ns for _, stamp in self._last.values())

    def drain(self) -> list[Row]:
        """Return the rows that are complete, giving up those that are not."""
        return self._ready(lambda key, parts: True)

    def _place(self, topic: str, stamp: int) -> _Key:
        """Return the key of a message and note where its topic is."""
        era, last = self._last[topic]
        before = self._before[topic]
        if before is not None and stamp > before and self._emitted[0] < era:
            # The clock did not restart: one message came far too late.
            self._pending.pop((era, last), None)
            self._newest[topic].pop()
            self._before[topic] = None
            self.counts.out_of_order += 1
            return self._move(topic, (era - 1, stamp))
        if last - stamp > RESTART_NS:
            if self._awaits(topic, (era, stamp)) and self._emitted < (era, last):
                # Its clock did not restart: the others are where it is, one message was far ahead.
                self._take_back(topic, (era, last))
                return self._move(topic, (era, stamp))
            self._before[topic] = last
            return self._move(topic, (era + 1, stamp))
        if stamp < last:
            self.counts.out_of_order += 1
            return era, stamp
        if stamp > last:
            self._before[topic] = None
        newest = max(reached for reached, _ in self._last.values())
        if (newest, stamp) in self._pending and (era, stamp) not in self._pending:
            # Its clock did not go back, but the others' did, to where it is.
            era = newest
        return self._move(topic, (era, stamp))

    def _awaits(self, topic: str, key: _Key) -> bool:
        """Whether a row waits for a topic that others have delivered."""
        parts = self._pending.get(key)
        return parts is not None and topic not in parts

    def _take_back(self, topic: str, key: _Key) -> None:
        """Forget the last message of a topic, whose stamp is wrong."""
        parts = self._pending.get(key, {})
        parts.pop(topic, None)
        if not parts:
            self._pending.pop(key, None)
        self._newest[topic].pop()
        self.counts.out_of_order += 1

    def _move(self, topic: str, key: _Key) -> _Key:
        if key != self._last[topic]:
            self._newest[topic].append(key)
        self._last[topic] = key
        return key

    def _given_up(self, key: _Key, parts: _Parts) -> bool:
        return len(self._pending) > self._most or all(
            self._last[topic][0] > key[0] or self._has_gone_on(topic, key)
            for topic in self.topics if topic not in parts)

    def _has_gone_on(self, topic: str, key: _Key) -> bool:
        """Whether a topic has delivered `hold` stamps after a key."""
        newest = self._newest[topic]
        return len(newest) == newest.maxlen and newest[0] > key

    def _ready(self, given_up: Callable[[_Key, _Parts], bool]) -> list[Row]:
        rows = []
        while self._keys:
            key = self._keys[0]
            parts = self._pending.get(key)
            if parts is None:
                heapq.heappop(self._keys)
                continue
            complete = len(parts) == len(self.topics)
            if not complete and not given_up(key, parts):
                break
            heapq.heappop(self._keys)
            del self._pending[key]
            if complete or key[0] == self._emitted[0]:
                self._emitted = key
            if complete:
                self._recent.append(key)
            spoilt = any(value is None for value in parts.values())
            if complete and not spoilt:
                rows.append((key[1], tuple(v for name in self.topics for v in parts[name] or ())))
            elif not spoilt:
                self.counts.dropped += 1
        self.counts.joined += len(rows)
        return rows
