# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What each flight has of its own, told: clocks, trims and biases, which are no effects."""

import numpy as np

from quad_ident_ros.greybox.estimate import estimate
from quad_ident_ros.greybox.flights import flight_of
from quad_ident_ros.greybox.own import CLOCK, Own

WIDE = 1.64     # standard errors below which 95 % lie


def own_of(track, vehicle, z, kinds, noise, segment):
    """Return what a Track that was not learnt from has of its own (Z,), beside a vector z."""
    if not kinds:
        return np.zeros(len(z))
    found = estimate([flight_of(track, segment)], vehicle, z, [], noise=[noise],
                     own=Own.of(kinds, 1))
    return found.vectors[0] - z


def as_data(kinds, training, held_out, late, held_out_late):
    """
    Return as data, by Nuisance, what flights and the held-out one have of their own, (Z,).

    Of clocks also the longest delay (s) of all flights that they may hide, None where none; late,
    held_out_late: {stream: s}, what was moved as it was stamped late, of each flight.
    """
    found = {kind.name: {
        'what': kind.title, 'unit': kind.unit,
        'values': [own[list(kind.columns)].tolist() for own in training],
        'held_out': held_out[list(kind.columns)].tolist()} for kind in kinds}
    if CLOCK in found:
        [kind] = [kind for kind in kinds if kind.name == CLOCK]
        offsets = np.ravel(found[CLOCK]['values'])
        most = float(offsets.mean() + WIDE * kind.spreads[0] / np.sqrt(len(offsets)))
        found[CLOCK]['hidden_delay'] = most if most > 0 else None
    for stream in dict.fromkeys(stream for one in (*late, held_out_late) for stream in one):
        found[f'{stream}_clock'] = {
            'what': f'how much later than the other states the {stream} is stamped',
            'unit': 's',
            'values': [[one.get(stream, 0.0)] for one in late],
            'held_out': [held_out_late.get(stream, 0.0)]}
    return found or None
