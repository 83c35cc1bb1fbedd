# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Of thrust and mass, the one with which a verdict needs fewer effects.

Without a force sensor only the ratio of the two shows. A thrust that is 3 % more is also a mass
that is 3 % less beside moments of the rotors that are 3 % more: without a drag both are the same
motion, and their evidence differs by what errors of the sensors do.
"""

from collections.abc import Iterable
from dataclasses import replace

from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.judgement import judge, Judgement
from quad_ident_ros.effects.registry import EFFECTS


def in_fewest(bench: Bench, judged: Judgement) -> tuple[Bench, Judgement]:
    """
    Return a Bench and its Judgement, with mass and thrust exchanged if that takes fewer effects.

    Only where the flights fit both alike, nothing changes but effects that scale the motion, all
    that is named is probable, and neither more is unexplained nor more stands in for it.
    """
    if bench.selection.twin is None:
        return bench, judged
    other = replace(bench, selection=bench.selection.twin)
    again = judge(other)
    changed = _names(judged.model.effects) ^ _names(again.model.effects)
    better = (len(again.model.effects) < len(judged.model.effects)
              and all(EFFECTS[name].scale_group for name in changed)
              and bool(again.material) and all(
                  again.probability[cause.effect] >= bench.rules.present
                  for cause in again.material)
              and {*again.unexplained} <= {*judged.unexplained}
              and _names(again.stand_ins) <= _names(judged.stand_ins))
    return (other, again) if better else (bench, judged)


def _names(causes: Iterable[Candidate]) -> set[str]:
    return {cause.effect for cause in causes}
