# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet teaches of each effect: how often it is present, how large, how exact its form."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.compute as pc

from quad_ident_ros.diagnose.priors import bounded, EffectPrior, Priors
from quad_ident_ros.diagnose.rules import RULES, Rules
from quad_ident_ros.diagnose.standard_errors import OF_EACH
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
UNSURE = 2.0
"""
Factor by which the error of an effect's formula usually differs from Rules.form_error: published
laws of one effect differ by 10 to 30 %.
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
    if not effects.num_rows:
        raise InputError(f'{out}: no flight is diagnosed, so that there is nothing to learn from; '
                         f'the column reason of {out}/flights says why')
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
    curves: dict[str, dict[str, list[list[float]]]] = {}
    named: dict[str, set[str]] = {}
    for row in rows:
        probability.setdefault(row['effect'], {}).setdefault(row['vehicle'], []).append(
            row['probability'])
        if row['named']:
            named.setdefault(row['effect'], set()).add(row['vehicle'])
        if row['named'] and row['form']:
            forms.setdefault(row['effect'], {}).setdefault(row['form'], set()).add(row['vehicle'])
        if row['named'] and row['form_errors']:
            curves.setdefault(row['effect'], {}).setdefault(row['vehicle'], []).append(
                row['form_errors'])
    some = tuple(found)
    return {name: EffectPrior(
        bounded((float(sum(map(np.mean, probability[name].values())))
                 + DOUBT * rules.usual_presence) / (len(probability[name]) + DOUBT)),
        _forms(name, {form: len(those) for form, those in forms.get(name, {}).items()}, rules),
        _sizes(name, some, named.get(name, set())), _form_error(curves.get(name, {}), rules))
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


def _sizes(name: str, found: Iterable[History], having: Collection[str]) -> dict[str, float]:
    """
    Return {parameter: root mean square distance from no effect}, SI, of the vehicles `having` it.

    Others, in which it is tracked because most have it, or as thrust is in all, show how exact the
    nominal vehicle is.
    """
    values: dict[str, list[float]] = {}
    for one in found:
        if (one.series.effect == name and one.series.vehicle in having
                and (name, one.series.parameter) in PLACE):
            values.setdefault(one.series.parameter, []).append(
                one.level - NULL[PLACE[name, one.series.parameter]])
    return {key: float(size) for key, some in values.items()
            if (size := np.sqrt(np.mean(np.square(some)))) > 0.0}


def _form_error(curves: Mapping[str, Sequence[Sequence[float]]], rules: Rules) -> float | None:
    """
    Return the mean relative error of a formula by the log-likelihoods of each vehicle's groups.

    The groups of a vehicle count together as one: their errors may be the same. What was known
    before is about Rules.form_error, by a factor of UNSURE.
    """
    if not curves:
        return None
    sizes = np.array(OF_EACH)
    value = -0.5 * (np.log(sizes / rules.form_error) / np.log(UNSURE)) ** 2
    for some in curves.values():
        value = value + np.mean(some, axis=0)
    share = np.exp(value - value.max())
    return float(share @ sizes / share.sum())
