# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Delay and lag between the commanded and the actual speed of the rotors.

A lag that is the same up and down is a part of the integration; the speeds of any other form are
followed here, exactly, and given to the integration as they are.
"""

from typing import NamedTuple

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import EFFECTS, PLACE, PLACES, SLICES

DELAY, LAG = SLICES['actuation_delay'].start, SLICES['motor_lag'].start
RISE, FALL, SLEW, MEAN_LAG, INNER_LAG = (
    PLACE['motor_lag', name] for name in ('rise', 'fall', 'slew', 'mean_lag', 'inner_lag'))
FOLLOWED = [RISE, FALL, SLEW, MEAN_LAG]
LAW = [PLACES['motor_lag', form.name].start + k for form in EFFECTS['motor_lag'].forms
       for k in range(len(form.parameters))]
CLOSE = 1e-9    # of a step, within which a command changes at a sample
PIECES = 8      # of a mean lag, over each of which a response of the second order is its mean
MOST_PIECES = 64
NO_LAG = 1e-9   # s, below which there is no mean lag, and of the torque in place of none


class Actuation(NamedTuple):
    """
    What rotors do along a flight by A laws, rad/s.

    followed (A, N, n): what their speeds tend to from each sample to the next, so that those at
    the next one are right; speeds (A, N, n) at each sample; added (A, N, 3, n) to the speeds at
    the begin, the middle and the end of a step, see actuated; law (T,) of each parameter set.
    """

    followed: np.ndarray
    speeds: np.ndarray
    added: np.ndarray
    law: np.ndarray


def actuated(t: np.ndarray, stamps: np.ndarray, commands: np.ndarray, thetas: np.ndarray
             ) -> Actuation:
    """
    Return the Actuation at times t (N,) s of commands (M, n) rad/s, each held to the next.

    Args: stamps (M,) s of the commands; thetas (T, P) parameter sets, whose delay is negative
    where the clock of the commands is late. Before the first command that one is held, after the
    last one the last; the rotors begin at what acts on them at t[0]. Where the command that acts
    changes within a step, `added` makes the thrust's mean over the step, and where in the step it
    lies, those of the true speeds: a mean command would smooth what it drives.
    """
    laws = np.column_stack([thetas[:, DELAY], *law_of(thetas), thetas[:, FOLLOWED].any(axis=1)])
    first, law = distinct(laws)
    shape = (len(first), len(t), commands.shape[1])
    acted = Actuation(np.empty(shape), np.empty(shape), np.zeros((*shape[:2], 3, shape[2])), law)
    for k, (*times, by_law) in enumerate(laws[first]):
        if by_law:
            _act_by_law(t, stamps, commands, *times, *(part[k] for part in acted[:3]))
        else:
            _act(t, stamps, commands, *times[:2], *(part[k] for part in acted[:3]))
    return acted


def distinct(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where rows (T, K) that differ first stand, (D,), and which of them each is, (T,)."""
    known: dict[bytes, int] = {}
    which = np.array([known.setdefault(row.tobytes(), len(known)) for row in rows], np.int64)
    return np.unique(which, return_index=True)[1], which


def law_of(thetas: np.ndarray) -> tuple[np.ndarray, ...]:
    """
    Return what parameter sets (..., P) say of the motors, each (...).

    Lags up and down, s, one over the fastest change of speed, and mean and inner lag, s, of a
    response of the second order, which the others follow.
    """
    lag = thetas[..., LAG]
    return (lag + thetas[..., RISE], lag + thetas[..., FALL], thetas[..., SLEW],
            thetas[..., MEAN_LAG], thetas[..., INNER_LAG])


@compiled
def is_followed(theta: np.ndarray) -> bool:
    """Return whether the speeds by a parameter set (P,) are followed here: see actuated."""
    return (theta[RISE] > 0.0 or theta[FALL] > 0.0 or theta[SLEW] > 0.0
            or theta[MEAN_LAG] > 0.0)


def without_lag(thetas: np.ndarray) -> np.ndarray:
    """Return parameter sets (T, P), those without the lag whose speeds are followed here."""
    thetas = np.array(thetas, float)
    thetas[thetas[:, FOLLOWED].any(axis=1), LAG] = 0.0
    return thetas


def accelerations(t: np.ndarray, acted: Actuation, thetas: np.ndarray) -> np.ndarray:
    """
    Return those of the rotors at times t (N,) s of an Actuation, (T, N, n) rad/s^2.

    Where they are no part of the integration, the mean over the step that begins there.
    """
    lags = without_lag(thetas)[:, LAG]
    before = np.concatenate([acted.speeds[:, :1], acted.followed[:, :-1]], axis=1)
    steps = np.append(np.diff(t), t[-1] - t[-2])[:, None]
    return np.array([(acted.followed[k] - acted.speeds[k]) / lag if lag > 0.0
                     else (acted.followed[k] - before[k]) / steps
                     for k, lag in zip(acted.law, lags, strict=True)])


@compiled(fused=True, inlined=True)
def shares(step: float, lag: float) -> tuple[float, float, float]:
    """
    Return the share of a gap to the command at begin, middle and end of a step s, lag s.

    That at the begin is 1 but for terms of fourth order, so that the mean over the step, as the
    integration weighs it, is that of the exponential however short the lag is beside the step.
    """
    if lag > 0.0:
        half = np.exp(-0.5 * step / lag)
        full = half * half
        return 6.0 * (1.0 - full) * lag / step - 4.0 * half - full, half, full
    return 0.0, 0.0, 0.0


@compiled(fused=True)
def _act(t: np.ndarray, stamps: np.ndarray, commands: np.ndarray, delay: float, lag: float,
         followed: np.ndarray, speeds: np.ndarray, added: np.ndarray) -> None:
    """Write the Actuation of one delay and lag, s."""
    count, last, n = len(t), len(stamps), commands.shape[1]
    sums, same, now = np.empty((3, n)), np.empty((3, n)), np.empty(n)
    at = 0
    for k in range(count):
        step = t[k + 1] - t[k] if k + 1 < count else t[k] - t[k - 1]
        close = CLOSE * step
        while at + 1 < last and stamps[at + 1] + delay <= t[k] + close:
            at += 1
        # Of rows no views are made: to count these would take longer than all else.
        for j in range(n):
            if k == 0 or lag == 0.0:
                speeds[k, j] = commands[at, j]
            followed[k, j] = commands[at, j]
        if k + 1 == count:
            break
        for j in range(n):
            now[j] = speeds[k, j]
            sums[0, j] = sums[1, j] = sums[2, j] = 0.0
        done, first = 0.0, at
        while at + 1 < last and stamps[at + 1] + delay < t[k + 1] - close:
            length = stamps[at + 1] + delay - t[k] - done
            _advance(now, commands, at, length, step - done, lag, sums)
            done += length
            at += 1
        if lag > 0.0 or at > first:
            _advance(now, commands, at, step - done, step - done, lag, sums)
        for j in range(n):
            speeds[k + 1, j] = now[j]
        if at > first:
            begin, half, full = shares(step, lag)
            for j in range(n):
                followed[k, j] = (now[j] - speeds[k, j] * full) / (1.0 - full)
                now[j] = speeds[k, j]
                same[0, j] = same[1, j] = same[2, j] = 0.0
            _advance(now, followed, k, step, step, lag, same)
            for j in range(n):
                mean = (sums[0, j] - same[0, j]) / step
                once = (sums[1, j] - same[1, j]) / step ** 2
                twice = (sums[2, j] - same[2, j]) / step ** 3
                gap = speeds[k, j] - followed[k, j]
                early, middle = followed[k, j] + gap * begin, followed[k, j] + gap * half
                # Of squares the integration weighs 1 4 1 for the mean, which it integrates once,
                # 1 2 0 for what it integrates twice, and 1 1 0 for what it does three times.
                at_begin = early ** 2 + 12.0 * twice - 6.0 * once
                at_middle = middle ** 2 + 6.0 * (once - twice)
                at_end = now[j] ** 2 + 6.0 * (mean + 2.0 * twice - 3.0 * once)
                if min(at_begin, at_middle, at_end) < 0.0:  # no speeds do that: the mean at least
                    at_begin = at_middle = at_end = sums[0, j] / step
                added[k, 0, j] = np.sqrt(at_begin) - early
                added[k, 1, j] = np.sqrt(at_middle) - middle
                added[k, 2, j] = np.sqrt(at_end) - now[j]


@compiled(fused=True, inlined=True)
def _advance(speed: np.ndarray, commands: np.ndarray, row: int, length: float, left: float,
             lag: float, sums: np.ndarray) -> None:
    """
    Advance speeds (n,) to a row of commands (M, n) by length s, `left` s before a step ends.

    Adds the integrals of their squares times what remains of the step, to the power of 0, 1 and
    2, to sums (3, n).
    """
    gone = np.exp(-length / lag) if lag > 0.0 else 0.0
    one = lag * (1.0 - gone)                    # integrals of the exponential, of its square,
    two = 0.5 * lag * (1.0 - gone * gone)
    late_one = lag * (one - length * gone)      # of these times what has passed, and its square
    late_two = 0.5 * lag * (two - length * gone * gone)
    last_one = lag * (2.0 * late_one - length ** 2 * gone)
    last_two = 0.5 * lag * (2.0 * late_two - length ** 2 * gone * gone)
    for j in range(len(speed)):
        target, gap = commands[row, j], speed[j] - commands[row, j]
        still, mixed, moving = target * target, 2.0 * target * gap, gap * gap
        area = still * length + mixed * one + moving * two
        late = still * length ** 2 / 2.0 + mixed * late_one + moving * late_two
        last = still * length ** 3 / 3.0 + mixed * last_one + moving * last_two
        sums[0, j] += area
        sums[1, j] += left * area - late
        sums[2, j] += left * left * area - 2.0 * left * late + last
        speed[j] = target + gap * gone


@compiled(fused=True)
def _act_by_law(t: np.ndarray, stamps: np.ndarray, commands: np.ndarray, delay: float, up: float,
                down: float, slew: float, mean_lag: float, inner_lag: float, followed: np.ndarray,
                speeds: np.ndarray, added: np.ndarray) -> None:
    """Write the Actuation of one delay and any law: see law_of."""
    count, last, n = len(t), len(stamps), commands.shape[1]
    sums, inner = np.empty((3, n)), np.zeros((2, n))
    at = 0
    for k in range(count):
        step = t[k + 1] - t[k] if k + 1 < count else t[k] - t[k - 1]
        close = CLOSE * step
        while at + 1 < last and stamps[at + 1] + delay <= t[k] + close:
            at += 1
        if k == 0:
            speeds[k] = inner[0] = commands[at]
        followed[k] = speeds[k]
        if k + 1 == count:
            break
        done = 0.0
        sums[:] = 0.0
        while at + 1 < last and stamps[at + 1] + delay < t[k + 1] - close:
            length = stamps[at + 1] + delay - t[k] - done
            _follow(followed[k], inner, commands[at], length, step - done, up, down, slew,
                    mean_lag, inner_lag, sums)
            done += length
            at += 1
        _follow(followed[k], inner, commands[at], step - done, step - done, up, down, slew,
                mean_lag, inner_lag, sums)
        _match(sums, step, followed[k], added[k])
        speeds[k + 1] = followed[k]


@compiled
def follow(speed: np.ndarray, inner: np.ndarray, command: np.ndarray, step: float, up: float,
           down: float, slew: float, mean_lag: float, inner_lag: float, added: np.ndarray) -> None:
    """
    Advance speeds (n,) by a step s towards commands (n,), by any law: see law_of.

    inner (2, n): speeds and their rates of change, of a response of the second order alone; it
    begins at the speeds and at 0. Writes into added (3, n) what is to be added to the speeds at
    the end to have those at the begin, the middle and the end of the step as its integration takes
    them.
    """
    sums = np.zeros((3, len(speed)))
    _follow(speed, inner, command, step, step, up, down, slew, mean_lag, inner_lag, sums)
    _match(sums, step, speed, added)


@compiled(fused=True)
def _follow(speed: np.ndarray, inner: np.ndarray, command: np.ndarray, length: float, left: float,
            up: float, down: float, slew: float, mean_lag: float, inner_lag: float,
            sums: np.ndarray) -> None:
    """
    Advance speeds (n,) as _advance does, by all of a law: see law_of.

    A response of the second order is exact at the end of each of its pieces, and stands still at
    its mean in it for what follows: lags, and the integrals.
    """
    if mean_lag < NO_LAG:
        _follow_lags(speed, command, length, left, up, down, slew, sums)
        return
    pieces = min(max(int(np.ceil(PIECES * length / mean_lag)), 1), MOST_PIECES)
    piece = length / pieces
    inner_lag = max(inner_lag, NO_LAG)
    fade, stiffness = 0.5 / inner_lag, 1.0 / (mean_lag * inner_lag)
    turn = np.sqrt(abs(stiffness - fade * fade))
    if turn * piece < 1e-6:
        even, odd = np.exp(-fade * piece), piece * np.exp(-fade * piece)
    elif stiffness > fade * fade:
        even = np.exp(-fade * piece) * np.cos(turn * piece)
        odd = np.exp(-fade * piece) * np.sin(turn * piece) / turn
    else:
        slow = np.exp(-stiffness / (fade + turn) * piece)
        quick = np.exp(-(fade + turn) * piece)
        even, odd = 0.5 * (slow + quick), 0.5 * (slow - quick) / turn
    mean = np.empty(len(speed))
    for k in range(pieces):
        for j in range(len(speed)):
            gap, change = inner[0, j] - command[j], inner[1, j]
            end = even * gap + odd * (change + fade * gap)
            inner[0, j] = command[j] + end
            inner[1, j] = even * change - odd * (fade * change + stiffness * gap)
            # The integral of the gap, by the differential equation itself.
            mean[j] = command[j] - mean_lag * (inner_lag * (inner[1, j] - change)
                                               + end - gap) / piece
        _follow_lags(speed, mean, piece, left - k * piece, up, down, slew, sums)
    if up == 0.0 and down == 0.0 and slew == 0.0:
        speed[:] = inner[0]


@compiled(fused=True, inlined=True)
def _follow_lags(speed: np.ndarray, command: np.ndarray, length: float, left: float, up: float,
                 down: float, slew: float, sums: np.ndarray) -> None:
    """Advance speeds (n,) as _advance does, by a lag up, another one down and a limited rate."""
    for j in range(len(speed)):
        gap = speed[j] - command[j]
        lag = down if gap > 0.0 else up
        # At its limit the speed changes until its lag alone is slower.
        straight = min(max(abs(gap) * slew - lag, 0.0), length)
        if straight > 0.0:
            begin = speed[j]
            still = max(abs(gap) - straight / slew, 0.0)
            speed[j] = end = command[j] + (still if gap > 0.0 else -still)
            area = straight * (begin ** 2 + begin * end + end ** 2) / 3.0
            late = straight ** 2 * (begin ** 2 + 2.0 * begin * end + 3.0 * end ** 2) / 12.0
            last = straight ** 3 * (begin ** 2 + 3.0 * begin * end + 6.0 * end ** 2) / 30.0
            sums[0, j] += area
            sums[1, j] += left * area - late
            sums[2, j] += left * left * area - 2.0 * left * late + last
        if straight < length:
            _advance(speed[j:j + 1], command[None, j:j + 1], 0, length - straight,
                     left - straight, lag, sums[:, j:j + 1])


@compiled(fused=True)
def _match(sums: np.ndarray, step: float, end: np.ndarray, added: np.ndarray) -> None:
    """Write what added to the speeds `end` (n,) has the sums (3, n) of a step s: see actuated."""
    same = np.zeros(sums.shape)
    _advance(end.copy(), end[None], 0, step, step, 0.0, same)
    for j in range(len(end)):
        square = end[j] * end[j]
        mean = (sums[0, j] - same[0, j]) / step
        once = (sums[1, j] - same[1, j]) / step ** 2
        twice = (sums[2, j] - same[2, j]) / step ** 3
        at_begin = square + 12.0 * twice - 6.0 * once
        at_middle = square + 6.0 * (once - twice)
        at_end = square + 6.0 * (mean + 2.0 * twice - 3.0 * once)
        if min(at_begin, at_middle, at_end) < 0.0:  # no speeds do that: the mean at least
            at_begin = at_middle = at_end = sums[0, j] / step
        added[0, j] = np.sqrt(at_begin) - end[j]
        added[1, j] = np.sqrt(at_middle) - end[j]
        added[2, j] = np.sqrt(at_end) - end[j]
