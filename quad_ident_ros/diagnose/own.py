# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What each flight has of its own, told: clocks, trims and biases, which are no effects."""

from itertools import combinations

import numpy as np

from quad_ident_ros.diagnose.candidates import own_candidates
from quad_ident_ros.diagnose.evidence import linear_evidence, Quadratic
from quad_ident_ros.greybox.estimate import estimate
from quad_ident_ros.greybox.flights import flight_of
from quad_ident_ros.greybox.normal import scatter_of
from quad_ident_ros.greybox.own import CLOCK, Own

WIDE = 1.64     # standard errors below which 95 % lie


def own_of(track, vehicle, z, kinds, noise, segment):
    """
    Return what a Track that was not learnt from has of its own (Z,), beside z, and its Nuisances.

    kinds: those of the flights that were learnt from. Where these are alike this one need not be:
    others are added as far as its evidence is for them.
    """
    flight, known = flight_of(track, segment), {kind.name for kind in kinds}
    causes = {cause.own: cause for cause in own_candidates(vehicle) if cause.own in kinds}
    for cause in own_candidates(vehicle):
        if cause.effect not in known:
            causes[cause.own] = cause
            known.add(cause.effect)

    def fitted(chosen):
        return estimate([flight], vehicle, z, [], noise=[noise], own=Own.of(chosen, 1))

    fit = fitted(causes)
    needed = _needed(fit, causes, kinds)
    if not needed:
        return np.zeros(len(z)), needed
    if len(needed) < len(causes):
        fit = fitted(needed)
    return fit.vectors[0] - z, needed


def _needed(fit, causes, kinds):
    """Return which kinds (keys of causes) have the most evidence in a fit of all, `kinds` too."""
    now, wide = fit.own.values[0], fit.own.spreads
    beyond = np.full(len(wide), np.inf)
    # Where a fit has settled, the pull of the errors is that of the prior.
    quadratic = Quadratic(fit.normal.information, now / wide ** 2, 0.0, now, wide, -beyond, beyond,
                          float(np.median(scatter_of(fit.normal))))
    ends = np.cumsum([len(kind.columns) for kind in causes])
    rows = {cause: list(range(end - len(kind.columns), end))
            for (kind, cause), end in zip(causes.items(), ends, strict=True)}
    rest = [kind for kind in causes if kind not in kinds]
    sets = [(*kinds, *more) for count in range(len(rest) + 1)
            for more in combinations(rest, count)]
    values, _ = linear_evidence(quadratic, [tuple(causes[kind] for kind in chosen)
                                            for chosen in sets], rows)
    return sets[int(np.argmax(values))]


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
    offsets = np.ravel(found[CLOCK]['values']) if CLOCK in found else np.zeros(1)
    if offsets.any():
        [kind] = [kind for kind in kinds if kind.name == CLOCK]
        most = float(offsets.mean() + WIDE * kind.spreads[0] / np.sqrt(len(offsets)))
        found[CLOCK]['hidden_delay'] = most if most > 0 else None
    for stream in dict.fromkeys(stream for one in (*late, held_out_late) for stream in one):
        found[f'{stream}_clock'] = {
            'what': f'how much later than the other states the {stream} is stamped',
            'unit': 's',
            'values': [[one.get(stream, 0.0)] for one in late],
            'held_out': [held_out_late.get(stream, 0.0)]}
    return found or None
