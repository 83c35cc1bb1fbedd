# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the vehicle and its effects that predict flights best: Gauss-Newton."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from quad_ident_ros.greybox.linear import (
    errors_along,
    linear_of,
    linearise,
    new_starts,
    STEP,
    tangent_of,
)
from quad_ident_ros.greybox.noise import MAD, quick_noise, whole_noise
from quad_ident_ros.greybox.parameters import limits

ITERATIONS = 20
DONE = 0.01         # length of a last step, in standard errors
ROUGH = 10.0        # the same where only a few rollouts are looked at
FEW = 10            # rollouts that bring a start near
NEAR = 0.3          # usual sizes; after shorter steps the slopes are kept
SHARES = tuple(0.5 ** k for k in range(7))  # of a step, tried until the cost does not rise
WEAK = 1e-7         # of the largest information: a direction that says nothing
OUTLIER = 4.0       # noise deviations beyond which a sample counts less
CHANCE = 0.01       # of white noise to be taken for noise that hangs together
BLOCK = 2.0         # s over which what is left may hang together


@dataclass(frozen=True, eq=False)
class Normal:
    """
    What flights say of the columns around a point: information (C, C), gradient (C,), cost.

    scores (K, C): the gradient of each block of time, whose scatter shows what the errors that
    hang together take from the information.
    """

    information: np.ndarray
    gradient: np.ndarray
    cost: float
    scores: np.ndarray


@dataclass(frozen=True, eq=False)
class Estimate:
    """
    A fit: the vector z (Z,), the free columns, their covariance (C, C), noise per flight (12,).

    starts: initial states per flight; normal: the Normal at the end; left: recorded minus
    predicted per flight; free: whether each column is inside its bounds; converged.
    """

    z: np.ndarray
    columns: list
    covariance: np.ndarray
    noise: list
    starts: list
    normal: Normal
    left: list
    free: np.ndarray
    converged: bool

    @property
    def errors(self):
        """Return the standard errors of the columns (C,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def normal_of(linears, flights, clock=True):
    """Return the Normal of linearised flights; with clock, each one's last column is its own."""
    information = gradient = 0.0
    cost, scores = 0.0, []
    for linear, flight in zip(linears, flights, strict=True):
        error, slope = linear.error, linear.slope
        if clock:
            own, slope = slope[..., -1], slope[..., :-1]
            size = np.sum(own * own)
            if size > 0:
                error = error - own * (np.sum(own * error) / size)
                slope = slope - own[..., None] * (np.tensordot(own, slope, 2) / size)
        across = slope.transpose(0, 2, 1)
        information = information + (across @ slope).sum(axis=0)
        each = (across @ error[..., None])[..., 0]
        gradient = gradient + each.sum(axis=0)
        cost += float(np.sum(error * error))
        scores.append(_blocks(each, flight))
    return Normal(information, gradient, cost, np.concatenate(scores))


def _blocks(each, flight):
    """Return sums over blocks of time of what there is per rollout."""
    block = (flight.course.t[flight.first] // BLOCK).astype(int)
    _, which = np.unique(block, return_inverse=True)
    sums = np.zeros((which.max() + 1, each.shape[1]))
    np.add.at(sums, which, each)
    return sums


def weights_of(raw, noise):
    """Return the weight of each sample, 1 but for those far beyond noise and bulk (Huber)."""
    bulk = MAD * np.median(np.abs(raw.reshape(-1, raw.shape[-1])), axis=0)
    far = OUTLIER * np.maximum(noise, bulk)
    return np.sqrt(np.minimum(1.0, far / np.maximum(np.abs(raw), 1e-300)))


def estimate(flights, vehicle, z, columns, *, noise=None, starts=None, iterations=ITERATIONS,
             clock=True):
    """
    Return the Estimate of the columns of z that predicts the flights best.

    Output error over short rollouts with free initial states, weighed by the noise, which is
    estimated along unless it is given; outliers count less; with `clock` each flight's pose may
    be off in time against the rest. Without `starts` (B, 13) per flight, the initial states, a
    few of the rollouts first bring z near.
    """
    columns = list(columns)
    if starts is None:
        few = [_fewer(flight, max(1, FEW // len(flights))) for flight in flights]
        if 2 * sum(len(flight.first) for flight in few) <= sum(len(f.first) for f in flights):
            z = _descend(few, vehicle, z, columns, noise, settled(few, vehicle, z, noise),
                         iterations, clock, ROUGH).z
        starts = settled(flights, vehicle, z, noise)
    return _descend(flights, vehicle, z, columns, noise, starts, iterations, clock, DONE)


def _fewer(flight, count):
    """Return a flight with `count` of its rollouts or a few more, spread over all of it."""
    skip = max(1, len(flight.first) // count)
    return replace(flight, first=flight.first[skip // 2::skip])


def _descend(flights, vehicle, z, columns, noise, starts, iterations, clock, done):
    """Return the Estimate from z by steps of Gauss and Newton that do not raise the cost."""
    lower, upper, size = (limit[columns] for limit in limits(vehicle))
    known, z = noise, np.array(z, float)
    raws = [errors_along(flight, vehicle, z, start)
            for flight, start in zip(flights, starts, strict=True)]
    noise = known or [quick_noise(raw) for raw in raws]
    tangents, converged = None, False
    for _ in range(iterations):
        fresh = tangents is None
        if fresh:
            tangents = [tangent_of(flight, vehicle, z, start, columns, STEP * size)
                        for flight, start in zip(flights, starts, strict=True)]
        scales = [weights_of(raw, sigma) / sigma for raw, sigma in zip(raws, noise, strict=True)]
        linears = [linear_of(tangent, raw, scale, clock)
                   for tangent, raw, scale in zip(tangents, raws, scales, strict=True)]
        normal = normal_of(linears, flights, clock)
        step, free = bounded_step(normal, z[columns], lower, upper, size)
        before = _cost(_aligned(raws, tangents, scales, clock), scales)
        for share in SHARES:
            there = z.copy()
            there[columns] += share * step
            own = _own(linears, share * step, clock)
            moved = [new_starts(linear, start, np.append(share * step, shift) if clock
                                else share * step)
                     for linear, start, shift in zip(linears, starts, own, strict=True)]
            left = [errors_along(flight, vehicle, there, start)
                    for flight, start in zip(flights, moved, strict=True)]
            aligned = _aligned(left, tangents, scales, clock)
            if _cost(aligned, scales) <= before * (1.0 + 1e-9):
                break
        else:
            if fresh:
                break
            tangents = None
            continue
        z, starts, raws = there, moved, left
        if known is None:
            noise = [whole_noise(part, linear.freedom)
                     for part, linear in zip(aligned, linears, strict=True)]
        # In units of the noise, so that directions that are not determined do not count.
        length = np.sqrt(max(step @ normal.information @ step, 0.0) / max(len(step), 1))
        if share == 1.0 and length <= done:
            converged = True
            break
        # Close by, the slopes are what they were.
        if share < 1.0 or np.any(np.abs(step) > NEAR * size):
            tangents = None
    return Estimate(z, columns, covariance_of(normal, size), noise, starts, normal, raws, free,
                    converged)


def _aligned(raws, tangents, scales, clock):
    """Return errors without what an offset of each flight's clock explains."""
    if not clock:
        return raws
    out = []
    for raw, tangent, scale in zip(raws, tangents, scales, strict=True):
        drift = tangent.drift * scale
        share = np.sum(drift * raw * scale) / max(np.sum(drift * drift), 1e-300)
        out.append(raw - share * tangent.drift)
    return out


def _cost(raws, scales):
    return sum(float(np.sum((raw * scale) ** 2))
               for raw, scale in zip(raws, scales, strict=True))


def settled(flights, vehicle, z, noise=None):
    """Return the initial states (B, 13) per flight that fit best at z, all samples alike."""
    found = []
    for k, flight in enumerate(flights):
        starts = flight.states[flight.first]
        sigma = noise[k] if noise else quick_noise(errors_along(flight, vehicle, z, starts))
        found.append(new_starts(linearise(flight, vehicle, z, starts, [], sigma, False), starts,
                                np.zeros(0)))
    return found


def bounded_step(normal, now, lower, upper, size):
    """Return the Gauss-Newton step (C,) that stays in bounds, and which columns it is free in."""
    free = np.ones(len(now), bool)
    step = np.zeros(len(now))
    for _ in range(len(now) + 1):
        step[:] = 0.0
        held = np.where(free, 0.0, np.clip(step, lower - now, upper - now))
        gradient = normal.gradient - normal.information @ held
        inside = np.flatnonzero(free)
        if len(inside):
            step[inside] = solve(normal.information[np.ix_(inside, inside)], gradient[inside],
                                 size[inside])
        beyond = free & ((now + step < lower - 1e-12) | (now + step > upper + 1e-12))
        if not beyond.any():
            break
        # Those that have somewhere to go end at the bound, the others stay there.
        free &= ~beyond | ((now > lower) & (now < upper))
        step = np.clip(step, lower - now, upper - now)
        if not (beyond & ~free).any():
            break
    return np.clip(step, lower - now, upper - now), free


def solve(information, gradient, size):
    """Return the step (C,) that the information supports; where it says nothing, none."""
    scaled = information * np.outer(size, size)
    values, vectors = np.linalg.eigh(scaled)
    kept = values > WEAK * max(values.max(initial=0.0), 1e-300)
    along = vectors.T @ (gradient * size)
    return size * (vectors[:, kept] @ (along[kept] / values[kept]))


def covariance_of(normal, size):
    """
    Return the covariance (C, C) of the columns: the inverse of the information.

    Widened where blocks of time scatter more than independent noise would let them.
    """
    values, vectors = np.linalg.eigh(normal.information * np.outer(size, size))
    least = max(1e-12 * values.max(initial=0.0), 1e-300)
    spread = size * np.sqrt(scatter_of(normal))
    return (vectors / np.maximum(values, least)) @ vectors.T * np.outer(spread, spread)


def scatter_of(normal):
    """
    Return, per column (C,), the variance of the blocks' scores over that of white noise.

    1 where it is not larger than white noise makes it by chance.
    """
    count = len(normal.scores)
    expected = np.maximum(np.diag(normal.information), 1e-300)
    if count < 4:
        return np.ones(len(expected))
    centred = normal.scores - normal.scores.mean(axis=0)
    found = np.sum(centred ** 2, axis=0) * count / (count - 1) / expected
    return np.where(found > chdtri(count - 1, CHANCE) / (count - 1), found, 1.0)


def _own(linears, step, clock):
    """Return the offset of each flight's clock (s) that goes with a step."""
    found = []
    for linear in linears:
        if not clock:
            found.append(0.0)
            continue
        own = linear.slope[..., -1]
        left = linear.error - linear.slope[..., :-1] @ step
        found.append(float(np.sum(own * left) / max(np.sum(own * own), 1e-300)))
    return found
