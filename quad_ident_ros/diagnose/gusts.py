# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Wind that changes along a flight, so that effects beside it can be told.

Gusts act through the drag of the vehicle. A force that nobody knows hides a drag that is the
reason why gusts are felt at all; air that moves leaves it visible. Whatever it is that changes
along a flight, no simulation predicts it: it counts among the nuisances of each flight while
effects are judged, and remains in the gap, where it is unknown.
"""

from collections.abc import Callable

from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.judgement import judge, Judgement
from quad_ident_ros.diagnose.measure import TRANSLATION
from quad_ident_ros.diagnose.ratios import in_fewest
from quad_ident_ros.diagnose.select import select
from quad_ident_ros.effects.registry import GUSTS
from quad_ident_ros.greybox.flights import inertial


def beside_gusts(bench: Bench, judged: Judgement, causes: tuple[Candidate, ...],
                 on_progress: Callable[[float], None]) -> tuple[Bench, Judgement]:
    """
    Return a Bench and its Judgement, with gusts where a force is unexplained that these may be.

    The whole search is repeated with gusts among the nuisances. Where its best set has none, all
    stays as it is. Where the force of the air is taken from the records, no gusts act.
    """
    if inertial(bench.flights) or not {*judged.unexplained} & {*TRANSLATION}:
        return bench, judged
    selection = select(bench.flights, bench.vehicle, causes, bench.rules, on_progress, gusty=True)
    if not any(cause.effect == GUSTS.name for cause in selection.best.chosen):
        return bench, judged
    beside = bench.with_selection(selection)
    return in_fewest(beside, judge(beside))
