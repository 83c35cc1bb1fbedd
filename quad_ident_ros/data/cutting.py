# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What to type to leave samples of a flight out."""

from collections.abc import Sequence
import math

import numpy as np

SHORTEST = 4.0      # s: with less there is no diagnosis, so that a cut is no way out

MOST_RUNS = 8       # of lines, that a message names


def deletion(lines: Sequence[int], count: int) -> str:
    """
    Return the advice to delete lines of a text file; '' where those are too many.

    Args: lines: numbers from 1, rising, at least one; count: lines of samples in the file.
    """
    numbers = np.asarray(lines)
    runs = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    if 2 * len(numbers) > count or len(runs) > MOST_RUNS:
        return ''
    named = [f'{run[0]}' if len(run) == 1 else f'{run[0]} to {run[-1]}' for run in runs]
    shown = ' and '.join(filter(None, [', '.join(named[:-1]), named[-1]]))
    return f'delete line{"s" * (len(numbers) > 1)} {shown}'


def without(t: np.ndarray, bad: np.ndarray, *others: str) -> str:
    """
    Return the advice to leave bad samples out, or else to do one of others.

    Args: t (N,) s; bad (N,) bool; others: what else mends them, at least one. The options keep the
    longest stretch without them; where none is as long as SHORTEST, only the others are named.
    """
    typed = keeping(t, ~np.asarray(bad))
    ways = ([f'leave them out: {typed}'] if typed else []) + list(others)
    return ', or '.join(filter(None, [', '.join(ways[:-1]), ways[-1]]))


def keeping(t: np.ndarray, good: np.ndarray) -> str:
    """Return the options that keep the longest stretch of good samples (N,); '' for none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(good, int), [0]])))
    runs = [(int(first), int(end) - 1) for first, end in
            zip(edges[::2], edges[1::2], strict=True)]
    if not runs:
        return ''
    first, last = max(runs, key=lambda run: t[run[1]] - t[run[0]])
    return '' if t[last] - t[first] < SHORTEST else options(t, first, last)


def options(t: np.ndarray, first: int, last: int) -> str:
    """Return the options that keep samples first to last of times t (N,) s, to the ms inside."""
    begin, end = math.ceil(1e3 * t[first] - 1e-3), math.floor(1e3 * t[last] + 1e-3)
    return ' '.join(([f'--from {_shown(begin)}'] if first > 0 else [])
                    + ([f'--to {_shown(end)}'] if last < len(t) - 1 else []))


def _shown(ms: int) -> str:
    return f'{ms / 1e3:.3f}'.rstrip('0').rstrip('.')
