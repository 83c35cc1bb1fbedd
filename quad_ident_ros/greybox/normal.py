# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Normal equations of flights: what is shared by all of them, and the nuisances of each."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.linear import Linear
from quad_ident_ros.greybox.nuisances import Layout

WEAK = 1e-7         # of the largest information: a direction that says nothing
LEAST = 1e-6        # information, in usual sizes: what is known to a thousand of them is not known
CHANCE = 0.01       # that white noise is taken for autocorrelated noise
BLOCK = 2.0         # s over which residuals may be autocorrelated


@dataclass(frozen=True, eq=False)
class Normal:
    """
    What flights say of the columns around a point: information (C, C), gradient (C,), cost.

    scores (K, C): the gradient of each block of time, whose scatter shows how much
    information autocorrelated errors take away.
    """

    information: np.ndarray
    gradient: np.ndarray
    cost: float
    scores: np.ndarray


def normal_of(linears: Iterable[Linear], flights: Iterable[Flight], layout: Layout,
              clock: bool = True) -> Normal:
    """
    Return the Normal of linearised flights, in the columns of a greybox.nuisances.Layout.

    With clock, what the last columns of each flight explain is taken out.
    """
    information = np.zeros((layout.size, layout.size))
    gradient, cost, scores = np.zeros(layout.size), 0.0, []
    for number, (linear, flight) in enumerate(zip(linears, flights, strict=True)):
        products, each = linear.products, linear.cross
        cost += float(np.sum(linear.power))
        if clock:
            # The column of the clock is taken out of the others and of the errors.
            drift, size = products[:, :-1, -1], max(products[:, -1, -1].sum(), 1e-300)
            share, ties = each[:, -1].sum() / size, drift.sum(axis=0) / size
            rest = each[:, -1] - share * products[:, -1, -1]
            each = each[:, :-1] - share * drift - ties * rest[:, None]
            cost -= size * share ** 2
            whole = products[:, :-1, :-1].sum(axis=0) - size * np.outer(ties, ties)
        else:
            whole = products.sum(axis=0)
        rows, places = layout.rows, layout.places(number)
        information[np.ix_(places, places)] += whole[np.ix_(rows, rows)]
        gradient[places] += each[:, rows].sum(axis=0)
        blocks = _blocks(each[:, rows], flight)
        scores.append(np.zeros((len(blocks), layout.size)))
        scores[-1][:, places] = blocks
    return Normal(information, gradient, cost, np.concatenate(scores))


def _blocks(each: np.ndarray, flight: Flight) -> np.ndarray:
    """Return sums over blocks of time of what there is per rollout."""
    block = (flight.course.t[flight.first] // BLOCK).astype(int)
    _, which = np.unique(block, return_inverse=True)
    sums = np.zeros((which.max() + 1, each.shape[1]))
    np.add.at(sums, which, each)
    return sums


def bounded_step(information: np.ndarray, gradient: np.ndarray, now: np.ndarray,
                 lower: np.ndarray, upper: np.ndarray, size: np.ndarray
                 ) -> tuple[np.ndarray, np.ndarray]:
    """Return the Gauss-Newton step (C,) that stays in bounds, and which columns it is free in."""
    free = np.ones(len(now), bool)
    step = np.zeros(len(now))
    for _ in range(len(now) + 1):
        step[:] = 0.0
        held = np.where(free, 0.0, np.clip(step, lower - now, upper - now))
        pull = gradient - information @ held
        inside = np.flatnonzero(free)
        if len(inside):
            step[inside] = solve(information[np.ix_(inside, inside)], pull[inside], size[inside])
        beyond = free & ((now + step < lower - 1e-12) | (now + step > upper + 1e-12))
        if not beyond.any():
            break
        # Those that have somewhere to go end at the bound, the others stay there.
        free &= ~beyond | ((now > lower) & (now < upper))
        step = np.clip(step, lower - now, upper - now)
        if not (beyond & ~free).any():
            break
    return np.clip(step, lower - now, upper - now), free


def solve(information: np.ndarray, gradient: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Return the step (C,) that the information supports; where it says nothing, none."""
    scaled = information * np.outer(size, size)
    values, vectors = np.linalg.eigh(scaled)
    kept = values > max(WEAK * values.max(initial=0.0), LEAST)
    along = vectors.T @ (gradient * size)
    return size * (vectors[:, kept] @ (along[kept] / values[kept]))


def marginal(normal: Normal, shared: int, precision: np.ndarray) -> Normal:
    """
    Return the Normal of the first columns, the others free but for their precision (C, C).

    The scores are those of the blocks with the others following, as far as they are free.
    """
    rest = slice(shared, None)
    block = normal.information[rest, rest] + precision[rest, rest]
    ties = np.linalg.solve(block, normal.information[rest, :shared])
    return Normal(normal.information[:shared, :shared] - normal.information[:shared, rest] @ ties,
                  normal.gradient[:shared] - normal.gradient[rest] @ ties, normal.cost,
                  normal.scores[:, :shared] - normal.scores[:, rest] @ ties)


def first_of(normal: Normal, count: int) -> Normal:
    """Return the Normal of the first columns, the others held."""
    return replace(normal, information=normal.information[:count, :count],
                   gradient=normal.gradient[:count], scores=normal.scores[:, :count])


def covariance_of(normal: Normal, size: np.ndarray) -> np.ndarray:
    """
    Return the covariance (C, C) of the columns: the inverse of the information.

    Widened where blocks of time scatter more than independent noise would let them.
    """
    values, vectors = np.linalg.eigh(normal.information * np.outer(size, size))
    least = max(1e-12 * values.max(initial=0.0), 1e-300)
    spread = size * np.sqrt(scatter_of(normal))
    return (vectors / np.maximum(values, least)) @ vectors.T * np.outer(spread, spread)


def scatter_of(normal: Normal) -> np.ndarray:
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
    return np.where(found > scipy.special.chdtri(count - 1, CHANCE) / (count - 1), found, 1.0)
