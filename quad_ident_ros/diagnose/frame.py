# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights linearised around a fit, to judge all sets of effects near it in the same way."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from quad_ident_ros.diagnose.discrepancy import (
    Blocks,
    blocks_of,
    directions,
    parts_of,
    Products,
    scales,
    summed,
    TRANSLATION,
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

AT_ONCE = 4     # rollouts whose slopes are put in units of the noise at once: a core's cache
BLOCKS = 16     # blocks whose products are held at once: all would be much of a diagnosis' memory


@dataclass(frozen=True, eq=False)
class Frame:
    """
    Flights linearised around a fit, in units of the noise, initial states taken out.

    wanted: the columns, places in z; per flight: scale (B, M) weight over noise, basis (B, M, 12)
    of the initial states, block (B,) of each rollout; slopes in the columns and in the clock of
    the pose.
    """

    wanted: list
    scale: list
    basis: list
    block: list
    slopes: Slopes

    @cached_property
    def products(self) -> list[np.ndarray]:
        """Slopes of Products per flight, (2, K, N, N), of all columns and, last, the clock."""
        found = []
        for tangent, scale, basis, block in zip(self.slopes.tangents, self.scale, self.basis,
                                                self.block, strict=True):
            size = tangent.table.shape[1] - ERRORS
            whole = np.zeros((2, block[-1] + 1, size, size))
            for begin in range(0, len(scale), AT_ONCE):
                part = slice(begin, begin + AT_ONCE)
                table = tangent.table[part, ERRORS:] * scale[part, None]
                table -= (table @ basis[part]) @ basis[part].transpose(0, 2, 1)
                halves = parts_of(table)
                each = halves @ halves.transpose(0, 1, 3, 2)
                for k, number in enumerate(block[part]):
                    whole[:, number] += each[:, k]
            found.append(whole)
        return found

    def places(self, columns: Iterable[int]) -> list[int]:
        """Return where columns (places in z) stand in the products."""
        return [self.wanted.index(column) for column in columns]

    def with_residual(self, errors: np.ndarray, flight: int, places: list[int] | slice
                      ) -> Products:
        """
        Return the Products of some columns of a flight with the errors (B, n, 12) of a fit.

        Args: places: where the columns stand in the products.
        """
        residual, basis = self.residual(errors, flight), self.basis[flight]
        kept = np.where(np.arange(residual.shape[1]) % ERRORS < TRANSLATION, 1.0, 0.0)
        halves = residual[:, :, None] * np.stack([kept, 1.0 - kept], axis=-1)
        halves -= basis @ (basis.transpose(0, 2, 1) @ halves)
        halves *= self.scale[flight][:, :, None]
        table = self.slopes.tangents[flight].table
        each = [table[part, ERRORS:][:, places] @ halves[part] for part in
                (slice(begin, begin + AT_ONCE) for begin in range(0, len(table), AT_ONCE))]
        cross = summed(np.concatenate(each), self.block[flight])
        slopes = self.products[flight][:, :, places][..., places]
        return Products(slopes, cross.transpose(2, 0, 1),
                        summed(np.sum(residual ** 2, axis=1), self.block[flight]))

    def residual(self, errors: np.ndarray, flight: int) -> np.ndarray:
        """Return errors (B, n, 12) in units of the noise, initial states taken out, (B, M)."""
        whole = errors.reshape(len(errors), -1) * self.scale[flight]
        basis = self.basis[flight]
        return whole - (basis @ (basis.transpose(0, 2, 1) @ whole[..., None]))[..., 0]


def frame_at(flights: list, vehicle: Vehicle, fit: Estimate, wanted: list, rules: Rules,
             scale: list | None = None) -> Frame:
    """
    Return the Frame of flights around an Estimate in some places of z and the wrench's.

    scale: of another Frame, to whose fit this one is compared; by default that of the Estimate.
    """
    wanted = sorted({*wanted, *WRENCH})
    raws = [errors_along(flight, vehicle, z, start)
            for flight, z, start in zip(flights, fit.vectors, fit.starts, strict=True)]
    slopes = slopes_at(flights, vehicle, fit.z, fit.vectors, fit.starts, wanted)
    scale = scale or [(weights_of(residual, sigma, flight) / sigma).reshape(len(residual), -1)
                      for residual, sigma, flight in zip(fit.residuals, fit.noise, flights,
                                                         strict=True)]
    basis, block = [], []
    for tangent, raw, weight, flight in zip(slopes.tangents, raws, scale, flights, strict=True):
        initial = Tangent(tangent.table[:, :ERRORS + 1])
        basis.append(linear_of(initial, raw, weight.reshape(raw.shape), False,
                               with_basis=True).basis)
        # What the air does is not modelled in inertial flights, and changes with the motion.
        span = flight.segment if inertial(flights) else rules.form_time
        number = (flight.course.t[flight.first] / span).astype(int)
        block.append(np.unique(number, return_inverse=True)[1])
    return Frame(wanted, scale, basis, block, slopes)


def directions_of(distances: dict, flight: int, columns: list[int]) -> np.ndarray:
    """
    Return the directions (2, N, D) of the discrepancy of a flight in N columns (places in z).

    Args: distances: {(effect, columns): distance (F, K) of a term's parameters from none in each
    flight} of each effect and, as None, nuisance.
    """
    shares = np.zeros((len(columns), len(distances)))
    for k, ((_, term), away) in enumerate(distances.items()):
        shares[[columns.index(column) for column in term], k] = away[flight]
    wrench = np.equal.outer(columns, WRENCH).astype(float)
    return directions(wrench, shares)


def blocks_at(frame: Frame, fit: Estimate, distances: dict) -> Blocks:
    """Return the Blocks of the residuals of an Estimate with its effects' distances."""
    used = sorted({*WRENCH, *(column for _, term in distances for column in term)})
    places = frame.places(used)
    return blocks_of([(frame.with_residual(errors, k, places),
                       directions_of(distances, k, used))
                      for k, errors in enumerate(fit.residuals)])


def form_errors_of(distances: dict, rules: Rules) -> np.ndarray:
    """Return the relative error (E,) that each term in distances may have."""
    return np.array([rules.form_error_of(effect) for effect, _ in distances])


def normal_at(frame: Frame, fit: Estimate, layout: Layout, distances: dict,
              sizes: tuple[float, float], form_error: float | np.ndarray,
              step: np.ndarray | None = None) -> Normal:
    """
    Return the Normal in a Layout's columns with the discrepancy marginalised out.

    Args: fit: at which the Frame is; sizes: force (N) and moment (N m) of the discrepancy, and
    form_error, as of scales; step (layout.size,): from the fit to where the Normal is wanted.
    """
    information = np.zeros((layout.size, layout.size))
    gradient, cost, scores = np.zeros(layout.size), 0.0, []
    clock, kept = len(frame.wanted), frame.places(layout.wanted)
    for number, errors in enumerate(fit.residuals):
        found = frame.with_residual(errors, number, slice(None))
        if step is not None:
            moved = np.zeros(clock + 1)
            moved[kept] = layout.of_flight(step, number)
            found = found.at(moved)
        along = directions_of(distances, number, frame.wanted)
        along *= scales(*sizes, form_error, along.shape[2])
        along = np.pad(along, ((0, 0), (0, 1), (0, 0)))[:, None]    # the clock has no part in them
        whole, ends = _without_discrepancy(found, along)
        # The clock of the pose is free in each flight: it is taken out of the others.
        size = max(whole[clock, clock], 1e-300)
        share = whole[:, clock] / size
        cost += whole[-1, -1] - size * share[-1] ** 2
        score = ends[:, kept, -1] - share[-1] * ends[:, kept, 0]
        score -= share[kept] * (ends[:, clock, -1] - share[-1] * ends[:, clock, 0])[:, None]
        table = whole[np.ix_(kept, kept)] - size * np.outer(share[kept], share[kept])
        places = layout.places(number)
        information[np.ix_(places, places)] += table[np.ix_(layout.rows, layout.rows)]
        gradient[places] += score[:, layout.rows].sum(axis=0)
        pairs = score[:, layout.rows]
        pairs = np.add.reduceat(pairs, np.arange(0, len(pairs), 2), axis=0)
        scores.append(np.zeros((len(pairs), layout.size)))
        scores[-1][:, places] = pairs
    return Normal(information, gradient, cost, np.concatenate(scores))


def _without_discrepancy(products: Products, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Return Products with the discrepancy marginalised out, the residual as the last column.

    (N + 1, N + 1) summed over blocks, and of each block the columns of clock and residual,
    (K, N + 1, 2). Args: along (2, 1, N, D): directions times their scales.
    """
    count, size = products.slopes.shape[1:3]
    across = along.transpose(0, 1, 3, 2)
    whole, ends = np.zeros((size + 1, size + 1)), np.empty((count, size + 1, 2))
    for begin in range(0, count, BLOCKS):
        part = slice(begin, begin + BLOCKS)
        slopes, cross = products.slopes[:, part], products.cross[:, part]
        each = np.zeros((slopes.shape[1], size + 1, size + 1))
        np.sum(slopes, axis=0, out=each[:, :-1, :-1])
        each[:, :-1, -1] = each[:, -1, :-1] = cross.sum(axis=0)
        each[:, -1, -1] = products.power[part]
        drawn = across @ slopes
        ties = np.concatenate([drawn, across @ cross[..., None]], axis=3).sum(axis=0)
        inside = np.sum(drawn @ along, axis=0) + np.eye(along.shape[3])
        each -= ties.transpose(0, 2, 1) @ np.linalg.solve(inside, ties)
        whole += each.sum(axis=0)
        ends[part] = each[:, :, -2:]
    return whole, ends
