# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a made fleet is: which vehicles fly when, with which effects, and what happens to them."""

from dataclasses import dataclass
from datetime import datetime, timedelta, timezone

import numpy as np

FIRST = datetime(2026, 3, 2, 9, 0, tzinfo=timezone.utc)
EVERY = 3.5             # days between two flights of a vehicle
TOGETHER = 5            # flights of a vehicle that are diagnosed together
LASTING = 8             # flights at least before and after a change
BAD = 0.05              # share of the logs that are wrong
KINDS = ('cut', 'rubbish', 'swapped', 'frozen', 'degrees', 'late')
"""What is wrong with a log: see make.spoilt."""

# What all vehicles have beside the nominal one, from vehicle to vehicle, from flight to flight.
DRAG = 0.06, 0.06, 0.02         # kg/s; shares of it
LAG = 0.030, 0.04, 0.02         # s; shares of it
BALANCE = 0.0, 0.5e-3, 0.2e-3   # m, of the centre of mass
THRUST = 1.0, 0.01, 0.004       # factor
WARM, SWING, WEATHER = 15.0, 10.0, 3.0   # degrees C: mean, of the year, of a day
DENSITY = 1.0 / 288.0           # share of its density that air loses per degree

CHANGES = {'com_offset': ('x', 4e-3), 'thrust_scale': ('factor', -0.04),
           'rotor_drag': ('coefficient', 0.04)}
"""Effect, parameter and step of each change: a battery moved, other propellers, guards."""
DRIFT = ('thrust_scale', 'factor', -0.004)
"""Effect, parameter and slope per week of the drift: propellers that wear."""
STRANGE = {'com_offset': ('y', 6e-3), 'motor_lag': ('time_constant', 0.025)}
"""Effect, parameter and difference from its sisters of each odd vehicle."""


@dataclass(frozen=True)
class Flown:
    """
    A flight: when, at which temperature (degrees C), with which effects, and what spoils its log.

    number: of the flight of its vehicle, from 0; spoilt: one of KINDS, or ''.
    """

    vehicle: str
    number: int
    date: datetime
    temperature: float
    effects: dict
    spoilt: str
    seed: int


@dataclass(frozen=True)
class Truth:
    """
    A fleet: its flights, and what is to be found.

    changes, odd: {vehicle: (effect, parameter, ...)}; a change has the number of the first flight
    after it; drifts: {vehicle: (effect, parameter, per week)}.
    """

    flights: tuple[Flown, ...]
    changes: dict
    drifts: dict
    odd: dict

    def as_data(self) -> dict:
        """Return what is to be found, as data."""
        return {'changes': self.changes, 'drifts': self.drifts, 'odd': self.odd,
                'spoilt': {f'{one.vehicle}/{one.number:02d}': one.spoilt for one in self.flights
                           if one.spoilt},
                'flights': len(self.flights)}


def truth_of(vehicles: int, flights: int, rng: np.random.Generator) -> Truth:
    """
    Return the Truth of a fleet of so many vehicles with so many flights each.

    Raises ValueError where there are too few of them for what is to happen.
    """
    special = len(CHANGES) + 1 + len(STRANGE)
    if vehicles < special + 4 or flights <= 2 * LASTING:
        raise ValueError(f'a fleet needs {special + 4} vehicles and {2 * LASTING + 1} flights '
                         'of each, at least')
    names = [f'uav{k + 1:02d}' for k in range(vehicles)]
    chosen = iter(rng.permutation(names)[:special].tolist())
    changes = {next(chosen): (effect, *step, int(rng.integers(LASTING, flights - LASTING)))
               for effect, step in CHANGES.items()}
    drifts = {next(chosen): DRIFT}
    odd = {next(chosen): (effect, *apart) for effect, apart in STRANGE.items()}
    bad = set(rng.permutation(vehicles * flights)[:round(BAD * vehicles * flights)].tolist())
    flown = []
    for place, name in enumerate(names):
        usual = _vehicle(rng)
        if name in odd:
            effect, parameter, apart = odd[name]
            usual[effect][parameter] += apart
        days = EVERY * np.arange(flights) + rng.uniform(0.0, 0.3 * EVERY, flights)
        for number, day in enumerate(days):
            warm = (WARM + SWING * np.sin(2 * np.pi * (day - 40.0) / 365.25)
                    + WEATHER * rng.standard_normal())
            effects = _flight(usual, rng)
            effects['thrust_scale']['factor'] *= 1.0 - DENSITY * (warm - WARM)
            if name in changes and number >= changes[name][3]:
                effect, parameter, step, _ = changes[name]
                effects[effect][parameter] += step
            if name in drifts:
                effect, parameter, slope = drifts[name]
                effects[effect][parameter] += slope * day / 7.0
            spoilt = str(rng.choice(KINDS)) if place * flights + number in bad else ''
            flown.append(Flown(name, number, FIRST + timedelta(days=float(day)), float(warm),
                               effects, spoilt, int(rng.integers(2 ** 31))))
    return Truth(tuple(flown), changes, drifts, odd)


def _vehicle(rng: np.random.Generator) -> dict:
    """Return {effect: {parameter: value}} of a vehicle."""
    return {'rotor_drag': {'coefficient': DRAG[0] * (1.0 + DRAG[1] * rng.standard_normal())},
            'motor_lag': {'time_constant': LAG[0] * (1.0 + LAG[1] * rng.standard_normal())},
            'com_offset': {axis: BALANCE[1] * rng.standard_normal() for axis in 'xy'},
            'thrust_scale': {'factor': THRUST[0] + THRUST[1] * rng.standard_normal()}}


def _flight(usual: dict, rng: np.random.Generator) -> dict:
    """Return those of one of its flights: batteries never sit in the same place."""
    drag, lag = (usual[name][key] for name, key in (('rotor_drag', 'coefficient'),
                                                    ('motor_lag', 'time_constant')))
    return {'rotor_drag': {'coefficient': drag * (1.0 + DRAG[2] * rng.standard_normal())},
            'motor_lag': {'time_constant': lag * (1.0 + LAG[2] * rng.standard_normal())},
            'com_offset': {axis: value + BALANCE[2] * rng.standard_normal()
                           for axis, value in usual['com_offset'].items()},
            'thrust_scale': {'factor': usual['thrust_scale']['factor']
                             + THRUST[2] * rng.standard_normal()}}
