# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which of the causes that fit best are named, and how far each is believed."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.greybox.parameters import nominal

LEAST = 0.1         # of the noise's gap that an effect must make somewhere to be named
BENT = 1.5          # times the gap that is left that may be left without causes beside an unknown
HARDLY = 0.02       # probability, at most, of a cause that makes no gap worth a name


@dataclass(frozen=True, eq=False)
class Training:
    """
    Flights that were learnt from, and what their gap is made of.

    flights: (Track, what is its own (Z,)) of each; noise (12,) of the measurement.
    """

    flights: tuple
    vehicle: object
    noise: np.ndarray

    def ends(self, z):
        """Return the Ends of each flight with a vector z (Z,)."""
        return [gaps.ends(track, self.vehicle, z + own, gaps.HEADLINE)
                for track, own in self.flights]

    def noise_gap(self, z):
        """Return {group: the gap of the noise alone} of all flights."""
        found = [gaps.noise_gap(track, self.vehicle, z + own, self.noise, gaps.HEADLINE)
                 for track, own in self.flights]
        return {name: float(np.sqrt(np.mean([one[name] ** 2 for one in found])))
                for name in found[0]}

    def left_over(self, z):
        """Return {group: the gap that is left, over that of the noise}."""
        after, base = gaps.usual_gap(self.ends(z)), self.noise_gap(z)
        return {name: after[name] / base[name] for name in after}


def without(z, cause, vehicle):
    """Return a vector z (Z,) with a cause as the nominal vehicle has it."""
    columns, found = list(cause.columns), z.copy()
    found[columns] = nominal(vehicle)[columns]
    return found


def named_of(best, training):
    """
    Return the vector (Z,) with the causes of a Fitted set that matter, those, and the strengths.

    These, {cause: strength}, are the gap that each makes, in times the noise's, where it is most.
    """
    z = kept = best.estimate.z
    base, full, strength = training.noise_gap(z), training.ends(z), {}
    for cause in best.causes:
        other = training.ends(without(z, cause, training.vehicle))
        change = gaps.gap([gaps.Ends(a.errors - b.errors, a.t)
                           for a, b in zip(other, full, strict=True)])
        strength[cause] = max(change[name] / base[name] for name in base)
        if strength[cause] < LEAST:
            kept = without(kept, cause, training.vehicle)
    return kept, tuple(cause for cause in best.causes if strength[cause] >= LEAST), strength


def outstanding(z, named, strength, training):
    """
    Return the vector and the causes that are named beside something unknown.

    Known causes bend to what is not theirs: the weakest go first, as long as not clearly more is
    left; none stays if they do not lessen the velocity gap of each flight: what is there acts in
    all of them.
    """
    most = BENT * max(training.left_over(z).values())
    for cause in sorted(named, key=strength.get):
        fewer = without(z, cause, training.vehicle)
        if max(training.left_over(fewer).values()) < most:
            z, named = fewer, tuple(one for one in named if one is not cause)
    z0 = nominal(training.vehicle)
    pairs = zip(training.ends(z), training.ends(z0), strict=True)
    if named and all(gaps.usual_gap([after])['velocity'] < gaps.usual_gap([before])['velocity']
                     for after, before in pairs):
        return z, named
    return z0, ()


def believed(probability, strength, remains):
    """
    Return {cause: probability of being present}.

    Args: probability: of each by the selection, which knows nothing but noise and effects;
    remains: what is unknown, in times the noise's gap: a cause is believed as far as it stands
    out from that. One that makes no gap worth a name is hardly believed.
    """
    found = dict(probability)
    for cause, size in strength.items():
        found[cause] *= size / max(size + remains, 1e-300)
        if size < LEAST:
            found[cause] = min(found[cause], HARDLY)
    return found
