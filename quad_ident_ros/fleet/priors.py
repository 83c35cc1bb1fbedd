# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet teaches about each effect: how often it is present, how large, in which form."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.compute as pc

from quad_ident_ros.diagnose.priors import bounded, EffectPrior, Priors
from quad_ident_ros.diagnose.rules import RULES, Rules
from quad_ident_ros.effects.registry import EFFECTS, NULL, PLACE
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.grouping import rules_hash
from quad_ident_ros.fleet.history import History
from quad_ident_ros.fleet.store import read_table

DOUBT = 4.0
"""
Vehicles' worth of what was known before: four vehicles that all have an effect make it as likely
as not in the fifth.
"""


def effects_without_priors(out: str | Path, rules: Rules = RULES) -> pyarrow.Table:
    """
    Return the table `effects` of a data set, of the verdicts by usual rules alone.

    Results that used priors would repeat them. Raises InputError where no result is left.
    """
    groups = read_table(out, 'groups', ['group', 'rules'])
    usual = groups.filter(pc.field('rules') == rules_hash(rules))['group']
    effects = read_table(out, 'effects')
    found = effects.filter(pc.is_in(effects['group'], value_set=usual.combine_chunks()))
    if not found.num_rows:
        raise InputError(f'{out}: no flight was diagnosed without --priors, so that there is '
                         'nothing to learn from; run without them, into another --out')
    return found


def learned(effects: pyarrow.Table, found: Iterable[History], rules: Rules = RULES) -> Priors:
    """
    Return what a fleet teaches, {effect: EffectPrior}.

    Args: effects: the table of a data set; found: histories of its parameters. How often an effect
    is present is the mean of its probability over the vehicles whose flights can show it, with
    DOUBT vehicles of Rules.usual_presence beside them; each vehicle counts once, however often
    it flew.
    """
    rows = effects.to_pylist()
    probability: dict[str, dict[str, list[float]]] = {}
    forms: dict[str, dict[str, set[str]]] = {}
    for row in rows:
        probability.setdefault(row['effect'], {}).setdefault(row['vehicle'], []).append(
            row['probability'])
        if row['named'] and row['form']:
            forms.setdefault(row['effect'], {}).setdefault(row['form'], set()).add(row['vehicle'])
    some = tuple(found)
    return {name: EffectPrior(
        bounded((float(sum(map(np.mean, probability[name].values())))
                 + DOUBT * rules.usual_presence) / (len(probability[name]) + DOUBT)),
        _forms(name, {form: len(those) for form, those in forms.get(name, {}).items()}, rules),
        _sizes(name, some), _exactness(name, some, rules))
        for name in EFFECTS if name in probability}


def _forms(name: str, named: dict[str, int], rules: Rules) -> dict[str, float]:
    """Return {form: share}, with DOUBT vehicles of what was known before."""
    known = [form.name for form in EFFECTS[name].forms]
    if len(known) == 1 or not named:
        return {}
    other = (1.0 - rules.usual_form) / (len(known) - 1)
    counts = {form: named.get(form, 0) + DOUBT * (rules.usual_form if form == known[0] else other)
              for form in known}
    return {form: count / sum(counts.values()) for form, count in counts.items()}


def _sizes(name: str, found: Iterable[History]) -> dict[str, float]:
    """Return {parameter: root mean square distance from no effect, of the vehicles}, SI."""
    values: dict[str, list[float]] = {}
    for one in found:
        if one.series.effect == name and (name, one.series.parameter) in PLACE:
            values.setdefault(one.series.parameter, []).append(
                one.level - NULL[PLACE[name, one.series.parameter]])
    return {key: float(size) for key, some in values.items()
            if (size := np.sqrt(np.mean(np.square(some)))) > 0.0}


def _exactness(name: str, found: Iterable[History], rules: Rules) -> float | None:
    """
    Return the median scatter between flights over the distance from no effect.

    The error of the form is in it, and what differs from flight to flight: it is a bound. Only of
    parameters that clearly differ from none: a share of nothing says nothing.
    """
    shares = []
    for one in found:
        if one.series.effect == name and (name, one.series.parameter) in PLACE:
            away = abs(one.level - NULL[PLACE[name, one.series.parameter]])
            if away > rules.shown * one.std:
                shares.append(one.scatter / away)
    return float(np.median(shares)) if shares else None
