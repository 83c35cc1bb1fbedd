# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the model cannot be right about: the error of form, marginalised out of the likelihood.

After Kennedy and O'Hagan (J. R. Stat. Soc. B 63, 2001) a residual is noise and a discrepancy of
the model. Over each block of about a second the discrepancy has two parts, both normal about zero:
every effect does what its formula says times one plus a relative error, apart for translation and
rotation; and a force and a moment act that nothing explains. A term of a formula that does what
another effect does errs by itself, so that its name does not matter. The relative error is given,
the size of force and moment is estimated with the effects. Within a block its errors are the same,
from block to block they are independent.
"""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.greybox.errors import ERRORS

TRANSLATION = 6     # of the errors: position and velocity, then rotation and rate
AXES = 3            # of force and of moment


@dataclass(frozen=True, eq=False)
class Products:
    """
    Of slopes Z and residuals r of rollouts the products that a discrepancy needs, by blocks.

    Each of them for translation and for rotation: slopes (2, K, N, N), of N columns of Z with one
    another; cross (2, K, N), of these with r. power (K,): the sum of r squared.
    """

    slopes: np.ndarray
    cross: np.ndarray
    power: np.ndarray

    def at(self, step: np.ndarray) -> 'Products':
        """Return the Products of the residuals r - Z step, after a step (N,) of the columns."""
        pull = self.slopes @ step
        power = self.power - np.sum((2.0 * self.cross - pull) @ step, axis=0)
        return Products(self.slopes, self.cross - pull, power)


@dataclass(frozen=True, eq=False)
class Blocks:
    """
    Residuals r and discrepancy directions U of blocks of rollouts, as their products.

    gram (K, D, D) of U, cross (K, D) of U with r, power: the sum of r squared. The first AXES
    directions are forces, the next AXES moments, the others what terms of formulas do.
    """

    gram: np.ndarray
    cross: np.ndarray
    power: float


def parts_of(values: np.ndarray) -> np.ndarray:
    """Return those of translation and of rotation, (2, ..., M / 2), of values (..., M)."""
    shaped = values.reshape(*values.shape[:-1], -1, ERRORS)
    return np.stack([part.reshape(*values.shape[:-1], -1)
                     for part in (shaped[..., :TRANSLATION], shaped[..., TRANSLATION:])])


def directions(wrench: np.ndarray, contributions: np.ndarray) -> np.ndarray:
    """
    Return the directions, (2, N, D), of the discrepancy as sums of slopes in N columns.

    Of translation and of rotation. Args: wrench (N, 6): the columns of a force and a moment;
    contributions (N, E): what each term has of each column.
    """
    none = np.zeros(contributions.shape)
    return np.stack([np.hstack([wrench, contributions, none]),
                     np.hstack([wrench, none, contributions])])


def scales(force: float, moment: float, form_error: float | np.ndarray, count: int
           ) -> np.ndarray:
    """
    Return the prior standard deviation (D,) along each of `count` directions.

    form_error: the relative error of all terms, or (E,) of each.
    """
    each = np.broadcast_to(form_error, count // 2 - AXES)
    return np.concatenate([np.full(AXES, force), np.full(AXES, moment), each, each])


def blocks_of(flights: list[tuple[Products, np.ndarray]]) -> Blocks:
    """Return the Blocks of flights: the Products and the directions (2, N, D) of each."""
    gram, cross = [], []
    for products, along in flights:
        across = along.transpose(0, 2, 1)[:, None]
        gram.append(np.sum(across @ products.slopes @ along[:, None], axis=0))
        cross.append(np.sum(across @ products.cross[..., None], axis=0)[..., 0])
    return Blocks(np.concatenate(gram), np.concatenate(cross),
                  float(sum(products.power.sum() for products, _ in flights)))


def summed(values: np.ndarray, block: np.ndarray) -> np.ndarray:
    """Return the sums (K, ...) of values (B, ...) over blocks numbered from 0 in rising order."""
    return np.add.reduceat(values, np.flatnonzero(np.diff(block, prepend=-1)), axis=0)


def log_likelihood(blocks: Blocks, deviation: np.ndarray, scatter: float = 1.0) -> float:
    """
    Return the log-likelihood of residuals with the discrepancy marginalised out.

    Up to what no set of effects changes. Args: deviation (D,): prior standard deviation along
    each direction, of residuals in units of the noise; scatter: what the cost is divided by.
    """
    used = deviation > 0.0
    if not used.any():
        return -0.5 * blocks.power / scatter
    width = deviation[used]
    scaled = blocks.gram[:, used][:, :, used] * np.outer(width, width) / scatter
    cross = blocks.cross[:, used] * width / scatter
    factor = np.linalg.cholesky(np.eye(len(width)) + scaled)
    white = np.linalg.solve(factor, cross[..., None])[..., 0]
    logs = np.log(np.einsum('kii->ki', factor))
    return float(-0.5 * blocks.power / scatter + 0.5 * np.sum(white ** 2) - np.sum(logs))


def fitted_sizes(blocks: Blocks, form_error: float | np.ndarray, grids: tuple,
                 scatter: float = 1.0, start: tuple = (0, 0)) -> tuple:
    """
    Return (log-likelihood, (force, moment)) at the likeliest sizes on two grids of them.

    Args: form_error as of scales; grids: rising sizes of the force and of the moment, 0 first;
    start: where the search begins in each.
    """
    count = blocks.gram.shape[1]
    known = {}

    def value(place: tuple) -> float:
        if place not in known:
            force, moment = (grid[k] for grid, k in zip(grids, place, strict=True))
            known[place] = log_likelihood(blocks, scales(force, moment, form_error, count),
                                          scatter)
        return known[place]

    best = start
    while True:
        near = [tuple(best[k] + (step if k == axis else 0) for k in range(2))
                for axis in range(2) for step in (-1, 1)]
        near = [place for place in near
                if all(0 <= k < len(grid) for k, grid in zip(place, grids, strict=True))]
        top = max((best, *near), key=value)
        if top == best:
            return value(best), best
        best = top
