# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""From contributions and evidence to the names of a verdict and the ranking of all effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
import math

import numpy as np

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.bench import Bench, Model
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.doubts import doubts_of
from quad_ident_ros.diagnose.fitted import Fitted
from quad_ident_ros.diagnose.judgement import (
    beyond,
    form_error_beside,
    Judgement,
    matters,
    pooled,
    unexplained,
)
from quad_ident_ros.diagnose.probability import told_apart
from quad_ident_ros.diagnose.result import FlightCheck, Minor, Ranked, Value
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.parameters import NAMES, nominal


@dataclass(frozen=True, eq=False)
class Verdict:
    """
    The names of a verdict, and what they rest on.

    certain: the candidates that are sure, sure: their effects; doubts {candidate: Fitted}: between
    which the flights cannot decide, undetermined: their effects. That is the verdict where one of
    them contributes most; else the sure ones are.
    """

    names: tuple[str, ...]
    minor: tuple[Minor, ...]
    ranking: tuple[Ranked, ...]
    certain: tuple
    sure: tuple[str, ...]
    doubts: dict
    undetermined: tuple[str, ...]
    brief: tuple[str, ...]
    flight_checks: tuple[FlightCheck, ...]


def verdict_of(bench: Bench, judged: Judgement, causes: tuple, ruled_out: Sequence[str],
               form_unknown: Mapping[str, float]) -> Verdict:
    """
    Return the Verdict of a Judgement.

    ruled_out: effects that were no candidates for it; form_unknown: {effect: share explained} of
    one that what remains belongs to, by a law that is none of its forms.
    """
    rules, checks = bench.rules, flight_checks(bench, judged)
    named = sorted(judged.material, key=lambda cause: -judged.supports[cause].contribution)
    # A flight that differs vetoes `none`; effects are what the others show, and it is named.
    unknown = (bool(judged.stand_ins or judged.unexplained and not form_unknown)
               or not named and any(one.differs for one in checks))
    # Where much is unexplained, how well forms fit does not decide between effects.
    doubts = {} if unknown or judged.unexplained else doubts_of(
        bench.selection, tuple(named), rules, partial(_replaces, bench, judged))
    total = told_apart(judged.probability, bench.selection.posterior,
                       [cause for cause in named if cause in doubts])
    minor = tuple(Minor(cause.effect, total[cause.effect], judged.supports[cause].contribution)
                  for cause in judged.model.effects
                  if cause not in {*judged.material, *judged.stand_ins})
    certain = tuple(cause for cause in named if cause not in doubts)
    sure = tuple(dict.fromkeys(cause.effect for cause in certain))
    open_first = bool(named) and named[0] in doubts
    names = ((*sure, 'unknown') if unknown else ('undetermined',) if open_first
             else sure or ('none',))
    ranking = _ranking(bench, judged, causes, total, ruled_out, form_unknown)
    return Verdict(names, minor, ranking, certain, sure, doubts,
                   tuple(sorted({cause.effect for cause in doubts})),
                   tuple(cause.effect for cause in certain
                         if is_brief(bench, judged.model, cause)), checks)


def _replaces(bench: Bench, judged: Judgement, cause: Candidate, rival: Candidate,
              having: Fitted) -> bool:
    """
    Return whether a rival in the place of a cause loses nothing that matters.

    A lag and a delay that are both over before the next sample are one finding, and no rivals.
    """
    if is_brief(bench, judged.model, cause) and EFFECTS[rival.effect].actuator:
        return False
    instead = bench.without_gusts(bench.instead(judged.fitted, cause, rival, having.estimate.z))
    return not matters(judged.model.gap, instead.gap, gaps.gap(judged.before),
                       pooled(judged.noise), bench.rules, form_error=form_error_beside(
                           judged.model.effects, (cause,), bench.rules))


def is_brief(bench: Bench, model: Model, cause: Candidate) -> bool:
    """
    Return whether a cause is a delay or a lag that is over before the next sample.

    Records show when the vehicle answers, but not how it does between two samples.
    """
    effect, away = EFFECTS[cause.effect], model.z - nominal(bench.vehicle)
    units = {parameter.name: parameter.unit for parameter in effect.parameters}
    times = [abs(away[column]) for column in cause.columns
             if units[NAMES[column].split('.')[1]] == 's']
    return bool(effect.actuator and times
                and max(times) <= max(flight.period for flight in bench.flights))


def flight_checks(bench: Bench, judged: Judgement) -> tuple[FlightCheck, ...]:
    """
    Return how well the others predict each flight, and whether it differs from them.

    It differs where a gap remains that matters and is twice that of the other flights, but for
    what chance makes of it.
    """
    found, before = ([gaps.gap([one]) for one in ends]
                     for ends in (judged.left_out, judged.before))
    named, rows = bool(judged.material), []
    for k, (track, gap, noise) in enumerate(zip(bench.tracks, found, judged.noise, strict=True)):
        sure = gaps.surely(judged.left_out[k], bench.rules)
        remains = unexplained(sure, before[k], noise, named, bench.rules)
        others = {name: np.median([beyond(one[name], other[name]) for j, (one, other) in enumerate(
            zip(found, judged.noise, strict=True)) if j != k]) for name in remains}
        differs = any(value > bench.rules.differs * others[name]
                      for name, value in remains.items())
        rows.append(FlightCheck(track.name, {name: gap[name] / noise[name] for name in gap},
                                differs))
    return tuple(rows)


def _ranking(bench: Bench, judged: Judgement, causes: tuple, total: dict,
             ruled_out: Sequence[str], form_unknown: Mapping[str, float]) -> tuple[Ranked, ...]:
    """Return every effect, the named ones by contribution, then the most probable first."""
    z0, model, best = nominal(bench.vehicle), judged.model, bench.selection.best
    errors, by_file = bench.errors(model), bench.errors_by_file(model)
    by_absent = dict(zip(model.estimate.columns,
                         bench.shift_by_absent(model, judged.probability), strict=True))
    track = bench.tracks[-1]
    nuisance = model.vectors[-1] - model.z
    before = gaps.gap([gaps.ends(track, bench.vehicle, z0 + nuisance, bench.horizon)])
    rows = {}
    for cause in causes:
        support = judged.supports.get(cause)
        if cause.effect in rows and support is None:
            continue
        parameters, gap_after = {}, before
        # A form that gave way to the usual one, which was taken out later, is in neither.
        if support is not None and errors.keys() >= {*cause.columns}:
            z = model.z if cause in model.effects else best.estimate.z
            units = {one.name: one.unit for one in EFFECTS[cause.effect].parameters}
            for column in cause.columns:
                name = NAMES[column].split('.')[1]
                change = (float(z[column] - z0[column])
                          if cause.effect in bench.vehicle.effects else None)
                std = math.hypot(errors[column], by_file.get(column, 0.0),
                                 by_absent.get(column, 0.0))
                parameters[name] = Value(float(z[column]), std, units[name], change)
            alone = z0.copy()
            alone[list(cause.columns)] = z[list(cause.columns)]
            gap_after = gaps.gap([gaps.ends(track, bench.vehicle, alone + nuisance,
                                            bench.horizon)])
        rows[cause.effect] = Ranked(
            cause.effect, total[cause.effect], support and cause.form,
            form_unknown.get(cause.effect, support and support.explained),
            support and support.contribution, support and support.stability,
            support and support.distance, support and support.companions, parameters, gap_after,
            support and support.gap)
    for name in ruled_out:
        rows[name] = Ranked(name, 0.0, None, None, None, None, None, None, {}, before, None)
    named = {cause.effect for cause in judged.material}
    return tuple(sorted(rows.values(), key=lambda row: (
        row.effect not in named, -(row.contribution or 0.0) if row.effect in named
        else -row.probability)))
