# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The search space: how a point of the paper's box [0, 200]^D stands for model parameters.

The paper's Table 2 has K from -9973 to -9.7 and poles of 1e-4, which a literal box [0, 200]
cannot hold; the box is therefore read as scaled coordinates, p = low + (high - low) X / 200, with
bounds that come from the data (docs/paper.md).
"""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.data.info import LARGEST
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.objective import Objective
from quad_ident_ros.identify.transfer import SecondOrder
from quad_ident_ros.identify.vp import best_poles, COMPLEX_PENALTY
from quad_ident_ros.schema import numbers

SIZE = 200.0
AT_BOUNDS = 1e-6    # share of the space within which a model lies on its bounds


@compiled
def _read(points: np.ndarray, low: float, high: float, complex_penalty: float, c1: np.ndarray,
          c0: np.ndarray, weights: np.ndarray) -> None:
    """Write c1 and c0 of points (n, 2) of the box, and by how much their cost counts."""
    scale = (high - low) / SIZE
    for i in range(points.shape[0]):
        mean = low + scale * (points[i, 0] + points[i, 1]) / 2
        half = scale * (points[i, 0] - points[i, 1]) / 2
        if complex_penalty == np.inf:
            half = abs(half)
        c1[i], c0[i] = 2.0 * mean, mean * mean - half * abs(half)
        weights[i] = complex_penalty if half < 0.0 else 1.0


@dataclass(frozen=True)
class Space:
    """
    Bounds of one output: poles (low, high) 1/s and gain (low, high), and the complex penalty.

    evaluations: of the objective, spent to find the bounds; near: a model near which the best one
    is expected, or None. In the plane (p, q) of the poles, real poles are symmetric under
    a <-> b, so that half of the square is free: p >= q stands for a = p, b = q and p < q for the
    pair (p + q)/2 +- j (q - p)/2, which joins on at the diagonal of equal poles.
    """

    poles: tuple[float, float]
    gain: tuple[float, float]
    complex_penalty: float
    evaluations: int = 0
    near: SecondOrder | None = None

    def mean_and_half(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return mean and signed half-difference (n,) of the poles of points (n, 2)."""
        low, high = self.poles
        p, q = (low + (high - low) * points / SIZE).T
        half = (p - q) / 2
        if np.isinf(self.complex_penalty):
            half = np.abs(half)
        return (p + q) / 2, half

    def cost(self, objective: Objective, points: np.ndarray) -> np.ndarray:
        """Return F (n,) of points (n, 2), with complex pairs penalised."""
        c1, c0, weights = np.empty((3, len(points)))
        _read(points, *self.poles, self.complex_penalty, c1, c0, weights)
        costs, _ = objective.of_poles(c1, c0)
        costs *= weights
        return costs

    def holds(self, model: SecondOrder) -> bool:
        """Tell whether gain and poles of a model lie within the bounds."""
        reach, mean = abs(model.a - model.b) / 2, model.c1 / 2
        return (self.gain[0] <= model.gain <= self.gain[1]
                and self.poles[0] <= mean - reach and mean + reach <= self.poles[1])


def at_bounds(space: Space, model: SecondOrder) -> list[str]:
    """Return the names of the bounds, 'poles' and 'gain', on which a model found lies."""
    reach, mean = abs(model.a - model.b) / 2, model.c1 / 2
    values = {'poles': (mean - reach, mean + reach), 'gain': (model.gain,)}
    found = []
    for name, (low, high) in (('poles', space.poles), ('gain', space.gain)):
        near = AT_BOUNDS * (high - low)
        if min(values[name]) <= low + near or max(values[name]) >= high - near:
            found.append(name)
    return found


def check_bounds(pole_bounds: tuple[float, float] | None, gain_bounds: tuple[float, float] | None
                 ) -> None:
    """Raise InputError for bounds, (low, high) or None, that hold nothing."""
    for name, bounds in (('pole_bounds', pole_bounds), ('gain_bounds', gain_bounds)):
        if bounds is None:
            continue
        low, high = numbers(name, list(bounds), 2, -LARGEST, LARGEST)
        if not low < high:
            raise InputError(f'{name}: the lower bound must be below the upper, got '
                             f'[{low:g}, {high:g}]')


def find_space(objective: Objective, poles: str = 'auto',
               pole_bounds: tuple[float, float] | None = None,
               gain_bounds: tuple[float, float] | None = None, near: SecondOrder | None = None
               ) -> Space:
    """
    Return the search space of an output, from the data where bounds are not given.

    The bounds enclose, twofold, the poles of least cost (see vp.best_poles), and at least
    [-2.5, 2.5] / T (errata section 3). Args: poles, a key of COMPLEX_PENALTY; pole_bounds
    (low, high) 1/s; gain_bounds (low, high); near as in Space. Raises InputError for empty bounds.
    """
    check_bounds(pole_bounds, gain_bounds)
    penalty = COMPLEX_PENALTY[poles]
    duration = objective.signal.t[-1] + objective.signal.period
    spent = 0
    if pole_bounds is None or gain_bounds is None:
        best, spent = best_poles(objective.signal, penalty, near)
        mean = best.model.c1 / 2
    if pole_bounds is None:
        # The fold reads a pair m +- jw from p = m - w, q = m + w: the box must hold both. Where
        # noise leaves no trace of a fast pole, its best value may be anything up to infinity.
        reach = abs(best.model.a - best.model.b) / 2
        pole_bounds = (min(-2.5 / duration, 2 * (mean - reach)),
                       max(2.5 / duration, min(2 * (mean + reach), 2 / objective.signal.period)))
    if gain_bounds is None:
        size = 3 * max(abs(best.model.gain),
                       abs(Objective(objective.signal).fit(0.0, 0.0).model.gain))
        gain_bounds = (-size, size) if size > 0 else (-1.0, 1.0)
    return Space((float(pole_bounds[0]), float(pole_bounds[1])),
                 (float(gain_bounds[0]), float(gain_bounds[1])), penalty, spent, near)


def literal_space(poles: str = 'auto') -> Space:
    """Return the box [0, 200] taken at its word, for gain and poles."""
    return Space((0.0, SIZE), (0.0, SIZE), COMPLEX_PENALTY[poles])


def no_space(poles: str = 'auto', near: SecondOrder | None = None) -> Space:
    """Return the space of methods that search in none."""
    return Space((-np.inf, np.inf), (-np.inf, np.inf), COMPLEX_PENALTY[poles], near=near)
