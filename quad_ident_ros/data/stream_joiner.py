# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Live streams of different rates, joined into rows at the stamps of one of them."""

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Mapping, Sequence
import math

import numpy as np

from quad_ident_ros.data.joiner import are_measured, Counts, RESTART_NS, Row
from quad_ident_ros.data.record import EULER, QUATERNION
from quad_ident_ros.data.streams import HELD, INTERPOLATED, slerp, SLOW
from quad_ident_ros.model.attitude import continuous

TURN = 2.0 * math.pi
DECIDED = 50    # samples of a state or of the commands after which it is known which is faster
FASTER = 1.5    # times as many commands as states from which on every other one might be lost


class StreamJoiner:
    """
    Joins messages of several streams into rows at the stamps of one, the base.

    The base is a state, or the commands (the first HELD stream) where FASTER times as many of
    these come, for a row has one command.

    Between its samples a stream is interpolated, attitudes along the shortest turn, or it holds
    (commands, a battery), as data.streams.join has it for bags. A row waits until each stream has
    gone on beyond its stamp, and is dropped where the samples around it are further apart than the
    gap. Streams may run ahead of one another by any time, up to `most` waiting rows.
    Args: streams: name -> INTERPOLATED, HELD or SLOW; gap: s; base: the name of the state, by
    default the first stream; most.
    """

    def __init__(self, streams: Mapping[str, str], gap: float, base: str | None = None,
                 most: int = 20000) -> None:
        self.topics = tuple(streams)
        self.counts = Counts(received=dict.fromkeys(streams, 0))
        self.columns: dict[str, tuple[str, ...]] = {}
        self._between = dict(streams)
        self.base = base or self.topics[0]
        self._gap = int(gap * 1e9)
        self._most = most
        self._samples = {name: _Samples() for name in streams}
        commands = next((name for name, how in streams.items() if how == HELD), self.base)
        self._stamps: dict[str, deque[int]] = {     # of rows, by the base
            name: deque() for name in (self.base, commands)}
        self._is_decided = len(self._stamps) == 1
        self._last = dict.fromkeys(streams, -1)

    def add(self, name: str, stamp_ns: int, values: Mapping[str, float]) -> list[Row]:
        """
        Take a sample, columns -> numbers, and return the rows (stamp_ns, values) now complete.

        The values of a row are those of all streams in their order; columns names them.
        """
        counts = self.counts
        counts.received[name] += 1
        last = self._last[name]
        if 0 <= stamp_ns < last - RESTART_NS:
            self._restart(name, stamp_ns)
        elif stamp_ns == last:
            counts.duplicated += 1
            return []
        elif stamp_ns < max(last, 0):
            counts.out_of_order += 1
            return []
        self._last[name] = stamp_ns
        if not are_measured(values.values()):
            counts.nan += 1
            return []
        self.columns.setdefault(name, tuple(values))
        self._samples[name].add(stamp_ns, tuple(values.values()))
        if name in self._stamps:
            self._stamps[name].append(stamp_ns)
            if not self._is_decided and len(self._stamps[name]) >= DECIDED:
                self._decide()
        return self._ready(False)

    def raw_columns(self) -> tuple[str, ...]:
        """Return the names of the values of a row, once each stream has had a sample."""
        return tuple(column for name in self.topics for column in self.columns[name])

    def has_reached(self, stamp_ns: int) -> bool:
        """Whether each stream has delivered this stamp or a later one."""
        return all(last >= stamp_ns for last in self._last.values())

    def behind(self) -> dict[str, float]:
        """Return {name: s} by which the last stamp of each stream heard is behind the base's."""
        last = self._last[self.base]
        return {name: (last - stamp) * 1e-9 for name, stamp in self._last.items()
                if name != self.base and min(stamp, last) >= 0}

    def drain(self) -> list[Row]:
        """Return the rows that are complete, giving up those that are not."""
        if not self._is_decided:
            self._decide()
        return self._ready(True)

    def _decide(self) -> None:
        """Choose the base by how many states and commands came so far."""
        state, commands = self._stamps
        if len(self._stamps[commands]) > FASTER * len(self._stamps[state]):
            self.base = commands
        self._stamps = {self.base: self._stamps[self.base]}
        self._is_decided = True

    def _restart(self, name: str, stamp: int) -> None:
        """Forget the samples of a stream whose clock restarted, and what is from before it."""
        self._samples[name].clear()
        given_up = len(self._stamps.get(name, ()))
        if name in self._stamps:
            self._stamps[name].clear()
        if name != self.base:
            return
        self.counts.restarts += 1
        self.counts.dropped += given_up
        for other in self.topics:
            if self._last[other] > stamp + RESTART_NS:
                self._samples[other].clear()
                self._last[other] = -1

    def _ready(self, drain: bool) -> list[Row]:
        rows, waiting = [], self._stamps[self.base]
        while waiting and self._is_decided:
            stamp = waiting[0]
            parts = [self._at(name, stamp) for name in self.topics]
            given_up = drain or len(waiting) > self._most
            if any(part is None for part in parts) and not given_up:
                break
            waiting.popleft()
            there = [part for part in parts if part]
            if len(there) == len(parts):
                rows.append((stamp, tuple(value for part in there for value in part)))
            else:
                self.counts.dropped += 1
        # What is before the sample before the next row will not be asked for again.
        until = min((stamps[0] for stamps in self._stamps.values() if stamps),
                    default=self._last[self.base])
        for name in self.topics:
            self._samples[name].forget(until, self._most)
        self.counts.joined += len(rows)
        return rows

    def _at(self, name: str, stamp: int) -> tuple[float, ...] | None:
        """Return the values of a stream at a stamp, () where it has none, None if not yet."""
        samples = self._samples[name]
        before, after = samples.around(stamp)
        if before is not None and before[0] == stamp:
            return before[1]
        between = self._between[name]
        if between == SLOW and before is not None:
            return before[1]
        if after is None:
            return None
        if before is None or after[0] - before[0] > self._gap:
            return after[1] if between == SLOW else ()
        if between == HELD:
            return before[1]
        return _between(self.columns[name], before, after, stamp)


class _Samples:
    """The samples of a stream in order of time."""

    def __init__(self) -> None:
        self._stamps: list[int] = []
        self._values: list[tuple[float, ...]] = []

    def add(self, stamp: int, values: tuple[float, ...]) -> None:
        """Take the next sample."""
        self._stamps.append(stamp)
        self._values.append(values)

    def clear(self) -> None:
        """Forget all of them."""
        self._stamps.clear()
        self._values.clear()

    def around(self, stamp: int) -> tuple[Row | None, Row | None]:
        """Return the last (stamp, values) up to a stamp and the first from it on, or None."""
        left, right = bisect_right(self._stamps, stamp) - 1, bisect_left(self._stamps, stamp)
        return self._row(left), self._row(right)

    def _row(self, k: int) -> Row | None:
        return (self._stamps[k], self._values[k]) if 0 <= k < len(self._stamps) else None

    def forget(self, stamp: int, most: int) -> None:
        """Forget what is before the last sample up to a stamp, and beyond `most` samples."""
        done = max(bisect_right(self._stamps, stamp) - 1, len(self._stamps) - most)
        if done > 64 or done == len(self._stamps) - most > 0:   # rarely, as it moves the rest
            del self._stamps[:done], self._values[:done]


def _between(columns: Sequence[str], before: Row, after: Row, stamp: int) -> tuple[float, ...]:
    """Return values at a stamp between two samples (stamp, values)."""
    span = (after[0] - before[0]) * 1e-9
    x = (stamp - before[0]) * 1e-9
    share = x / span
    values = [one + share * (math.remainder(other - one, TURN) if name in EULER else other - one)
              for name, one, other in zip(columns, before[1], after[1], strict=True)]
    if QUATERNION[0] in columns:
        at = columns.index(QUATERNION[0])
        q = continuous(np.array([before[1][at:at + 4], after[1][at:at + 4]]))
        values[at:at + 4] = slerp(np.array([0.0, span]), q, np.array([x]))[0].tolist()
    return tuple(values)


BETWEEN = {'commands': HELD, 'battery': SLOW}
"""How the streams of roles (data.mapping.ROLES) are between their samples, if not INTERPOLATED."""


def between_of(role: str) -> str:
    """Return how the stream of a role is between its samples."""
    return BETWEEN.get(role, INTERPOLATED)
