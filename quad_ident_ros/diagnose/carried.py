# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What of a gap a vehicle closes when it has gone through the file of a simulator."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.rules import RULES, Rules
from quad_ident_ros.effects.registry import Values
from quad_ident_ros.greybox.errors import UNITS
from quad_ident_ros.greybox.flights import inertial, Track
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.vehicle import Vehicle

NOMINAL, WHOLE = 'nominal', 'vehicle'
LEAST = 1e-3    # of the gap before: what a vehicle closes less of is nothing to have a share of


@dataclass(frozen=True)
class Carried:
    """
    Gaps of several vehicles on the same flights: {vehicle: {group: gap}}, in units by group.

    horizon: s ahead; shares: {vehicle: share of what the whole vehicle closes of the velocity gap
    of the nominal one}, empty where that closes nothing.
    """

    horizon: float
    units: dict[str, str]
    gaps: dict[str, dict[str, float]]
    shares: dict[str, float]


def carried(records: Sequence[FlightRecord], before: Vehicle, whole: Vehicle,
            parts: Mapping[str, Vehicle], rules: Rules = RULES,
            on_progress: Callable[[float], object] = lambda share: None) -> Carried:
    """
    Return the gaps of a nominal vehicle, `before`, one with effects, `whole`, and parts of that.

    All on the same flights, open loop, by the definition of gap.py, and all with rotor speeds in
    the same unit: that of the records. on_progress is called with the share done. Raises
    InputError as take_in.
    """
    intake = take_in(records, whole, None, rules)
    tracks = [replace(track, guide=None) for track in (*intake.tracks, intake.held_out)]
    horizon = gaps.horizon_of(tracks, rules)
    gone = {(name, key) for name, values in whole.effects.items() for key in values
            if key not in intake.vehicle.effects.get(name, {})}
    found: dict[str, dict[str, float]] = {}
    every = {NOMINAL: before, WHOLE: whole, **parts}
    for name, vehicle in every.items():
        on_progress((1 + len(found)) / (1 + len(every)))    # the first step is the intake
        flown = replace(vehicle, effects=_without(vehicle.effects, gone))
        if inertial(intake.flights):    # the air is in the record, and the intake leaves it out
            flown = replace(flown, linear_drag=intake.vehicle.linear_drag)
        found[name] = _gap(tracks, flown, horizon)
    room = found[NOMINAL]['velocity'] - found[WHOLE]['velocity']
    shares = {name: (found[NOMINAL]['velocity'] - found[name]['velocity']) / room
              for name in parts} if room > LEAST * found[NOMINAL]['velocity'] else {}
    return Carried(horizon, dict(UNITS), found, shares)


def _gap(tracks: Sequence[Track], vehicle: Vehicle, horizon: float) -> dict[str, float]:
    """Return {group: gap} of a vehicle along Tracks."""
    z = nominal(vehicle)
    return gaps.gap([gaps.ends(track, vehicle, z, horizon) for track in tracks])


def _without(effects: Values, gone: set[tuple[str, str]]) -> Values:
    """Return effects without what the records have in what they measured."""
    return {name: {key: value for key, value in values.items() if (name, key) not in gone}
            for name, values in effects.items()}
