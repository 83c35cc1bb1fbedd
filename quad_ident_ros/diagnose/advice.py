# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the flights could not show or tell apart, and what would."""

import numpy as np

from quad_ident_ros.diagnose import fly_next as design
from quad_ident_ros.diagnose.select import Selection
from quad_ident_ros.diagnose.verdict import Verdict
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.model.vehicle import Vehicle

ASKS = (('none',), ('undetermined',))   # verdicts that ask for another flight

RATIO = tuple(name for name, effect in EFFECTS.items() if effect.ratio)
"""Effects of which only a quotient shows."""

SAME_MOTION = {
    'inertia_mismatch': (('inertia about x', 'arms along y'), ('inertia about y', 'arms along x'),
                         ('inertia about z', 'torque coefficient')),
    'thrust_scale': (('thrust coefficient', 'mass with the inertia in proportion'),),
    'mass_offset': (('mass', 'thrust coefficient with the inertia in proportion'),),
}
"""Constants that move a vehicle alike, by the effect that stands for all of them."""

TELLS = {
    'inertia_mismatch': 'a ruler for the arms, a pendulum for the inertia, a thrust stand for '
                        'the torque coefficient',
    'thrust_scale': 'a scale for the mass, a thrust stand for the thrust coefficient',
    'mass_offset': 'a scale for the mass, a thrust stand for the thrust coefficient',
}
"""What measurement tells such constants apart."""


def not_shown(selection: Selection, causes: tuple, verdict: Verdict) -> tuple[str, ...]:
    """Return the names of effects that the flights would not show at their usual size."""
    named = {*verdict.sure, *verdict.undetermined}
    return tuple(design.hidden(selection, [cause for cause in causes if cause.effect not in named],
                               list(verdict.certain)))


def fly_next(selection: Selection, flights: list, vehicle: Vehicle, z: np.ndarray,
             verdict: Verdict, unseen: tuple) -> list | None:
    """Return what to fly next, as data, where the verdict leaves something open, else None."""
    if verdict.names not in ASKS:
        return None
    return design.fly_next(selection, flights, vehicle, z, verdict.certain, verdict.doubts,
                           unseen) or None


def one_finding(verdict: Verdict) -> tuple[dict, ...]:
    """
    Return what each named effect may be as well, and what measurement would tell, as data.

    effects: names that the flights do not tell apart. Thrust and mass are told from one another by
    the moments, so not where the inertia is found to differ, too.
    """
    rows = []
    for name in verdict.names:
        if name not in TELLS:
            continue
        loose = name != 'inertia_mismatch' and 'inertia_mismatch' in verdict.names
        rows.append({'effect': name, 'may_be': [list(pair) for pair in SAME_MOTION[name]],
                     'effects': sorted(RATIO) if loose else [name], 'tells': TELLS[name]})
    return tuple(rows)
