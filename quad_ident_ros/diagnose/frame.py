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
from quad_ident_ros.greybox.estimate import Estimate, weights_of
from quad_ident_ros.greybox.flights import inertial
from quad_ident_ros.greybox.linear import errors_along, linear_of, Slopes, slopes_at, WRENCH
from quad_ident_ros.greybox.normal import Normal
from quad_ident_ros.greybox.nuisances import Layout
from quad_ident_ros.model.vehicle import Vehicle


@dataclass(frozen=True, eq=False)
class Frame:
    """
    Flights linearised around a fit, in units of the noise, initial states taken out.

    wanted: the columns, places in z; per flight: scale (B, M) weight over noise, basis (B, M, 12)
    of the initial states, slope (B, M, C + 1) in the columns and, last, in the clock of the pose,
    block (B,) of each rollout; slopes: where these come from.
    """

    wanted: list
    scale: list
    basis: list
    slope: list
    block: list
    slopes: Slopes

    def columns(self, places: list, flight: int) -> np.ndarray:
        """Return the slope of a flight in some places of z, (B, M, K)."""
        return self.slope[flight][..., [self.wanted.index(place) for place in places]]

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
    scale, basis, slope, block = [], [], [], []
    for tangent, raw, residual, sigma, flight in zip(slopes.tangents, raws, fit.residuals,
                                                     fit.noise, flights, strict=True):
        weight = weights_of(residual, sigma, flight) / sigma
        linear = linear_of(tangent, raw, weight)
        scale.append(weight.reshape(len(raw), -1))
        basis.append(linear.basis)
        slope.append(linear.slope)
        # What the air does is not modelled in inertial flights, and changes with the motion.
        span = flight.segment if inertial(flights) else rules.form_time
        number = (flight.course.t[flight.first] / span).astype(int)
        block.append(np.unique(number, return_inverse=True)[1])
    return Frame(wanted, scale, basis, slope, block, slopes)


def discrepancy_of(frame: Frame, distances: dict) -> list:
    """
    Return the directions (B, M, D) of the discrepancy of each flight.

    Args: distances: {(kind, columns): distance (F, K) of their parameters from none in each
    flight} of each effect and nuisance.
    """
    found = []
    for k in range(len(frame.slope)):
        each = [frame.columns(list(columns), k) @ away[k]
                for (_, columns), away in distances.items()]
        shape = frame.slope[k].shape[:2]
        found.append(directions(frame.columns(list(WRENCH), k),
                                np.stack(each, axis=2) if each else np.zeros((*shape, 0))))
    return found


def blocks_at(frame: Frame, fit: Estimate, distances: dict) -> Blocks:
    """Return the Blocks of the residuals of an Estimate with its effects' distances."""
    return blocks_of([(basis, frame.residual(errors, k), frame.block[k])
                      for k, (basis, errors) in enumerate(zip(discrepancy_of(frame, distances),
                                                              fit.residuals, strict=True))])


def normal_at(frame: Frame, fit: Estimate, layout: Layout, distances: dict,
              sizes: tuple[float, float], rules: Rules) -> Normal:
    """
    Return the Normal in a Layout's columns with the discrepancy marginalised out.

    Args: fit: at which the Frame is; sizes: force (N) and moment (N m) of the discrepancy.
    """
    information = np.zeros((layout.size, layout.size))
    gradient, cost, scores = np.zeros(layout.size), 0.0, []
    rows = [frame.wanted.index(place) for place in layout.wanted]
    for number, basis in enumerate(discrepancy_of(frame, distances)):
        residual = frame.residual(fit.residuals[number], number)
        table = np.concatenate([frame.slope[number][..., [*rows, -1]],
                                residual[..., None]], axis=2)
        deviation = scales(*sizes, rules.form_error, basis.shape[2])
        block = frame.block[number]
        spread = basis * deviation
        across = spread.transpose(0, 2, 1)
        inside = summed(across @ spread, block) + np.eye(len(deviation))
        ties = summed(across @ table, block)
        each = summed(table.transpose(0, 2, 1) @ table, block)
        each -= ties.transpose(0, 2, 1) @ np.linalg.solve(inside, ties)
        # The clock of the pose is free in each flight: it is taken out of the others.
        clock = len(rows)
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
