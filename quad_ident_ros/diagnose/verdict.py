# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""From contributions and evidence to the names of a verdict and the ranking of all effects."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.doubts import doubts_of
from quad_ident_ros.diagnose.judgement import Bench, beyond, Judgement, unexplained
from quad_ident_ros.diagnose.result import FlightCheck, Minor, Ranked, Value
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.parameters import NAMES, nominal


@dataclass(frozen=True, eq=False)
class Verdict:
    """
    The names of a verdict, and what they rest on.

    certain: the candidates that are sure, sure: their effects; doubts {candidate: Fitted}: between
    which the flights cannot tell, undetermined: their effects.
    """

    names: tuple[str, ...]
    minor: tuple[Minor, ...]
    ranking: tuple[Ranked, ...]
    certain: tuple
    sure: tuple[str, ...]
    doubts: dict
    undetermined: tuple[str, ...]
    flight_checks: tuple[FlightCheck, ...]


def verdict_of(bench: Bench, judged: Judgement, causes: tuple) -> Verdict:
    """Return the Verdict of a Judgement."""
    rules = bench.rules
    probability = bench.selection.probability
    checks = flight_checks(bench, judged)
    total = {}
    for cause in causes:
        total[cause.effect] = min(1.0, total.get(cause.effect, 0.0) + probability[cause])
    named = sorted((cause for cause in judged.model.effects
                    if total[cause.effect] >= rules.present),
                   key=lambda cause: -judged.contribution[cause])
    minor = tuple(Minor(cause.effect, total[cause.effect], judged.contribution[cause])
                  for cause in judged.full.effects if cause not in judged.model.effects
                  and total[cause.effect] >= rules.present)
    unknown = bool(judged.unexplained) or any(one.differs for one in checks)
    doubts = {} if unknown else doubts_of(bench.selection, tuple(named), rules)
    certain = tuple(cause for cause in named if cause not in doubts)
    sure = tuple(dict.fromkeys(cause.effect for cause in certain))
    names = ((*sure, 'unknown') if unknown else ('undetermined',) if doubts else sure or ('none',))
    return Verdict(names, minor, _ranking(bench, judged, causes, total), certain, sure, doubts,
                   tuple(sorted({cause.effect for cause in doubts})), checks)


def flight_checks(bench: Bench, judged: Judgement) -> tuple[FlightCheck, ...]:
    """
    Return how well each flight is predicted, and whether it differs from the others.

    It differs where a gap remains that matters and is twice that of the other flights.
    """
    found, before = ([gaps.gap([one]) for one in ends]
                     for ends in (judged.model.ends, judged.before))
    named, rows = bool(judged.model.effects), []
    for k, (track, gap, noise) in enumerate(zip(bench.tracks, found, judged.noise, strict=True)):
        remains = unexplained(gap, before[k], noise, named, bench.rules)
        others = {name: np.median([beyond(one[name], other[name]) for j, (one, other) in enumerate(
            zip(found, judged.noise, strict=True)) if j != k]) for name in remains}
        differs = any(value > bench.rules.differs * others[name]
                      for name, value in remains.items())
        rows.append(FlightCheck(track.name, {name: gap[name] / noise[name] for name in gap},
                                differs))
    return tuple(rows)


def _ranking(bench: Bench, judged: Judgement, causes: tuple, total: dict) -> tuple[Ranked, ...]:
    """Return every effect, the named ones by contribution, then the most probable first."""
    z0, full, model = nominal(bench.vehicle), judged.full, judged.model
    errors = dict(zip(full.estimate.columns, bench.selection.errors, strict=True))
    track = bench.tracks[-1]
    nuisance = model.vectors[-1] - model.z
    before = gaps.gap([gaps.ends(track, bench.vehicle, z0 + nuisance, gaps.HEADLINE)])
    rows = {}
    for cause in causes:
        known = rows.get(cause.effect)
        if known is not None and cause not in full.effects:
            continue
        parameters, gap_after, contribution, form = {}, before, None, None
        if cause in full.effects:
            source = model if cause in model.effects else full
            units = {one.name: one.unit for one in EFFECTS[cause.effect].parameters}
            for column in cause.columns:
                name = NAMES[column].split('.')[1]
                parameters[name] = Value(float(source.z[column]), float(errors[column]),
                                         units[name])
            alone = z0.copy()
            alone[list(cause.columns)] = source.z[list(cause.columns)]
            gap_after = gaps.gap([gaps.ends(track, bench.vehicle, alone + nuisance,
                                            gaps.HEADLINE)])
            contribution, form = judged.contribution[cause], cause.form
        rows[cause.effect] = Ranked(
            cause.effect, total[cause.effect], form, judged.stability.get(cause), contribution, parameters, gap_after,
            judged.without[cause].gap if cause in model.effects else None)
    named = {cause.effect for cause in model.effects}
    return tuple(sorted(rows.values(), key=lambda row: (
        row.effect not in named, -(row.contribution or 0.0) if row.effect in named
        else -row.probability)))
