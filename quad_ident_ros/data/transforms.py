# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The pose of a frame in the world, composed of the transforms that lead to it."""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence

import numpy as np

from quad_ident_ros.data.joiner import RESTART_NS
from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.data.streams import at_stamps, covered, Stream
from quad_ident_ros.data.topics import not_unit
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import product, rotate

BODIES = frozenset(('base_link', 'body', 'base', 'fcu'))
"""Last parts of the usual names of the frame of a vehicle, which needs not be named."""

COLUMNS = ('px', 'py', 'pz', *QUATERNION)
FASTER = 1.5        # times as many transforms from which on another link sets the stamps
SETTLED = 2 * 10 ** 9   # ns of transforms after which a live chain is taken to be whole
MOST = 20000        # transforms of a link that wait
SAME = 1e-6         # m, and of a quaternion: by how much what does not change may differ
_KEPT = 16          # transforms of a link before the last pose
_NAMED = 12         # frames that a message lists


def static_topic(topic: str) -> str:
    """Return the topic beside one of transforms that has those that do not change."""
    return f'{topic}_static'


class _Link:
    """
    The transforms of a frame in the one above it, its parent, in the order in which they came.

    fixed: whether they do not change; doubtful: whether they are said to, and not to; stamps (0
    without one) and received, ns; values: COLUMNS of each; heard: how many came, those that were
    forgotten, too; left: how many live ones came to nothing, by the name that Counts has for why.
    """

    def __init__(self, parent: str):
        self.parent = parent
        self.fixed = self.doubtful = False
        self.heard = 0
        self.left: Counter[str] = Counter()
        self.stamps, self.received, self.values = array('q'), array('q'), array('d')

    def add(self, stamp: int, received: int, values: Sequence[float]) -> None:
        """Take the next transform."""
        self.heard += 1
        self.stamps.append(stamp)
        self.received.append(received)
        self.values.extend(values)

    def differs(self, values: Sequence[float]) -> bool:
        """Return whether values are others than the last ones."""
        return any(abs(new - old) > SAME for new, old
                   in zip(values, self.values[-len(COLUMNS):], strict=False))

    def forget(self, count: int) -> None:
        """Forget the first transforms."""
        if count > 0:
            del self.stamps[:count], self.received[:count], self.values[:count * len(COLUMNS)]

    def table(self) -> np.ndarray:
        """Return the values, (n, 7)."""
        return np.array(self.values, float).reshape(-1, len(COLUMNS))


class Transforms:
    """
    The transforms of a tree of frames, and the poses of one frame in the root of the tree.

    The frame is the one that is named, or that of the vehicle where one alone moves or has a usual
    name (BODIES). Poses come at the stamps of its own transforms, or at those of a link above it
    of which FASTER times as many come; the other links are interpolated there as streams are, and
    a pose is nan where one of them has no transforms around it.
    Args: where: file and topic, for messages; topic; child: the child_frame_id, or ''.
    """

    def __init__(self, where: str, topic: str, child: str = ''):
        self._where, self._topic, self._child = where, topic, child
        self._links: dict[str, _Link] = {}
        self._chain: tuple[str, ...] = ()   # of a live one that is whole
        self._base = ''
        self._last = -1                     # stamp of the last pose that was given out live
        self._told: Counter[str] = Counter()    # what left_out has returned

    def add(self, child: str, parent: str, stamp: int, received: int, values: Sequence[float],
            fixed: bool = False) -> None:
        """
        Take a transform: its frames, stamp (0 if it has none) and time of receipt in ns.

        Args: values (7,): position and quaternion, COLUMNS; fixed: whether it does not change.
        Raises InputError where its frame was in another before.
        """
        child, parent = child.strip('/'), parent.strip('/')
        if child == parent:     # which says nothing
            return
        link = self._links.setdefault(child, _Link(parent))
        if link.parent != parent:
            raise InputError(f'{self._where}: the frame {child!r} is in {parent!r} and in '
                             f'{link.parent!r}; publish its transform in one of them')
        if not link.heard:
            link.fixed = fixed
        elif link.fixed != fixed:
            link.doubtful = link.doubtful or link.differs(values)
            return
        if link.fixed:
            link.forget(len(link.stamps))
        link.add(stamp, received, values)

    def add_live(self, child: str, parent: str, stamp: int, received: int,
                 values: Sequence[float], fixed: bool = False) -> None:
        """
        Take a transform as add; what is late, or from before a clock began anew, is left.

        What is left is counted, see left_out.
        """
        child, stamp = child.strip('/'), stamp or received
        link = self._links.get(child)
        if self._chain and (link is None or child not in self._chain):
            return
        if link is not None and not link.fixed and not fixed and len(link.stamps):
            if stamp < link.stamps[-1] - RESTART_NS:
                self._restart(stamp)
            elif stamp <= link.stamps[-1]:
                link.left['duplicated' if stamp == link.stamps[-1] else 'out_of_order'] += 1
                return
            self._give_up(link, len(link.stamps) - MOST)
        self.add(child, parent, stamp, received, values, fixed)

    def chain(self) -> tuple[str, ...]:
        """Return the frames from the root to that of the vehicle, () if there is none."""
        name = self._frame()
        found: list[str] = []
        while name in self._links:
            if name in found:
                raise InputError(f'{self._where}: the transforms of {", ".join(found[:_NAMED])} '
                                 'lead back to themselves; publish a tree')
            found.append(name)
            name = self._links[name].parent
        return (name, *reversed(found)) if found else ()

    def in_words(self) -> str:
        """Return what the poses are, for a note, '' where nothing else could be."""
        chain = self._chain or self.chain()
        if len(chain) > 2:
            return f'topic {self._topic}: the pose is composed of {" -> ".join(chain)}'
        if chain and not self._child and len(self._links) > 1:
            return f'topic {self._topic}: the pose is that of {chain[-1]} in {chain[0]}'
        return ''

    def poses(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """
        Return stamps (n,), times of receipt (n,) and COLUMNS (n, 7) of the pose at all transforms.

        The stamps are 0 where a transform of the chain has none: all are joined by their receipt.
        A pose has a quaternion of zeros where one of its transforms has none of length 1. Raises
        InputError.
        """
        links = self._of(self.chain())
        if not links:
            return np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, len(COLUMNS)))
        stamped = all(min(link.stamps) > 0 for link in links if not link.fixed)
        base = links[_base(links)]
        received = np.array(base.received, np.int64)
        stamps = np.array(base.stamps, np.int64) if stamped else np.zeros_like(received)
        table = _composed(links, base, np.arange(len(received)), stamped)
        if len(links) > 1 and not np.isfinite(table[:, 3:]).all(axis=1).any():
            raise InputError(f'{self._where}: the transforms of {" -> ".join(self.chain())} are '
                             'never there together; record them together, and those that do not '
                             f'change on {static_topic(self._topic)}')
        return stamps, received, table

    def ready(self) -> list[tuple[int, int, tuple[float, ...]]]:
        """
        Return [(stamp, time of receipt, pose)] that live transforms complete, and forget them.

        The chain is that of the first SETTLED: a frame above it that comes later is not followed.
        Raises InputError as chain.
        """
        if not self._chain:
            links = self._of(self.chain())
            own = links[-1].stamps if links else array('q')
            if len(own) < 2 or own[-1] - own[0] < SETTLED:
                return []
            self._chain = self.chain()
            self._base = self._chain[1:][_base(links)]
        links, base = self._of(self._chain), self._links[self._base]
        ends = [link.stamps[-1] if len(link.stamps) else -1 for link in links
                if link is not base and not link.fixed]
        stamps = np.array(base.stamps, np.int64)
        now = np.flatnonzero((stamps > self._last) & (stamps <= min(ends, default=2 ** 63 - 1)))
        if not len(now):
            return []
        table = _composed(links, base, now, True)
        found = [(base.stamps[k], base.received[k], tuple(row))
                 for k, row in zip(now.tolist(), table.tolist(), strict=True)]
        self._last = found[-1][0]
        for link in links:
            if not link.fixed:      # some stay, to find how far apart they are
                link.forget(int(np.searchsorted(link.stamps, self._last, 'right')) - _KEPT)
        return found

    def left_out(self, end: bool = False) -> Counter[str]:
        """
        Return how many live transforms of the chain came to nothing since the last call.

        By the names of joiner.Counts; dropped are those whose pose waited for other transforms.
        Args: end: whether none is to come, so that what waits is dropped.
        """
        try:
            links = self._of(self._chain or self.chain())
        except InputError:      # it is said where they are read
            return Counter()
        if not links or not (self._chain or end):
            return Counter()
        base = self._links[self._base] if self._base else links[_base(links)]
        if end:
            self._give_up(base, len(base.stamps))
        found: Counter[str] = Counter()
        for link in links:
            found.update({why: count for why, count in link.left.items()
                          if link is base or why != 'dropped'})
        new = found - self._told
        self._told = found
        return new

    def _give_up(self, link: _Link, count: int) -> None:
        """Forget the first transforms of a link; those of which no pose was made are dropped."""
        if count > 0:
            link.left['dropped'] += max(count - bisect_right(link.stamps, self._last), 0)
            link.forget(count)

    def _frame(self) -> str:
        """Return the frame of the vehicle, '' where there is none; InputError for several."""
        if self._child:
            return self._child
        moving = sorted(name for name, link in self._links.items()
                        if not link.fixed or link.doubtful)
        bodies = [name for name in moving if name.rpartition('/')[2] in BODIES]
        if len(moving) > 1 and len(bodies) != 1:
            raise InputError(
                f'{self._where}: holds transforms of several frames ({", ".join(moving[:_NAMED])})'
                f'; name that of the vehicle: pose: {{topic: {self._topic}, child: FRAME}}')
        return next(iter(bodies if len(bodies) == 1 else moving), '')

    def _of(self, chain: Sequence[str]) -> list[_Link]:
        for name in chain[1:]:
            if self._links[name].doubtful:
                fixed = static_topic(self._topic)
                raise InputError(f'{self._where}: the frame {name!r} is on {fixed}, so that it '
                                 f'should not move, and elsewhere on {self._topic}; publish it on '
                                 f'one of them, or leave {fixed} out')
        return [self._links[name] for name in chain[1:]]

    def _restart(self, stamp: int) -> None:
        """Forget what is from before a clock that began anew."""
        for link in self._links.values():
            if not link.fixed and len(link.stamps) and link.stamps[-1] > stamp + RESTART_NS:
                self._give_up(link, len(link.stamps))
        self._last = min(self._last, stamp - 1)


def _base(links: Sequence[_Link]) -> int:
    """Return which link sets the stamps: the last that moves, or one that comes far more often."""
    best = next((k for k in reversed(range(len(links))) if not links[k].fixed), len(links) - 1)
    for k, link in enumerate(links):
        if not link.fixed and link.heard > FASTER * links[best].heard:
            best = k
    return best


def _composed(links: Sequence[_Link], base: _Link, which: np.ndarray, stamped: bool) -> np.ndarray:
    """Return the poses (n, 7) of the last of links, root first, at some transforms of the base."""
    if len(links) == 1:
        return base.table()[which]
    stamps = _times(base, stamped)[which]
    with np.errstate(all='ignore'):     # numbers of a damaged message, which the record refuses
        each = [base.table()[which] if link is base else _at(link, stamps, stamped)
                for link in links]
        place, attitude = each[0][:, :3], each[0][:, 3:]
        bad = not_unit(attitude)
        for table in each[1:]:
            bad |= not_unit(table[:, 3:])
            attitude = attitude / np.linalg.norm(attitude, axis=-1, keepdims=True)
            place = place + rotate(attitude, table[:, :3])
            attitude = product(attitude, table[:, 3:])
    return np.column_stack([place, np.where(bad[:, None], 0.0, attitude)])


def _times(link: _Link, stamped: bool) -> np.ndarray:
    return np.array(link.stamps if stamped else link.received, np.int64)


def _at(link: _Link, stamps: np.ndarray, stamped: bool) -> np.ndarray:
    """Return the transforms (n, 7) of a link at stamps (n,), nan where none are around them."""
    table = link.table()
    if link.fixed:
        return np.broadcast_to(table[-1], (len(stamps), len(COLUMNS)))
    own, index = np.unique(_times(link, stamped), return_index=True)
    if len(own) < 2:
        return np.full((len(stamps), len(COLUMNS)), np.nan)
    table = table[index]
    bad = not_unit(table[:, 3:])
    table[bad, 3:] = 1.0, 0.0, 0.0, 0.0
    table[:, 3:] /= np.linalg.norm(table[:, 3:], axis=-1, keepdims=True)
    stream = Stream('', own, dict(zip(COLUMNS, table.T, strict=True)))
    at, back = np.unique(stamps, return_inverse=True)
    columns = at_stamps(stream, at, own[0])
    found = np.stack([columns[name] for name in COLUMNS], axis=-1)
    found[np.interp(at - own[0], own - own[0], bad) > 0.0, 3:] = 0.0
    found[~covered(stream, at)] = np.nan
    return found[back]
