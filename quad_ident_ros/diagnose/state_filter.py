# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether recorded states are those of a filter, and how far its level may be off."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.noise import near_noise, quick_noise


def follows_gyro(best: Estimate, flights: Sequence[Flight], rules: Rules) -> bool:
    """Return whether the attitude of flights is that of a filter which follows a gyro."""
    near, white = noise_by_samples(best)
    return (_is_filtered(near, flights, rules)
            and bool(np.mean(white[GROUPS['rate']]) > rules.quiet_gyro))


def levels_itself(best: Estimate, flights: Sequence[Flight], rules: Rules) -> bool:
    """
    Return whether the attitude of flights is levelled by an accelerometer, for want of tracking.

    A position that is noisier than a tracked one says so, or none: one that is the integral of the
    velocity has no noise to go by.
    """
    near, _ = noise_by_samples(best)
    summed = {name for flight in flights for name in flight.summed}
    return _is_filtered(near, flights, rules) and (
        'position' in summed or bool(np.mean(near[GROUPS['position']]) > rules.tracked_position))


def level_error(best: Estimate, flights: Sequence[Flight], rules: Rules) -> float:
    """Return the usual error (rad) of the level of a filter's attitude."""
    return rules.levelling if levels_itself(best, flights, rules) else rules.tracked_level


def noise_by_samples(best: Estimate) -> tuple[np.ndarray, np.ndarray]:
    """Return the noise (12,) of an Estimate's residuals over some samples, and from one to one."""
    near, white = (np.median([kind(raw) for raw in best.residuals], axis=0)
                   for kind in (near_noise, quick_noise))
    return near, white


def _is_filtered(near: np.ndarray, flights: Sequence[Flight], rules: Rules) -> bool:
    """Return whether the attitude of flights, by its near_noise, is that of a filter."""
    return (not any('attitude' in flight.summed for flight in flights)
            and bool(np.mean(near[GROUPS['attitude']]) < rules.filtered_attitude))
