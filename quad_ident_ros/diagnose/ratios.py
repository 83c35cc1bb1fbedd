# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Of thrust and mass, the one with which a verdict needs fewer effects.

Without a force sensor only the ratio of the two shows. A thrust that is 3 % more is also a mass
that is 3 % less and moments that are 3 % more: flights fit both alike, and their evidence differs
by what a sensor is off by.
"""

from dataclasses import replace

from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.judgement import judge, Judgement


def in_fewest(bench: Bench, judged: Judgement) -> tuple[Bench, Judgement]:
    """
    Return a Bench and its Judgement, with mass and thrust exchanged if that takes fewer effects.

    Only where the flights fit both alike, something is named, and no more is unexplained.
    """
    if bench.selection.twin is None:
        return bench, judged
    other = replace(bench, selection=bench.selection.twin)
    again = judge(other)
    fewer = len(again.model.effects) < len(judged.model.effects)
    more = {*again.unexplained} - {*judged.unexplained}
    return (other, again) if fewer and again.material and not more else (bench, judged)
