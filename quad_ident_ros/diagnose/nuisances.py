# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The nuisances of each flight, which are reported apart from effects."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.data.clocks import Clock, controllers_own, SURE
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.selection import Selection
from quad_ident_ros.diagnose.state_filter import follows_gyro
from quad_ident_ros.effects.registry import EFFECTS, PARAMETERS
from quad_ident_ros.greybox.estimate import estimate
from quad_ident_ros.greybox.flights import Flight, flight_of, Track
from quad_ident_ros.greybox.linear import slopes_at, WRENCH
from quad_ident_ros.greybox.nuisances import (
    APART,
    CLOCK,
    CLOCK_TITLE,
    Nuisance,
    NuisanceValues,
    put_right,
)
from quad_ident_ros.greybox.parameters import nominal, SPLIT
from quad_ident_ros.model.vehicle import Vehicle

WIDE = 1.64     # standard errors below which 95 % lie, of a bound that is only reported
DELAY = 'actuation_delay'


def nuisances_of(track: Track, vehicle: Vehicle, z: np.ndarray, kinds: Sequence[Nuisance],
                 noise: np.ndarray, segment: float, fixed: np.ndarray | None = None,
                 slow: np.ndarray | None = None) -> np.ndarray:
    """
    Return the nuisances (Z,) of a Track that was not learnt from, beside a vector z.

    fixed (Z,): what is held in it; slow as of estimate.
    """
    fixed = np.zeros(len(z)) if fixed is None else fixed
    if not kinds:
        return fixed
    flight = flight_of(track, segment)
    # Nuisances are small: they are fitted together with the initial states, from those recorded,
    # and by the slopes there as long as these hold, because nobody asks for standard errors.
    values, starts = NuisanceValues.of(kinds, 1), [flight.states[flight.first]]
    columns = sorted({*values.columns, *(WRENCH if slow is not None else ())})
    slopes = slopes_at([flight], vehicle, z, [z + fixed], starts, columns)
    found = estimate([flight], vehicle, z, [], noise=[noise],
                     nuisances=replace(values, fixed=fixed[None]), starts=starts, slopes=slopes,
                     slow=slow)
    return found.vectors[0] - z


def late_states(selection: Selection, flights: Sequence[Flight], vehicle: Vehicle, rules: Rules
                ) -> float:
    """
    Return by how much later (s) the states of a Selection's flights may be stamped, or 0.

    What was found of delays and lags of the actuators counts as such where it is no more than the
    controller's own lag, or the low pass of the gyro, may be.
    """
    return (late_controller(selection, flights, vehicle)
            or late_gyro(selection, flights, vehicle, rules))


def late_gyro(selection: Selection, flights: Sequence[Flight], vehicle: Vehicle, rules: Rules
              ) -> float:
    """
    Return the delays and lags (s) that a Selection found where the gyro's low pass may be all.

    It makes the rate late, and an attitude that a filter has from it as much: no record shows that
    apart from actuators that answer later. No more than the low pass is counted so.
    """
    best, null = selection.best, nominal(vehicle)
    if not follows_gyro(best.estimate, flights, rules):
        return 0.0
    weights, late = np.zeros(len(best.estimate.columns)), 0.0
    for cause in best.causes:
        columns = [column for column in cause.columns if EFFECTS[cause.effect].actuator]
        later = [PARAMETERS[column - SPLIT][1].later for column in columns]
        part = sum(weight * (best.estimate.z[column] - null[column])
                   for weight, column in zip(later, columns, strict=True))
        # Less of a lag than the file has, or one that is no time, is not the gyro's.
        if columns and (part < 0.0 or not any(later)):
            return 0.0
        late += part
        weights[[best.estimate.columns.index(column) for column in columns]] = later
    # That a gyro is late is what is asked here, and no error of the answer.
    error = float(np.sqrt(max(weights @ selection.covariance_by_noise @ weights, 0.0)))
    return min(float(late), rules.low_pass) if late - SURE * error <= rules.low_pass else 0.0


def late_controller(selection: Selection, flights: Sequence[Flight], vehicle: Vehicle) -> float:
    """
    Return the delay (s) that a Selection found where it may be the controller's own lag, or 0.

    It counts from the delay that the vehicle file has. Where clocks were put right by what
    commands answer, a controller that answers late looks like commands that act late. It is
    counted among the clocks where controllers may be that late.
    """
    best = selection.best
    [columns] = [cause.columns for cause in best.causes if cause.effect == DELAY] or [()]
    if not columns or not put_right(flights):
        return 0.0
    [column] = columns
    place = best.estimate.columns.index(column)
    error = float(np.sqrt(max(selection.covariance_by_noise[place, place], 0.0)))
    delay = best.estimate.z[column] - nominal(vehicle)[column]
    period = max(flight.clock.period for flight in flights if flight.clock is not None)
    return float(delay) if controllers_own(delay, error, period) else 0.0


def as_data(kinds: Sequence[Nuisance], flights: Sequence[np.ndarray], late: Sequence[dict],
            clocks: Sequence[Clock | None], prompt: float) -> dict | None:
    """
    Return as data, by Nuisance, what the nuisances (Z,) of flights are, the held-out one last.

    late: {stream: s}, what was moved as it was stamped late, and clocks: the Clock, or None, of
    each flight, the held-out one last; prompt: s of a delay that may be the controller's own lag
    and is counted with the clocks. Of clocks also the longest delay (s) that they may hide.
    """
    found = {kind.name: _each(kind.title, kind.unit,
                              [vector[list(kind.columns)] for vector in flights])
             for kind in kinds}
    hidden = prompt
    for kind in kinds:
        if kind.name == CLOCK and kind.spreads == (APART,):
            fitted = np.ravel(found[CLOCK]['values'])
            hidden = prompt + float(fitted.mean() + WIDE * APART / np.sqrt(len(fitted)))
    offsets = np.array([[clock.late + prompt if clock else prompt] for clock in clocks])
    if offsets.any():
        if CLOCK in found:
            offsets += [*found[CLOCK]['values'], found[CLOCK]['held_out']]
        found[CLOCK] = _each(CLOCK_TITLE, 's', offsets)
    if CLOCK in found:
        found[CLOCK]['hidden_delay'] = hidden if hidden > 0.0 else None
    for stream in dict.fromkeys(stream for one in late for stream in one):
        found[f'{stream}_clock'] = _each(
            f'how much later than the other states the {stream} is stamped', 's',
            [[one.get(stream, 0.0)] for one in late])
    return found or None


def _each(what: str, unit: str, values: ArrayLike) -> dict:
    """Return as data what each flight has, (k,), the held-out one last."""
    *values, held_out = np.array(values, float).tolist()
    return {'what': what, 'unit': unit, 'values': values, 'held_out': held_out}
