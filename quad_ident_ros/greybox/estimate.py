# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the vehicle and its effects that predict flights best: Gauss-Newton."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.linear import (
    errors_along,
    Linear,
    linear_of,
    linearise,
    new_starts,
    seen_along,
    Slopes,
    slopes_at,
    Tangent,
    Whitening,
    whitening_of,
    WRENCH,
)
from quad_ident_ros.greybox.noise import MAD, quick_noise, whole_noise
from quad_ident_ros.greybox.normal import bounded_step, covariance_of, marginal, Normal, normal_of
from quad_ident_ros.greybox.nuisances import Layout, NuisanceValues
from quad_ident_ros.greybox.parameters import limits
from quad_ident_ros.model.vehicle import Vehicle

ITERATIONS = 20
DONE = 0.2          # standard errors of a last step, which leaves a twentieth of that or less
ROUGH = 30.0        # standard errors where only a few rollouts are looked at
FEW = 8             # rollouts that bring a start near
STRAIGHT = 0.1      # of what a step should save that it may save more or less: slopes are kept;
NEARLY = 1.0        # or this many variances of the noise, in all: half a unit of log evidence
SHARES = tuple(0.5 ** k for k in range(7))  # of a step, tried until the cost does not rise
SPARSE = 4          # samples between those that show how far the bulk is off
OUTLIER = 4.0       # noise deviations beyond which a sample counts less


@dataclass(frozen=True, eq=False)
class Estimate:
    """
    A fit: the vector z (Z,), the free columns, their covariance (C, C), noise per flight (12,).

    nuisances: those of the flights; starts: initial states per flight; normal: the last
    Normal, of the columns and of all nuisances, by slopes at the vector `at` (Z,), near z;
    residuals: recorded minus predicted per flight, less what the clock explains; quiet: the
    residuals less what a slow force and moment make; cost: that of `quiet`;
    free: whether each column is inside its bounds; converged: whether the last step was small.
    """

    z: np.ndarray
    columns: list[int]
    covariance: np.ndarray
    noise: list[np.ndarray]
    nuisances: NuisanceValues
    starts: list[np.ndarray]
    normal: Normal
    at: np.ndarray
    residuals: list[np.ndarray]
    quiet: list[np.ndarray]
    cost: float
    free: np.ndarray
    converged: bool

    @property
    def vectors(self) -> list[np.ndarray]:
        """Return the vector of each flight, with its nuisances, a list of (Z,)."""
        return self.nuisances.vectors(self.z)

    @property
    def errors(self) -> np.ndarray:
        """Return the standard errors of the columns (C,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def weights_of(raw: np.ndarray, noise: np.ndarray, flight: Flight) -> np.ndarray:
    """Return the weight of each sample, 1 but for those far beyond noise and bulk (Huber)."""
    seen = seen_along(flight)
    bulk = MAD * np.median(np.abs(raw.reshape(-1, raw.shape[-1])[::SPARSE]), axis=0)
    far = OUTLIER * np.maximum(noise, bulk)
    return seen * np.sqrt(np.minimum(1.0, far / np.maximum(np.abs(raw), 1e-300)))


def estimate(flights: Sequence[Flight], vehicle: Vehicle, z: np.ndarray, columns: Iterable[int],
             *, noise: list[np.ndarray] | None = None, nuisances: NuisanceValues | None = None,
             starts: list[np.ndarray] | None = None, iterations: int = ITERATIONS,
             clock: bool = True, slopes: Slopes | None = None, scatter: float = 1.0,
             slow: np.ndarray | None = None) -> Estimate:
    """
    Return the Estimate of the columns of z that predicts the flights best.

    Output error over short rollouts with free initial states, weighed by the noise, which is
    estimated along unless it is given; outliers count less; with `clock` each flight's pose may
    be off in time against the rest; nuisances: what else differs by flight. Without
    `starts` (B, 13) per flight, the initial states, a few of the rollouts first bring z near.
    iterations: how often slopes are made, at most; slopes: Slopes near, by which the first step is
    tried, whereupon as many steps more may go by slopes that are kept; scatter: what differences
    of the cost are divided by: the more, the sooner a step is small; slow (6,): standard
    deviation of a force (N) and a moment (N m), body, that nothing explains and that lasts for a
    rollout, by which autocorrelated errors count less (generalised least squares).
    """
    columns = list(columns)
    nuisances = nuisances or NuisanceValues.of((), len(flights))
    box = limits(vehicle)[:, columns]
    if starts is None:
        few = [_fewer(flight, max(1, FEW // len(flights))) for flight in flights]
        if 2 * sum(len(flight.first) for flight in few) <= sum(len(f.first) for f in flights):
            near = _descend(few, vehicle, z, columns, box, noise, nuisances,
                            settled(few, vehicle, nuisances.vectors(z), noise), iterations, clock,
                            ROUGH, slow=slow)
            z, nuisances = near.z, near.nuisances
        starts = settled(flights, vehicle, nuisances.vectors(z), noise)
    return _descend(flights, vehicle, z, columns, box, noise, nuisances, starts, iterations, clock,
                    DONE, slopes, max(1.0, scatter), slow)


def _fewer(flight: Flight, count: int) -> Flight:
    """Return a flight with `count` of its rollouts or a few more, spread over all of it."""
    skip = max(1, len(flight.first) // count)
    return replace(flight, first=flight.first[skip // 2::skip])


def _descend(flights: Sequence[Flight], vehicle: Vehicle, z: np.ndarray, columns: list[int],
             box: np.ndarray, noise: list[np.ndarray] | None, nuisances: NuisanceValues,
             starts: list[np.ndarray], iterations: int, clock: bool, done: float,
             slopes: Slopes | None = None, scatter: float = 1.0,
             slow: np.ndarray | None = None) -> Estimate:
    """Return the Estimate from z by steps of Gauss and Newton that do not raise the cost."""
    layout = Layout(columns, nuisances.columns, len(flights))
    shared, lower, upper, size, precision = _whole(box, nuisances, len(flights))
    known, z = noise, np.array(z, float)
    raws = [errors_along(flight, vehicle, vector, start)
            for flight, vector, start in zip(flights, nuisances.vectors(z), starts, strict=True)]
    noise = known or [quick_noise(raw) for raw in raws]
    tangents, at, converged = None, z, False
    if slopes:
        tangents, at = slopes.of(layout.wanted, slow is not None), slopes.at
    made = 0
    for count in range(2 * iterations):
        fresh = tangents is None
        if fresh and made == iterations:
            break
        if tangents is None:
            made += 1
            tangents = slopes_at(
                flights, vehicle, z, nuisances.vectors(z), starts,
                sorted({*layout.wanted, *(WRENCH if slow is not None else ())})).of(
                    layout.wanted, slow is not None)
            at = z
        scales = [weights_of(raw, sigma, flight) / sigma
                  for raw, sigma, flight in zip(raws, noise, flights, strict=True)]
        wrenches = [tangent.wrench for tangent in tangents]
        whites = _whitenings(wrenches, scales, slow)
        # The basis says how much of the noise the initial states take up.
        linears = [linear_of(tangent, raw, scale, clock, white, with_basis=known is None)
                   for tangent, raw, scale, white
                   in zip(tangents, raws, scales, whites, strict=True)]
        normal = normal_of(linears, flights, layout, clock)
        now = np.concatenate([z[columns], nuisances.values.ravel()])
        information = normal.information + precision
        gradient = normal.gradient - precision @ now
        step, free = bounded_step(information, gradient, now, lower, upper, size)
        told = _aligned(raws, tangents, scales, clock, whites)
        before = _cost(told, scales, whites) + now @ precision @ now
        for share in SHARES if fresh else SHARES[:1]:
            there, new = z.copy(), now + share * step
            there[columns] = new[:shared]
            theirs = replace(nuisances, values=new[shared:].reshape(nuisances.values.shape))
            moves = [layout.of_flight(share * step, k) for k in range(len(flights))]
            moved = [new_starts(linear, start, np.append(move, _clock(linear, move)) if clock
                                else move)
                     for linear, start, move in zip(linears, starts, moves, strict=True)]
            residuals = [errors_along(flight, vehicle, vector, start) for flight, vector, start in
                         zip(flights, theirs.vectors(there), moved, strict=True)]
            aligned = _aligned(residuals, tangents, scales, clock, whites)
            after = _cost(aligned, scales, whites) + new @ precision @ new
            if after <= before * (1.0 + 1e-9):
                break
        else:
            if fresh:
                break
            tangents = None
            continue
        z, nuisances, starts, raws, told = there, theirs, moved, residuals, aligned
        if known is None:
            noise = [whole_noise(part, linear.freedom)
                     for part, linear in zip(aligned, linears, strict=True)]
        # In units of the noise, so that directions that are not determined do not count.
        length = np.sqrt(max(step @ normal.information @ step, 0.0) / max(1, len(step)))
        # Where a step ends at the cost that the slopes say, they are what they were; a fit that is
        # not one of many makes them anew, for its standard errors are those of its end.
        saved = step @ (2.0 * gradient - information @ step)
        said = normal.cost + now @ precision @ now - saved
        straight = (slopes is not None and share == 1.0
                    and abs(after - said) <= max(STRAIGHT * saved, NEARLY * scatter))
        # The first step is weighed by a first guess of the noise.
        if (share == 1.0 and length <= done * np.sqrt(scatter) and (known or count)
                and (fresh or straight)):
            converged = True
            break
        if not straight:
            tangents = None
    covariance = covariance_of(marginal(normal, shared, precision), size[:shared])
    # By the weights of these errors, not of those before the last step, to be held against others.
    scales = [weights_of(raw, sigma, flight) / sigma
              for raw, sigma, flight in zip(raws, noise, flights, strict=True)]
    whites = _whitenings(wrenches, scales, slow)
    return Estimate(z, columns, covariance, noise, nuisances, starts, normal, at, told,
                    _quiet(told, scales, whites), _cost(told, scales, whites), free[:shared],
                    converged)


def _whole(box: np.ndarray, nuisances: NuisanceValues, count: int
           ) -> tuple[int, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return how many columns are shared; bounds, sizes, precision of these and all nuisances."""
    lower, upper, size = box
    spreads = np.tile(nuisances.spreads, count)
    wide = np.full(len(spreads), np.inf)
    return (len(size), np.append(lower, -wide), np.append(upper, wide), np.append(size, spreads),
            scipy.linalg.block_diag(np.zeros((len(size), len(size))), nuisances.precision))


def _whitenings(wrenches: Iterable[np.ndarray | None], scales: Iterable[np.ndarray],
                slow: np.ndarray | None) -> list[Whitening | None]:
    """Return the Whitening of each flight, None where no slow force or moment is expected."""
    return [None if slow is None or wrench is None else whitening_of(wrench, scale, slow)
            for wrench, scale in zip(wrenches, scales, strict=True)]


def _aligned(raws: list[np.ndarray], tangents: Iterable[Tangent], scales: Iterable[np.ndarray],
             clock: bool, whites: Iterable[Whitening | None]) -> list[np.ndarray]:
    """Return errors without what an offset of each flight's clock explains."""
    if not clock:
        return raws
    out = []
    for raw, tangent, scale, white in zip(raws, tangents, scales, whites, strict=True):
        drift, error = (_weighed(part, scale, white) for part in (tangent.drift, raw))
        share = np.sum(drift * error) / max(np.sum(drift * drift), 1e-300)
        out.append(raw - share * tangent.drift)
    return out


def _weighed(error: np.ndarray, scale: np.ndarray, white: Whitening | None) -> np.ndarray:
    """
    Return errors (B, count + 1, 12) over their noise, made white.

    Not finite where the predictions of a step that is too large are not; no such step is taken.
    """
    with np.errstate(invalid='ignore'):
        error = error * scale
    return error if white is None else white.whitened(error.reshape(len(error), 1, -1))


def _cost(raws: Iterable[np.ndarray], scales: Iterable[np.ndarray],
          whites: Iterable[Whitening | None]) -> float:
    """Return the sum of squares of errors over their noise, made white; as _weighed not finite."""
    with np.errstate(over='ignore'):
        return sum(float(np.sum(_weighed(raw, scale, white) ** 2))
                   for raw, scale, white in zip(raws, scales, whites, strict=True))


def _quiet(raws: Iterable[np.ndarray], scales: Iterable[np.ndarray],
           whites: Iterable[Whitening | None]) -> list[np.ndarray]:
    """Return errors (B, count + 1, 12) without what a slow force and moment make of them."""
    found = []
    for raw, scale, white in zip(raws, scales, whites, strict=True):
        if white is not None:
            slow = white.slow_part((raw * scale).reshape(len(raw), 1, -1)).reshape(raw.shape)
            raw = raw - slow / np.maximum(scale, 1e-300)
        found.append(raw)
    return found


def settled(flights: Sequence[Flight], vehicle: Vehicle, vectors: Sequence[np.ndarray],
            noise: Sequence[np.ndarray] | None = None) -> list[np.ndarray]:
    """
    Return the initial states (B, 13) per flight that fit best at its vector, all samples alike.

    Args: vectors: a vector (Z,) per flight.
    """
    found = []
    for k, (flight, z) in enumerate(zip(flights, vectors, strict=True)):
        starts = flight.states[flight.first]
        sigma = noise[k] if noise else quick_noise(errors_along(flight, vehicle, z, starts))
        found.append(new_starts(linearise(flight, vehicle, z, starts, [], sigma, False,
                                          seen_along(flight)), starts, np.zeros(0)))
    return found


def _clock(linear: Linear, move: np.ndarray) -> float:
    """Return the offset of a flight's clock (s) that goes with a step of its parameters."""
    ties, size = linear.products[:, -1].sum(axis=0), linear.products[:, -1, -1].sum()
    return float((linear.cross[:, -1].sum() - ties[:-1] @ move) / max(size, 1e-300))
