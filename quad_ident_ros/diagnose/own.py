# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What each flight has of its own, told: clocks, trims and biases, which are no effects."""

import numpy as np

from quad_ident_ros.greybox.estimate import estimate
from quad_ident_ros.greybox.flights import flight_of
from quad_ident_ros.greybox.own import CLOCK, CLOCK_TITLE, Own

WIDE = 1.64     # standard errors below which 95 % lie


def own_of(track, vehicle, z, kinds, noise, segment):
    """Return what a Track that was not learnt from has of its own (Z,), beside a vector z."""
    if not kinds:
        return np.zeros(len(z))
    found = estimate([flight_of(track, segment)], vehicle, z, [], noise=[noise],
                     own=Own.of(kinds, 1))
    return found.vectors[0] - z


def as_data(kinds, training, held_out, late, clocks):
    """
    Return as data, by Nuisance, what flights and the held-out one have of their own, (Z,).

    late: {stream: s}, what was moved as it was stamped late, and clocks: (s, s/s), how much later
    than the commands all states are, None where the commands do not show it, of each flight, the
    held-out one last. Of clocks that none shows also the longest delay (s) that they may hide.
    """
    flights = [*training, held_out]
    found = {kind.name: _each(kind.title, kind.unit, [own[list(kind.columns)] for own in flights])
             for kind in kinds}
    shown = [clock for clock in clocks[:-1] if clock is not None]
    if CLOCK in found and not shown:
        [kind] = [kind for kind in kinds if kind.name == CLOCK]
        fitted = np.ravel(found[CLOCK]['values'])
        most = float(fitted.mean() + WIDE * kind.spreads[0] / np.sqrt(len(fitted)))
        found[CLOCK]['hidden_delay'] = most if most > 0 else None
    offsets = np.array([[clock[0] if clock else 0.0] for clock in clocks])
    if offsets.any():
        if CLOCK in found:
            offsets += [*found[CLOCK]['values'], found[CLOCK]['held_out']]
        found[CLOCK] = _each(CLOCK_TITLE, 's', offsets)
    for stream in dict.fromkeys(stream for one in late for stream in one):
        found[f'{stream}_clock'] = _each(
            f'how much later than the other states the {stream} is stamped', 's',
            [[one.get(stream, 0.0)] for one in late])
    return found or None


def _each(what, unit, values):
    """Return as data what each flight has, (k,), the held-out one last."""
    *values, held_out = np.array(values, float).tolist()
    return {'what': what, 'unit': unit, 'values': values, 'held_out': held_out}
