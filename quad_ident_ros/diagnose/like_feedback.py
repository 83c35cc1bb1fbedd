# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Forms that do what feedback makes of errors of the commands, such as moments across the rates.

Where commands are lacking in a log, the controller answers what they do: the moment that they
leave goes with the states, and on a circle, where roll and pitch follow one another, across them.
Such a form explains it, and what the instruments would say of the commands is gone. It is
looked for only where they say that the commands are right.
"""

from collections.abc import Callable

from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.judgement import judge, Judgement
from quad_ident_ros.diagnose.measure import ROTATION
from quad_ident_ros.diagnose.ratios import in_fewest
from quad_ident_ros.diagnose.select import select
from quad_ident_ros.effects.registry import EFFECTS


def is_like_feedback(cause: Candidate) -> bool:
    """Return whether a candidate, not in the vehicle file, does what errors of commands do."""
    return not cause.usual and any(form.like_feedback for form in EFFECTS[cause.effect].forms
                                   if form.name == cause.form)


def with_like_feedback(bench: Bench, judged: Judgement, causes: tuple[Candidate, ...],
                       on_progress: Callable[[float], None]
                       ) -> tuple[Bench, Judgement, tuple[Candidate, ...]]:
    """
    Return Bench, Judgement and candidates, with forms like feedback where these may be missing.

    Where the commands show no errors, and a rotation is unexplained or another form of the same
    effect is there. The whole search is repeated with them; where its best set has none, or takes
    more than one effect more, all stays as it is. causes: all candidates, those of the Bench among
    them.
    """
    early = tuple(cause for cause in causes if not is_like_feedback(cause))
    late = {*causes} - {*early}
    there = {cause.effect for cause in judged.model.effects} & {cause.effect for cause in late}
    if not late or bench.noise.command_errors or not (
            there or {*judged.unexplained} & {*ROTATION}):
        return bench, judged, early
    selection = select(bench.flights, bench.vehicle, causes, bench.rules, on_progress)
    if not {*selection.best.chosen} & late:
        return bench, judged, early
    beside = bench.with_selection(selection)
    beside, again = in_fewest(beside, judge(beside))
    if len(again.model.effects) > len(judged.model.effects) + 1:
        return bench, judged, early
    return beside, again, causes
