# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the effects of a diagnosis do to the tracking of a controller."""

from collections.abc import Callable

from quad_ident_ros.closed_loop.compare import ClosedLoop, compare
from quad_ident_ros.closed_loop.controller import NamedController
from quad_ident_ros.closed_loop.reference import Reference
from quad_ident_ros.diagnose.judgement import Bench, Judgement
from quad_ident_ros.greybox.parameters import nominal, SPLIT


def in_closed_loop(controller: NamedController, reference: Reference, bench: Bench,
                   judged: Judgement,
                   on_progress: Callable[[float], None] = lambda share: None) -> ClosedLoop:
    """
    Return the ClosedLoop of a controller with the nominal vehicle and with the effects named.

    Without an effect the others stay as they are: it is the one that is flown around.
    on_progress is called with the share done.
    """
    z0, z = nominal(bench.vehicle), judged.model.z
    without = {}
    for cause in judged.material:
        columns = list(cause.columns)
        left = z.copy()
        left[columns] = z0[columns]
        without[cause.effect] = left[SPLIT:]
    return compare(controller.spec, controller.controller, reference, bench.vehicle, z0[SPLIT:],
                   z[SPLIT:], without, on_progress)
