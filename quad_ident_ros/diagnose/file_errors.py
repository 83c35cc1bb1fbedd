# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the constants of the vehicle file leave open of a set's parameters.

Motion shows a centre of mass, a drag or an inflow beside the file's inertia, arms and drags. Where
these are off, so are the parameters, however long the flights are.
"""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.diagnose.fitted import distances_of
from quad_ident_ros.diagnose.frame import frame_at
from quad_ident_ros.diagnose.likeliest import Around
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.known_together import with_constants
from quad_ident_ros.greybox.nuisances import Layout
from quad_ident_ros.greybox.parameters import constants_behind, INDEX, limits
from quad_ident_ros.model.vehicle import Vehicle


def errors_by_file(chosen: tuple, fit: Estimate, flights: Sequence[Flight], vehicle: Vehicle,
                   sizes: tuple[float, float], form_error: float, rules: Rules) -> np.ndarray:
    """
    Return the standard error (C,) that the constants of the file add to each column of a set.

    Args: sizes: force (N) and moment (N m) of the discrepancy, and form_error, as of normal_at.
    """
    count = len(fit.columns)
    behind = constants_behind(vehicle, fit.columns, rules.constant_error, rules.drag_error)
    if not behind or not count:
        return np.zeros(count)
    columns = [*fit.columns, *(INDEX[name] for name in behind)]
    wanted = Layout(columns, fit.nuisances.columns, len(fit.nuisances.values)).wanted
    around = Around(frame_at(list(flights), vehicle, fit, wanted, rules), fit, columns,
                    distances_of(chosen, fit, vehicle), sizes, form_error)
    size = limits(vehicle)[2, columns]
    shared = around.marginal(around.step(vehicle))
    held, whole = with_constants(shared, np.array(list(behind.values())), size)
    return np.sqrt(np.maximum(np.diag(whole)[:count] - np.diag(held), 0.0))
