# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which sets of candidates are worth fitting next."""

from collections.abc import Collection, Sequence

import numpy as np

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.evidence import excludes, key_of
from quad_ident_ros.diagnose.fitted import effects_in
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.parameters import limits, nominal
from quad_ident_ros.model.vehicle import Vehicle

# How far the search goes; the thresholds of a verdict are those of Rules.
REFITS = 3          # sets that are refitted in a round
NEAR = 25.0         # log-evidence behind the best set by the slopes that may be made up for


def promising(ranked: list, tried: Collection[tuple]) -> list[tuple[tuple, np.ndarray]]:
    """
    Return [(set, distances)] of the untried sets that are worth refitting.

    Those with the most evidence, and those with another candidate in place of one of the best
    set's: slopes at a point hardly show which of two similar ones is present.
    """
    most, top, _ = ranked[0]
    fresh = [(chosen, away) for _, chosen, away in ranked[:3 * REFITS] if chosen not in tried]
    first = {chosen for chosen, _ in fresh[:REFITS]}
    rivals = [(chosen, away) for value, chosen, away in ranked
              if value > most - NEAR and chosen not in tried and chosen not in first
              and len(chosen) == len(top) and _swapped(chosen, top)]
    return [*fresh[:REFITS], *rivals[:REFITS]]


def other_actuators(best: tuple, causes: Sequence[Candidate], z: np.ndarray, vehicle: Vehicle
                    ) -> list[tuple[tuple, np.ndarray]]:
    """
    Return [(set, vector)] with another delay or lag for those of a set, at its usual size.

    From a delay that does the work of a lag no slope leads to the lag, and none from a lag of the
    first order to one of the second.
    """
    found, size = [], limits(vehicle)[2]
    actuators = [cause for cause in causes if EFFECTS[cause.effect].actuator]
    there = [cause for cause in best if cause.nuisance is None and EFFECTS[cause.effect].actuator]
    gone = [column for cause in there for column in cause.columns]
    for other in [cause for cause in actuators if there and cause not in there]:
        start = z.copy()
        start[gone] = nominal(vehicle)[gone]
        start[list(other.columns)] += size[list(other.columns)]
        found.append((key_of((other, *(cause for cause in best if cause not in there))), start))
    return found


def other_ratios(best: tuple, causes: Sequence[Candidate], z: np.ndarray, vehicle: Vehicle
                 ) -> list[tuple[tuple, np.ndarray]]:
    """
    Return [(set, vector)] with the usual form of another effect for one of a set of its ratio.

    From a thrust that is 10 % off, slopes say that a mass in its place moves a vehicle otherwise.
    What never stands beside the other one leaves with it, as the thrust of each flight.
    """
    found = []
    for cause in effects_in(best):
        ratio = EFFECTS[cause.effect].ratio
        for other in causes:
            if ratio and other.usual and other.effect != cause.effect and ratio == EFFECTS[
                    other.effect].ratio:
                start = z.copy()
                start[list(cause.columns)] = nominal(vehicle)[list(cause.columns)]
                kept = (one for one in best if one is not cause and not excludes(one, other))
                found.append((key_of((other, *kept)), start))
    return found


def _swapped(chosen: tuple, top: tuple) -> bool:
    """Return whether sets differ by one effect, in whose place there is another candidate."""
    apart = set(chosen) ^ set(top)
    return len(apart) == 2 and bool(effects_in(tuple(apart)))
