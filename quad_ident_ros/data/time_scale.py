# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
How many seconds pass in one of a time, by what the streams of a motion say of each other.

Positions change by velocities, velocities by forces and attitudes by rates, each times the time.
A time in minutes, or one that counts samples, makes all of these disagree by one factor, as no
unit of the other columns does.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.attitude import conjugate, product, rotate

SURE = 0.9          # correlation from which on two streams tell the time between them
ALIKE = 1.25        # all streams tell one time within this factor: of real flights, within 1.1
OFF = 1.5           # a time is wrong from this factor on, as a scale of rates or velocities is
UNIT = 1.1          # of a unit, within which two streams alone show that the time is in it
UNITS = {'min': 60.0, 'h': 3600.0}
FEWEST = 16         # windows side by side that a correlation takes
MOST = 20_000       # windows that are looked at: of more, one of so many
JITTER = 3.0        # times as long or short as usual, from which on a window has a gap
TURN = 2.0          # rad in a window, beyond which rates no longer add up to turns
LEANS = 0.3         # share of up along z of the body, below which thrust need not carry the weight


@dataclass(frozen=True)
class Clue:
    """What two streams say: their names, and how many s pass in one of the time."""

    streams: str
    scale: float


@dataclass(frozen=True, eq=False)
class Motion:
    """
    The streams of a motion, each (N, k) or None, in SI units and any axes.

    t (N,); place and speed in the world (speed may be in the body), attitude body to world, rate
    and force in the body.
    """

    t: np.ndarray
    place: np.ndarray | None = None
    speed: np.ndarray | None = None
    attitude: np.ndarray | None = None
    rate: np.ndarray | None = None
    force: np.ndarray | None = None


def clues(motion: Motion) -> list[Clue]:
    """Return the Clues of a Motion; of streams that do not follow each other there is none."""
    t, found = motion.t, []
    if len(t) < 4 * FEWEST:
        return []
    place, speed = motion.place, motion.speed
    attitude = motion.attitude
    with np.errstate(all='ignore'):
        if place is not None and speed is not None:
            readings = [speed] if attitude is None else [speed, rotate(attitude, speed)]
            found.append(_told('position and velocity', t, 1,
                               [(place, _summed(t, one)) for one in readings]))
        if attitude is not None and motion.rate is not None:
            found.append(_turned(t, attitude, motion.rate))
        if attitude is not None and (speed is not None or place is not None):
            pushed = _accelerations(attitude, motion.force)
            what = 'attitude' if motion.force is None else 'specific force'
            if speed is not None:
                found.append(_told(f'velocity and {what}', t, 1, [
                    (speed[:, :one.shape[1]], _summed(t, one)) for one in pushed]))
            elif place is not None:
                found.append(_told(f'position and {what}', t, 2, [
                    (place[:, :one.shape[1]], _summed(t, _summed(t, one))) for one in pushed]))
    return [one for one in found if one is not None]


def scale_of(said: Sequence[Clue]) -> float | None:
    """
    Return how many s pass in one of a time by Clues, None where they are none or disagree.

    One Clue alone may be of a wrong scale of its streams: it counts where it is 1 or one of UNITS.
    """
    if not said:
        return None
    scale = float(np.exp(np.mean([np.log(one.scale) for one in said])))
    if any(not scale / ALIKE < one.scale < scale * ALIKE for one in said):
        return None
    if len(said) == 1 and unit_of(scale) is None and is_wrong(scale):
        return None
    return scale


def is_wrong(scale: float) -> bool:
    """Return whether a time is not in s, by how many s pass in one of it."""
    return not 1.0 / OFF < scale < OFF


def unit_of(scale: float) -> str | None:
    """Return the unit of a time of which one is so many s, or None."""
    return next((unit for unit, seconds in UNITS.items()
                 if seconds / UNIT < scale < seconds * UNIT), None)


def _summed(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the integral of values (N, k) over the time, (N, k)."""
    step = np.diff(t)[:, None]
    return np.vstack([np.zeros(values.shape[1]),
                      np.cumsum(np.nan_to_num(0.5 * (values[1:] + values[:-1]) * step), axis=0)])


def _accelerations(q: np.ndarray, force: np.ndarray | None) -> list[np.ndarray]:
    """
    Return the accelerations in the world, (N, k), with up along z and against it.

    Without a specific force they are those along the horizon of a thrust that carries the weight.
    """
    if force is not None:
        turned = rotate(q, force)
        return [turned + [0.0, 0.0, weight] for weight in (-GRAVITY, GRAVITY)]
    up = rotate(q, np.array([0.0, 0.0, 1.0]))
    share = np.where(np.abs(up[:, 2:]) > LEANS, up[:, 2:], np.nan)
    return [GRAVITY * up[:, :2] / share]


def _windows(t: np.ndarray, values: np.ndarray, order: int) -> list[tuple[np.ndarray, int]]:
    """
    Return where windows begin, and how many samples they have, from short to long ones.

    Windows of order times that many samples that have a gap, or no value, are left out.
    """
    steps = np.diff(t)
    usual = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    lost = np.concatenate([[0], np.cumsum(~np.isfinite(values).all(axis=1))])
    far = np.concatenate([[0], np.cumsum(~(np.abs(steps) < JITTER * max(usual, 1e-300)))])
    found, width = [], 1
    while order * width * FEWEST < len(t):
        whole = order * width
        begin = np.arange(0, len(t) - whole, max(1, len(t) // MOST))
        span = t[begin + whole] - t[begin]
        good = ((lost[begin + whole + 1] == lost[begin]) & (span > whole * usual / JITTER)
                & (span < whole * usual * JITTER))
        if width < JITTER:      # stamps that come in pairs are no gaps in longer windows
            good &= far[begin + whole] == far[begin]
        found.append((begin[good], width))
        width *= 2
    return found


def _told(streams: str, t: np.ndarray, order: int,
          pairs: Sequence[tuple[np.ndarray, np.ndarray]]) -> Clue | None:
    """
    Return the Clue of the best of pairs of signals (N, k), of which one should be the other.

    They are compared by their differences over windows, of the order: what is off by a constant,
    or a slope, then does not count.
    """
    best = SURE, 0.0
    for one, other in pairs:
        for begin, width in _windows(t, np.hstack([one, other]), order):
            changes = []
            for values in (one, other):
                change = _rows(values, begin + width) - _rows(values, begin)
                if order > 1:
                    change = (_rows(values, begin + 2 * width) - _rows(values, begin + width)
                              - change)
                changes.append(change)
            best = max(best, _likeness(*changes))
    return Clue(streams, best[1] ** (1.0 / order)) if best[1] > 0 else None


def _turned(t: np.ndarray, q: np.ndarray, rate: np.ndarray) -> Clue | None:
    """Return the Clue of attitudes (N, 4) and rates (N, 3)."""
    sums, best = _summed(t, rate), (SURE, 0.0)
    for begin, width in _windows(t, np.hstack([q, rate]), 1):
        turn = product(conjugate(_rows(q, begin)), _rows(q, begin + width))
        turn = turn * np.where(turn[:, :1] < 0.0, -1.0, 1.0)
        length = np.linalg.norm(turn[:, 1:], axis=1, keepdims=True)
        angle = 2.0 * np.arctan2(length, turn[:, :1])
        turn = turn[:, 1:] * np.where(length > 1e-12, angle / length, 2.0)
        small = angle[:, 0] < TURN
        change = _rows(sums, begin + width) - _rows(sums, begin)
        best = max(best, _likeness(turn[small], change[small]))
    return Clue('attitude and rate', best[1]) if best[1] > 0 else None


def _rows(values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return rows (n, k) of values (N, k), in a third of the time that indices take."""
    return values.take(places, axis=0)


def _likeness(one: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Return the correlation of signals (n, k) about their means, and how much larger one is."""
    if len(one) < FEWEST:
        return 0.0, 0.0
    one, other = one - one.mean(axis=0), other - other.mean(axis=0)
    sizes = np.sqrt(np.sum(one ** 2)), np.sqrt(np.sum(other ** 2))
    if not (sizes[0] > 0.0 and sizes[1] > 0.0):
        return 0.0, 0.0
    likeness = abs(float(np.sum(one * other))) / (sizes[0] * sizes[1])
    return float(likeness), float(sizes[0] / sizes[1])
