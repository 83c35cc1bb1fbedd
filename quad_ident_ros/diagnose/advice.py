# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the flights could not show or tell apart, and what would."""

from quad_ident_ros.diagnose import fly_next as design
from quad_ident_ros.diagnose.select import Selection
from quad_ident_ros.diagnose.verdict import Verdict
from quad_ident_ros.model.vehicle import Vehicle

ASKS = (('none',), ('undetermined',))   # verdicts that ask for another flight

SAME_MOTION = {
    ('inertia_mismatch', 'factor_x'): ('inertia about x', 'arms along y'),
    ('inertia_mismatch', 'factor_y'): ('inertia about y', 'arms along x'),
    ('inertia_mismatch', 'factor_z'): ('inertia about z', 'torque coefficient'),
    ('thrust_scale', 'factor'): ('thrust coefficient', 'mass with inertia and drag in proportion'),
}
"""Constants whose change moves a vehicle alike, by the parameter that stands for all of them."""

TELLS = {
    'inertia_mismatch': 'a ruler for the arms, a pendulum for the inertia, a thrust stand for '
                        'the torque coefficient',
    'thrust_scale': 'a scale for the mass, a thrust stand for the thrust coefficient',
}
"""What measurement tells such constants apart."""


def not_shown(selection: Selection, causes: tuple, verdict: Verdict) -> tuple[str, ...]:
    """Return the names of effects that the flights would not show at their usual size."""
    named = {*verdict.sure, *verdict.undetermined}
    return tuple(design.hidden(selection, [cause for cause in causes if cause.effect not in named],
                               list(verdict.certain)))


def fly_next(selection: Selection, flights: list, vehicle: Vehicle, z, verdict: Verdict,
             unseen: tuple) -> list | None:
    """Return what to fly next, as data, where the verdict leaves something open, else None."""
    if verdict.names not in ASKS:
        return None
    return design.fly_next(selection, flights, vehicle, z, verdict.certain, verdict.doubts,
                           unseen) or None


def one_finding(verdict: Verdict) -> tuple[dict, ...]:
    """Return what each named effect may be as well, and what measurement would tell, as data."""
    rows = []
    for row in verdict.ranking:
        if row.effect not in TELLS or row.effect not in verdict.names:
            continue
        may_be = [list(SAME_MOTION[row.effect, name]) for name in row.parameters
                  if (row.effect, name) in SAME_MOTION]
        rows.append({'effect': row.effect, 'may_be': may_be, 'tells': TELLS[row.effect]})
    return tuple(rows)
