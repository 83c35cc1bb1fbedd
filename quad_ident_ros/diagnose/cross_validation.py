# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well a fitted set predicts flights that it was not fitted to (Stone 1974)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from quad_ident_ros.diagnose.fitted import Fitted, refitted
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.model.vehicle import Vehicle


def left_out_cost(fitted: Fitted, flights: Sequence[Flight], vehicle: Vehicle,
                  noise: Sequence[np.ndarray], slow: np.ndarray | None = None) -> float:
    """
    Return the cost of all flights, each by what a set that is refitted to the others says of it.

    In a flight that is left out its nuisances and the initial states of its rollouts are free. inf
    where a prediction diverges. Two flights or more. Source: Stone, J. R. Stat. Soc. B 36, 1974.
    Args: noise: per flight (12,); slow as of refitted.
    """
    fit, everyone = fitted.estimate, range(len(flights))

    def estimate_of(kept: Sequence[int], chosen: tuple, z: np.ndarray) -> Estimate:
        nuisances = replace(fit.nuisances, values=fit.nuisances.values[list(kept)])
        return refitted([flights[n] for n in kept], vehicle, z, chosen, [noise[n] for n in kept],
                        nuisances, [fit.starts[n] for n in kept], slow=slow)

    own = tuple(cause for cause in fitted.chosen if cause.nuisance)
    others = [estimate_of([n for n in everyone if n != k], fitted.chosen, fit.z).z
              for k in everyone]
    total = sum(estimate_of([k], own, z).cost for k, z in zip(everyone, others, strict=True))
    return total if np.isfinite(total) else np.inf
