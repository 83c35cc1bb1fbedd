# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Nuisances of flights, which are not effects: clocks, trims, biases, thrust and wind by flight.

An effect is shared by flights. What differs from one flight to the next is added to the
parameters of each one, about zero and about as wide as its usual spread.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from quad_ident_ros.effects.registry import EFFECTS, GUSTS
from quad_ident_ros.greybox.flights import inertial, Track
from quad_ident_ros.greybox.parameters import INDEX
from quad_ident_ros.model.vehicle import Vehicle

CLOCK = 'clock_offset'
CLOCK_TITLE = 'how much later than the commands the states are stamped'
TRIM = 'trim_moment'
LEVEL = 'thrust_level'
LEVEL_TITLE = 'thrust relative to the level at which commands were scaled to carry the weight'
HEADING = 0.02      # rad, how far compasses usually differ from one flight to the next
GUST = 1.0          # m/s, of light turbulence (MIL-F-8785C: a tenth of the wind at 20 feet)
OFF_LEVEL = 0.1     # how far that usually is off: drag, wind, a battery that empties
RARE, LIKELY = 1e-4, 0.5    # probability that flights have one, before looking
APART = 0.02        # s, how far clocks usually are apart where nothing shows it,
REST = 0.001        # s, or
REST_SHARE = 0.2    # periods, how far where they were put right
# Of a spread, how far from zero the mean over the flights may be: where an effect acts nearly
# alike; where flights have it alike, for half a hundredth turns a vehicle of 30 g by a floor of
# Rules.
NEARLY_ZERO, ZERO = 0.01, 1e-4


@dataclass(frozen=True)
class Nuisance:
    """
    A kind of it.

    name, what it is, unit, places in z and its usual spread from 0 there, SI; prior: probability
    that flights have it, before looking; of_effect: the name of the effect that differs by flight,
    or '';
    shared: the name of the effect that it is where flights have it alike, or ''; mean_shares,
    where it is the vehicle's then, though no one effect: of each place, how far from zero the
    mean over several flights may be, of a spread, and inf where it is free.
    """

    name: str
    title: str
    unit: str
    columns: tuple[int, ...]
    spreads: tuple[float, ...]
    prior: float
    of_effect: str = ''
    shared: str = ''
    mean_shares: tuple[float, ...] = ()

    @property
    def differing(self) -> Nuisance:
        """Return the same by which flights only differ: all its values sum to zero."""
        return replace(self, mean_shares=(ZERO,) * len(self.columns))


def put_right(tracks: Sequence[Track]) -> bool:
    """Return whether the clocks of all Tracks are known and those of some were apart."""
    clocks = [track.clock for track in tracks if track.clock is not None]
    return len(clocks) == len(tracks) and any(clock.late for clock in clocks)


def nuisances(vehicle: Vehicle, tracks: Sequence[Track], gusty: bool = False
              ) -> tuple[Nuisance, ...]:
    """
    Return the Nuisances of Tracks of a vehicle; gusty: the wind may change along a flight, too.

    Those with one name exclude one another: how far flights usually differ depends on who flies.
    Records whose clocks were put right are likely to have a rest of their offset.
    """
    rate = tuple(f'gyro_bias.{axis}' for axis in 'xyz')
    tilt = tuple(f'attitude_misalignment.{axis}' for axis in ('roll', 'pitch', 'yaw'))
    moment = tuple(f'external_wrench.moment_{axis}' for axis in 'xyz')
    apart, prior = APART, RARE
    if put_right(tracks):
        apart = max(REST, REST_SHARE * max(track.clock.period for track in tracks if track.clock))
        prior = LIKELY
    kinds: list[tuple] = []
    # Inertial flights have one clock and no attitude, and slow moments count for little there.
    if not inertial(tracks):
        # Unless clocks are known, an offset that all flights share is a delay of the actuators.
        alike = '' if put_right(tracks) else 'actuation_delay'
        kinds.append((CLOCK, CLOCK_TITLE, 's', ('actuation_delay.delay',), (apart,), prior, '',
                      alike))
        kinds += [('rate_bias', 'bias of the rate', 'rad/s', rate, (spread,) * 3, RARE, '',
                   'gyro_bias') for spread in (0.01, 0.003)]
        kinds += [('attitude_bias', 'tilt of the attitude', 'rad', tilt, (spread,) * 3, RARE, '',
                   'attitude_misalignment') for spread in (0.005, 0.0015)]
        kinds.append(('heading', 'offset of the recorded heading from the axes of the position',
                      'rad', ('attitude_misalignment.heading',), (HEADING,), RARE, '',
                      'attitude_misalignment'))
        # What tilts or turns all flights alike is the vehicle's: a weak rotor, a centre of mass
        # that is off, or something unknown.
        kinds.append((TRIM, 'moment', 'N m', moment, tuple(trim_wrench(vehicle)[3:]), RARE, '', '',
                      (NEARLY_ZERO, NEARLY_ZERO, np.inf)))
    level = any(track.levelled for track in tracks)
    if level:
        kinds.append((LEVEL, LEVEL_TITLE, '1', ('thrust_scale.factor',), (OFF_LEVEL,), LIKELY))
    # One flight does not separate what is its own from what is the vehicle's.
    for name, effect in EFFECTS.items() if len(tracks) > 1 else ():
        if level and effect.ratio is not None:
            continue    # the same by another name
        if inertial(tracks) and effect.forms[0].needs_reference:
            continue
        differing = [(parameter, spread) for parameter, spread in
                     zip(effect.forms[0].parameters, effect.per_flight, strict=False) if spread]
        if differing:
            kinds.append((f'{name}_by_flight', f'{effect.title}, by flight', differing[0][0].unit,
                          tuple(f'{name}.{parameter.name}' for parameter, _ in differing),
                          tuple(spread for _, spread in differing), RARE, name, name))
    if gusty:
        names = tuple(f'{GUSTS.name}.{one.name}' for one in GUSTS.parameters)
        kinds.append((GUSTS.name, GUSTS.title, 'm/s', names, (GUST,) * len(names), RARE, 'wind'))
    return tuple(Nuisance(name, title, unit, tuple(INDEX[one] for one in columns), *rest)
                 for name, title, unit, columns, *rest in kinds)


def trim_wrench(vehicle: Vehicle) -> np.ndarray:
    """
    Return the force (N) and moment (N m), body, (6,), of the usual trim of vehicles.

    Some hundredths of what the rotors give: a motor or a propeller differs by as much.
    """
    weight = vehicle.mass * vehicle.gravity
    twist = weight * vehicle.torque_coefficient / vehicle.thrust_coefficient
    lever = weight * vehicle.arm_length
    return np.array([0.02 * weight] * 3 + [0.02 * lever, 0.02 * lever, 0.05 * twist])


def are_alike(values: np.ndarray, spreads: np.ndarray, chance: float) -> bool:
    """
    Return whether values (F, K) of flights share more than flights that differ by chance do.

    By the F statistic of the mean over the flights by the variance between them: of each place,
    and of all together in units of their usual spreads (K,). Any of these is as large in a share
    `chance` of such flights at most (Bonferroni's bound).
    """
    count, places = values.shape
    if count < 2:
        return False
    scaled = values / spreads
    shared, apart = count * scaled.mean(axis=0) ** 2, scaled.var(axis=0, ddof=1)

    def rare(number: int, share: float) -> float:
        """Return the F statistic of so many places that a share of flights exceeds."""
        return float(scipy.stats.f.ppf(1.0 - share, number, number * (count - 1)))

    if places == 1:
        return bool(shared[0] > rare(1, chance) * apart[0])
    return bool(np.any(shared > rare(1, 0.5 * chance / places) * apart)
                or shared.sum() > rare(places, 0.5 * chance) * apart.sum())


@dataclass(frozen=True, eq=False)
class NuisanceValues:
    """
    Places in z (K,) of the nuisances of flights, their spreads (K,) and values (F, K).

    mean_shares (K,): as of Nuisance, inf where free;
    fixed (F, Z): what is added to the vector of each flight and is not estimated, or None.
    """

    columns: tuple[int, ...]
    spreads: np.ndarray
    values: np.ndarray
    mean_shares: np.ndarray
    fixed: np.ndarray | None = None

    @classmethod
    def of(cls, kinds: Sequence[Nuisance], count: int,
           known: NuisanceValues | None = None) -> NuisanceValues:
        """
        Return those of kinds of Nuisance in so many flights, with the values of a known one.

        Where several stand for the same columns the first one has the values.
        """
        columns = tuple(column for kind in kinds for column in kind.columns)
        spreads = np.array([spread for kind in kinds for spread in kind.spreads], float)
        shares = np.array([share for kind in kinds for share in
                           kind.mean_shares or (np.inf,) * len(kind.columns)], float)
        values = np.zeros((count, len(columns)))
        for k, column in enumerate(columns):
            if known is not None and column not in columns[:k]:
                same = np.array(known.columns, int) == column
                values[:, k] = known.values[:, same].sum(axis=1)
        return cls(columns, spreads, values, shares)

    @property
    def precision(self) -> np.ndarray:
        """
        Return the precision, (F K, F K), of the prior of all values, flight by flight.

        That of independent values, and for those of several flights that sum to zero a mean that
        is nearly none (Gelman and Hill, Data Analysis Using Regression, 2007, section 19.4).
        """
        count = len(self.values)
        mean = np.full((count, count), 1.0 / count if count > 1 else 0.0)
        return (np.kron(np.eye(count), np.diag(self.spreads ** -2.0))
                + np.kron(mean, np.diag((self.spreads * self.mean_shares) ** -2.0)))

    def vectors(self, z: np.ndarray) -> list[np.ndarray]:
        """Return z (Z,) with the nuisances of each flight, a list of (Z,)."""
        found = []
        for k, values in enumerate(self.values):
            vector = np.array(z, float) if self.fixed is None else z + self.fixed[k]
            np.add.at(vector, list(self.columns), values)
            found.append(vector)
        return found


class Layout:
    """
    Where the columns that flights share and those of their nuisances stand in one vector.

    wanted: places in z to be linearised in; rows: of these, the shared ones and those of a
    flight; size of the vector: shared, then those of each flight.
    """

    def __init__(self, shared: Sequence[int], nuisances: Sequence[int], count: int) -> None:
        self.wanted = sorted({*shared, *nuisances})
        self.shared, self.nuisances = len(shared), len(nuisances)
        self.rows = [self.wanted.index(column) for column in (*shared, *nuisances)]
        self.size = self.shared + count * self.nuisances

    def places(self, number: int) -> list[int]:
        """Return where the rows of a flight stand in the vector."""
        first = self.shared + number * self.nuisances
        return [*range(self.shared), *range(first, first + self.nuisances)]

    def of_flight(self, vector: np.ndarray, number: int) -> np.ndarray:
        """Return the part (wanted,) of a vector that moves a flight's parameters."""
        out = np.zeros(len(self.wanted))
        np.add.at(out, self.rows, vector[self.places(number)])
        return out
