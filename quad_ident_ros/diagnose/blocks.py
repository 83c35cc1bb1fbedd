# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One flight as two: blocks of time to learn from, and blocks that are held out."""

from dataclasses import replace

import numpy as np

from quad_ident_ros.greybox.flights import inertial, Track


def interleaved(track: Track, length: float) -> tuple[Track, Track]:
    """
    Return a Track with the blocks of a flight to learn from, and one with those held out.

    Of each two blocks that follow one another one is held out, whichever keeps the motion of both
    parts alike: of two halves one may only hover. The rows of the other part exist, unseen.
    Args: length s of a block, about.
    """
    # Time flown: between the parts of a flight there is nothing to hold out.
    steps = np.diff(track.course.t)
    t = np.append(0.0, np.cumsum(np.where(steps > length, track.period, steps)))
    pairs = max(1, round((t[-1] - t[0]) / (2.0 * length)))
    edges = np.linspace(t[0], t[-1], 2 * pairs + 1)
    block = np.searchsorted(edges[1:-1], t, side='right')
    held = np.isin(block, _held_out(_motion(track, block, 2 * pairs)))
    each = (t[-1] - t[0]) / (2 * pairs)
    named = {False: f'{track.name} (half of its blocks of {each:.2g} s)',
             True: f'{track.name} (the other half of its blocks of {each:.2g} s)'}
    learnt, rest = (replace(track, name=named[part], seen=track.seen & (held == part)[:, None])
                    for part in (False, True))
    return learnt, rest


def spans_seen(track: Track, length: float) -> list[tuple[float, float]]:
    """
    Return the first and last time (s) of each stretch that belongs to a part of a Track.

    Rows of the other part, or a break that is longer than a block, are between stretches.
    Args: length s of a block.
    """
    t, rows = track.course.t, np.flatnonzero(track.seen.any(axis=1))
    apart = np.flatnonzero((np.diff(rows) > 1) | (np.diff(t[rows]) > length)) + 1
    return [(float(t[part[0]]), float(t[part[-1]])) for part in np.split(rows, apart)]


def _motion(track: Track, block: np.ndarray, count: int) -> np.ndarray:
    """Return how much of the squared velocities, rates and changes of command blocks have."""
    commands = np.interp(track.course.t, track.course.stamps,
                         np.linalg.norm(track.course.commands, axis=1))
    signals = np.column_stack([track.states[:, 3:6], track.states[:, 10:13],
                               commands - commands.mean()]) ** 2
    if inertial([track]):   # reckoned velocities drift
        signals = signals[:, 3:]
    sums = np.stack([np.bincount(block, column, minlength=count) for column in signals.T], axis=1)
    return sums / np.maximum(sums.sum(axis=0), 1e-300)


def _held_out(motion: np.ndarray) -> list[int]:
    """Return the numbers of the blocks held out, one of each two, by their motion (K, 7)."""
    ahead, chosen = np.zeros(motion.shape[1]), []
    for first in range(0, len(motion), 2):
        change = motion[first] - motion[first + 1]
        later = bool(np.linalg.norm(ahead + change) <= np.linalg.norm(ahead - change))
        ahead = ahead + change if later else ahead - change
        chosen.append(first + 1 if later else first)
    return chosen
