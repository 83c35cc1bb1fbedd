# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams of numbers compared: how alike they are, and how much larger one is."""

import numpy as np

from quad_ident_ros.model.attitude import conjugate, product

FEWEST = 10             # samples that a correlation takes
UNIT, MOSTLY = 0.02, 0.95   # off the length 1, as of rounded ones; and the share that are so
RELATED = 0.5           # correlation from which on a ratio of two streams says something


def filled(values: np.ndarray, stamps: np.ndarray | None = None) -> np.ndarray:
    """
    Return values (N,) without gaps, those before the first and after the last left out.

    They are interpolated over stamps (N,) that never fall, in any unit, else over the rows: those
    of several streams may come in bursts, in which hardly any time passes.
    """
    known = np.isfinite(values)
    if known.all() or known.sum() < 2:
        return values
    at = np.arange(len(values), dtype=float)
    if stamps is not None and (np.diff(stamps) >= 0.0).all() and np.isfinite(stamps).all():
        at = stamps
    return np.interp(at, at[known], values[known], left=np.nan, right=np.nan)


def alike(one: np.ndarray, other: np.ndarray) -> float:
    """Return the correlation of two streams (N, 3), all axes together."""
    use = np.isfinite(one).all(axis=1) & np.isfinite(other).all(axis=1)
    if use.sum() < FEWEST:
        return 0.0
    a, b = one[use] - one[use].mean(axis=0), other[use] - other[use].mean(axis=0)
    norm = np.linalg.norm(a) * np.linalg.norm(b)
    return float(np.sum(a * b) / norm) if norm > 0 else 0.0


def ratio_of(one: np.ndarray, other: np.ndarray) -> float | None:
    """Return how much larger one stream (N, 3) is than another, or None where they differ."""
    use = np.isfinite(one).all(axis=1) & np.isfinite(other).all(axis=1)
    if use.sum() < FEWEST or abs(alike(one, other)) < RELATED:
        return None
    return float(np.std(one[use]) / max(np.std(other[use]), 1e-12))


def is_unit(q: np.ndarray) -> bool:
    """Return whether quaternions (N, 4) have the length 1, but for rows of zeros: no tracking."""
    norm = np.linalg.norm(q, axis=-1)
    norm = norm[np.isfinite(norm) & (norm > 0.0)]
    return len(norm) > 1 and bool(np.mean(np.abs(norm - 1.0) < UNIT) > MOSTLY)


def unit_length(q: np.ndarray) -> np.ndarray:
    """Return quaternions (N, 4) at the length 1."""
    with np.errstate(all='ignore'):
        return q / np.linalg.norm(q, axis=-1, keepdims=True)


def turned(q: np.ndarray, later: np.ndarray) -> np.ndarray:
    """Return the turns (N, 3) rad in the body from attitudes to later ones."""
    turn = product(conjugate(q), later)
    turn = turn * np.where(turn[:, :1] < 0, -1.0, 1.0)
    return 2.0 * turn[:, 1:]
