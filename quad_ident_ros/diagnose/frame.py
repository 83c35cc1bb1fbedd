# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights linearised around a fit, by which all sets of effects near it are judged alike."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.discrepancy import (
    Blocks,
    blocks_of,
    directions,
    scales,
    summed,
)
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.errors import ERRORS
from quad_ident_ros.greybox.estimate import Estimate, weights_of
from quad_ident_ros.greybox.flights import inertial
from quad_ident_ros.greybox.linear import (
    errors_along,
    linear_of,
    Slopes,
    slopes_at,
    Tangent,
    WRENCH,
)
from quad_ident_ros.greybox.normal import Normal
from quad_ident_ros.greybox.nuisances import Layout
from quad_ident_ros.model.vehicle import Vehicle

AT_ONCE = 16    # rollouts whose slopes in units of the noise are made at once
EVERY = slice(None)


@dataclass(frozen=True, eq=False)
class Frame:
    """
    Flights linearised around a fit, in units of the noise, initial states taken out.

    wanted: the columns, places in z; per flight: scale (B, M) weight over noise, basis (B, M, 12)
    of the initial states, block (B,) of each rollout; slopes in the columns and in the clock of
    the pose, from which those in units of the noise are made where they are used: they are large.
    """

    wanted: list
    scale: list
    basis: list
    block: list
    slopes: Slopes

    def columns(self, places: list, flight: int, part: slice = EVERY, clock: bool = False
                ) -> np.ndarray:
        """
        Return the slope of rollouts of a flight in some places of z, (B, M, K).

        With clock, one more column, the last: that in the clock of the pose.
        """
        rows = [ERRORS + self.wanted.index(place) for place in places]
        table = self.slopes.tangents[flight].table[part][:, [*rows, -1] if clock else rows]
        table *= self.scale[flight][part][:, None]
        basis = self.basis[flight][part]
        table -= (table @ basis) @ basis.transpose(0, 2, 1)
        return table.transpose(0, 2, 1)

    def residual(self, errors: np.ndarray, flight: int) -> np.ndarray:
        """Return errors (B, n, 12) in units of the noise, initial states taken out, (B, M)."""
        whole = errors.reshape(len(errors), -1) * self.scale[flight]
        basis = self.basis[flight]
        return whole - (basis @ (basis.transpose(0, 2, 1) @ whole[..., None]))[..., 0]


def frame_at(flights: list, vehicle: Vehicle, fit: Estimate, wanted: list, rules: Rules) -> Frame:
    """Return the Frame of flights around an Estimate in some places of z and the wrench's."""
    wanted = sorted({*wanted, *WRENCH})
    raws = [errors_along(flight, vehicle, z, start)
            for flight, z, start in zip(flights, fit.vectors, fit.starts, strict=True)]
    slopes = slopes_at(flights, vehicle, fit.z, fit.vectors, fit.starts, wanted)
    scale, basis, block = [], [], []
    for tangent, raw, residual, sigma, flight in zip(slopes.tangents, raws, fit.residuals,
                                                     fit.noise, flights, strict=True):
        weight = weights_of(residual, sigma, flight) / sigma
        initial = Tangent(tangent.table[:, :ERRORS + 1])
        scale.append(weight.reshape(len(raw), -1))
        basis.append(linear_of(initial, raw, weight, False).basis)
        # What the air does is not modelled in inertial flights, and changes with the motion.
        span = flight.segment if inertial(flights) else rules.form_time
        number = (flight.course.t[flight.first] / span).astype(int)
        block.append(np.unique(number, return_inverse=True)[1])
    return Frame(wanted, scale, basis, block, slopes)


def discrepancy_of(frame: Frame, distances: dict, flight: int, part: slice = EVERY
                   ) -> np.ndarray:
    """
    Return the directions (B, M, D) of the discrepancy of rollouts of a flight.

    Args: distances: {(kind, columns): distance (F, K) of their parameters from none in each
    flight} of each effect and nuisance.
    """
    each = [frame.columns(list(columns), flight, part) @ away[flight]
            for (_, columns), away in distances.items()]
    shape = frame.scale[flight][part].shape
    return directions(frame.columns(list(WRENCH), flight, part),
                      np.stack(each, axis=2) if each else np.zeros((*shape, 0)))


def blocks_at(frame: Frame, fit: Estimate, distances: dict) -> Blocks:
    """Return the Blocks of the residuals of an Estimate with its effects' distances."""
    return blocks_of([(discrepancy_of(frame, distances, k), frame.residual(errors, k),
                       frame.block[k]) for k, errors in enumerate(fit.residuals)])


def normal_at(frame: Frame, fit: Estimate, layout: Layout, distances: dict,
              sizes: tuple[float, float], rules: Rules) -> Normal:
    """
    Return the Normal in a Layout's columns with the discrepancy marginalised out.

    Args: fit: at which the Frame is; sizes: force (N) and moment (N m) of the discrepancy.
    """
    information = np.zeros((layout.size, layout.size))
    gradient, cost, scores = np.zeros(layout.size), 0.0, []
    for number, errors in enumerate(fit.residuals):
        residual, block = frame.residual(errors, number), frame.block[number]
        squares, crosses, products = [], [], []
        for begin in range(0, len(residual), AT_ONCE):
            part = slice(begin, begin + AT_ONCE)
            spread = discrepancy_of(frame, distances, number, part)
            spread *= scales(*sizes, rules.form_error, spread.shape[2])
            table = np.concatenate([frame.columns(layout.wanted, number, part, True),
                                    residual[part, :, None]], axis=2)
            across = spread.transpose(0, 2, 1)
            squares.append(across @ spread)
            crosses.append(across @ table)
            products.append(table.transpose(0, 2, 1) @ table)
        inside = summed(np.concatenate(squares), block) + np.eye(spread.shape[2])
        ties = summed(np.concatenate(crosses), block)
        each = summed(np.concatenate(products), block)
        each -= ties.transpose(0, 2, 1) @ np.linalg.solve(inside, ties)
        # The clock of the pose is free in each flight: it is taken out of the others.
        clock = len(layout.wanted)
        whole = each.sum(axis=0)
        size = max(whole[clock, clock], 1e-300)
        share = whole[:, clock] / size
        cost += whole[-1, -1] - size * share[-1] ** 2
        kept = [layout.wanted.index(place) for place in layout.wanted]
        score = each[:, kept, -1] - share[-1] * each[:, kept, clock]
        score -= share[kept] * (each[:, clock, -1] - share[-1] * each[:, clock, clock])[:, None]
        table = whole[np.ix_(kept, kept)] - size * np.outer(share[kept], share[kept])
        places = layout.places(number)
        information[np.ix_(places, places)] += table[np.ix_(layout.rows, layout.rows)]
        gradient[places] += score[:, layout.rows].sum(axis=0)
        pairs = score[:, layout.rows]
        pairs = np.add.reduceat(pairs, np.arange(0, len(pairs), 2), axis=0)
        scores.append(np.zeros((len(pairs), layout.size)))
        scores[-1][:, places] = pairs
    return Normal(information, gradient, cost, np.concatenate(scores))
