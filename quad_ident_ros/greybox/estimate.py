# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the vehicle and its effects that predict flights best: Gauss-Newton."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.greybox.linear import errors_along, linearise, new_starts
from quad_ident_ros.greybox.noise import quick_noise, whole_noise
from quad_ident_ros.greybox.parameters import limits

ITERATIONS = 12
DONE = 1e-3         # standard errors that a last step may be long
WEAK = 1e-7         # of the largest information: a direction that says nothing
OUTLIER = 4.0       # noise deviations beyond which a sample counts less
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
                slope = slope - own[..., None] * (np.einsum('bm,bmc->c', own, slope) / size)
        information = information + np.einsum('bmc,bmd->cd', slope, slope, optimize=True)
        each = np.einsum('bmc,bm->bc', slope, error)
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
    """Return the weight of each sample, 1 but for outliers (Huber)."""
    return np.sqrt(np.minimum(1.0, OUTLIER / np.maximum(np.abs(raw) / noise, 1e-12)))


def estimate(flights, vehicle, z, columns, *, noise=None, starts=None, iterations=ITERATIONS,
             clock=True):
    """
    Return the Estimate of the columns of z that predicts the flights best.

    Output error over short rollouts with free initial states, weighed by the noise, which is
    estimated along unless it is given; outliers count less; with `clock` each flight's pose may
    be off in time against the rest.
    """
    columns = list(columns)
    lower, upper, size = limits(vehicle)
    known, z = noise, np.array(z, float)
    starts = starts or settled(flights, vehicle, z, noise)
    raws = [errors_along(flight, vehicle, z, start)
            for flight, start in zip(flights, starts, strict=True)]
    noise = known or [quick_noise(raw) for raw in raws]
    free = np.ones(len(columns), bool)
    converged = False
    for _ in range(iterations):
        weights = [weights_of(raw, sigma) for raw, sigma in zip(raws, noise, strict=True)]
        linears = [linearise(flight, vehicle, z, start, columns, sigma, clock, weight)
                   for flight, start, sigma, weight in
                   zip(flights, starts, noise, weights, strict=True)]
        normal = normal_of(linears, flights, clock)
        step, free = bounded_step(normal, z[columns], lower[columns], upper[columns],
                                  size[columns])
        z[columns] += step
        starts = [new_starts(linear, start, np.append(step, own) if clock else step)
                  for linear, start, own in zip(linears, starts, _own(linears, step, clock),
                                                strict=True)]
        raws = [errors_along(flight, vehicle, z, start)
                for flight, start in zip(flights, starts, strict=True)]
        if known is None:
            noise = [whole_noise(raw, 1.0 - 1.0 / raw.shape[1]) for raw in raws]
        covariance = covariance_of(normal, size[columns])
        errors = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
        if np.all(np.abs(step) <= DONE * np.maximum(errors, 1e-6 * size[columns])):
            converged = True
            break
    return Estimate(z, columns, covariance, noise, starts, normal, raws, free, converged)


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
    """Return, per column (C,), the variance of the blocks' scores over that of white noise."""
    count = len(normal.scores)
    expected = np.maximum(np.diag(normal.information), 1e-300)
    if count < 4:
        return np.ones(len(expected))
    centred = normal.scores - normal.scores.mean(axis=0)
    return np.maximum(1.0, np.sum(centred ** 2, axis=0) * count / (count - 1) / expected)


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
