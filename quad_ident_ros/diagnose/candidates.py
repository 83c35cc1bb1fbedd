# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What may be named as a cause, and which columns of the parameter vector that frees."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.effects.registry import EFFECTS, PLACE, SLICES
from quad_ident_ros.greybox.own import nuisances
from quad_ident_ros.greybox.parameters import SPLIT

VOLTAGE = 0.02      # V that the battery must fall for its voltage to tell anything


@dataclass(frozen=True)
class Candidate:
    """
    An effect, or one of the rotors or of the ways in which it may act, and its columns.

    own: the greybox.own.Nuisance that it is instead of an effect, or None.
    """

    effect: str
    label: str
    columns: tuple
    own: object = None


def candidates(flights, vehicle, effects=None):
    """Return the Candidates, in the order of the registry; effects: names, by default all."""
    found = []
    voltage = any(np.ptp(flight.course.volt_drop) > VOLTAGE for flight in flights)
    for name, effect in EFFECTS.items():
        if effects is not None and name not in effects:
            continue
        first = SPLIT + SLICES[name].start
        columns = tuple(range(first, SPLIT + SLICES[name].stop))
        if effect.per_rotor:
            found += [Candidate(name, f'{name} {j + 1}', (first + j,))
                      for j in range(len(vehicle.rotors))]
        elif name == 'battery_sag':
            # By the volt where there are any, or by the second: one of the two.
            found += [Candidate(name, f'{name} {key}', (SPLIT + PLACE[name, key],))
                      for key in (('per_volt', 'per_second') if voltage else ('per_second',))]
        else:
            found.append(Candidate(name, name, columns))
    return tuple(found)


def own_candidates(vehicle, tracks):
    """Return the Candidates for what Tracks have of their own, which is no effect."""
    return tuple(Candidate(kind.name, kind.name, kind.columns, kind)
                 for kind in nuisances(vehicle, tracks))
