# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnoses held against what was withheld: counts and rates, without any tuning."""

import numpy as np

from withheld.cases import EFFECTS

# battery_sag: the reality's exponent is no parameter of ours.
COMPARED = tuple(name for name in EFFECTS if name != 'battery_sag')
BINS = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)
# Between samples there is nothing to tell a delay from a lag by, where both are over at the next.
PASSED = {'actuation_delay': ('delay', 1.0), 'motor_lag': ('time_constant', 0.5)}   # periods
ROOM = 0.03         # of the noise: a gap that is less above it has no share that was closed


def truth_of(label):
    """Return the set of names that a diagnosis should give."""
    names = set(label['effects']) | ({'unknown'} if label['stranger'] else set())
    return names or {'none'}


def undetermined_of(found):
    """Return the set of names between which a diagnosis could not tell."""
    doubts = found.get('undetermined') or []
    if isinstance(doubts, dict):
        doubts = doubts.get('effects', [])
    return set(doubts)


def twins_of(label):
    """Return the effects of which the records cannot tell which one it is, or an empty set."""
    for name, (parameter, most) in PASSED.items():
        true = label['effects'].get(name)
        if len(label['effects']) == 1 and true is not None and (
                true['parameters'][parameter] <= most * label['period']):
            return set(PASSED)
    return set()


def judge(label, found):
    """
    Return what came of one case: {measure: True, False, a number, or None where it has none}.

    A failure is wrong; a refusal is neither right nor wrong but counted as refused. `exact` is
    also right where the records cannot tell (poor flights, twins_of) and `undetermined` names
    what is there beside what the verdict names rightly; with twins, `first` is right with either.
    """
    truth = truth_of(label)
    out = {'refused': 'refused' in found, 'failed': 'failed' in found,
           'seconds': found.get('seconds')}
    keys = ('first', 'exact', 'alarm', 'unknown', 'undetermined', 'closed', 'precision', 'recall')
    if out['refused']:
        return out | dict.fromkeys(keys)
    verdict = set(found.get('verdict', ()))
    doubts = undetermined_of(found)
    named = verdict & set(EFFECTS)
    effects = truth & set(EFFECTS)
    ranking = [row['effect'] for row in found.get('ranking', ())]
    exact = verdict == truth
    twins = twins_of(label)
    if 'undetermined' in verdict and (label['kind'] == 'poor' or doubts == twins):
        sure = set(found.get('sure') or ())
        exact = sure <= truth <= doubts | sure if effects else False
    hits = len(named & effects)
    return out | {
        'first': bool(ranking) and ranking[0] in effects | twins if effects else None,
        'exact': exact,
        'alarm': verdict != {'none'} if truth == {'none'} else None,
        'unknown': 'unknown' in verdict,
        'undetermined': bool(doubts) and truth <= doubts | {'unknown'} if doubts else None,
        'closed': _closed(label, found),
        'precision': hits / len(named) if named else None,
        'recall': hits / len(effects) if effects else None}


def _closed(label, found):
    """
    Return the share of the closable gap that was closed, velocity on the held-out flight.

    With faults the gap before is the diagnosis's, too, as clocks are its own to mend.
    """
    held, gap = label['held_out'], found.get('gap') or {}
    before, noise = held['before']['velocity'], held['noise']['velocity']
    if label['faulty']:
        before = gap.get('before', {}).get('velocity', before)
    after = gap.get('after', {}).get('velocity')
    if label['stranger'] or after is None or before - noise < ROOM * noise:
        return None
    return float(np.clip((before - after) / (before - noise), -1.0, 2.0))


def rate(rows, key):
    """Return {'rate', 'count'} of a measure over rows that have it; rate None where none has."""
    values = [float(row[key]) for row in rows if row[key] is not None]
    return {'rate': float(np.mean(values)) if values else None, 'count': len(values)}


def summary(rows):
    """Return the rates of a group of judged cases."""
    closed = [row['closed'] for row in rows if row['closed'] is not None]
    hits = [(row['precision'] or 0.0, row['recall']) for row in rows if row['recall'] is not None]
    scores = [2 * p * r / (p + r) if p + r else 0.0 for p, r in hits]
    return {'count': len(rows), **{key: rate(rows, key) for key in (
        'first', 'exact', 'alarm', 'unknown', 'refused', 'failed')},
        'undetermined': sum(row['undetermined'] is not None for row in rows),
        'undetermined_right': sum(row['undetermined'] is True for row in rows),
        'f1': {'rate': float(np.mean(scores)) if scores else None, 'count': len(scores)},
        'closed': None if not closed else {
            'median': float(np.median(closed)), 'tenth': float(np.quantile(closed, 0.1)),
            'count': len(closed)}}


def strength_of(label):
    """Return the strength that was asked for of the only effect, or None."""
    if label['stranger']:
        return label['stranger']['asked']
    asked = [one['asked'] for one in label['effects'].values()]
    return asked[0] if len(asked) == 1 else None


def score(labels, found):
    """
    Return the score of diagnoses {name: diagnosis} against labels {name: label}.

    A case without a diagnosis counts as failed.
    """
    missing = {'failed': 'no diagnosis was written'}
    pairs = [(label, found.get(name, missing)) for name, label in sorted(labels.items())]
    rows = [(label, judge(label, one)) for label, one in pairs]
    groups = {}
    for label, row in rows:
        prefix = 'faulty ' if label['faulty'] else ''
        name = f'{prefix}{label["kind"]}'
        groups.setdefault(name, []).append(row)
        if label['kind'] == 'single' or label['kind'] == 'unknown':
            groups.setdefault(f'{name} {strength_of(label):g}', []).append(row)
    effects = {}
    for label, row in rows:
        if label['kind'] == 'single' and not label['faulty']:
            (name,), strength = label['effects'], strength_of(label)
            effects.setdefault(name, {}).setdefault(f'{strength:g}', []).append(row)
    known = [row for label, row in rows if not label['stranger']]
    seconds = [row['seconds'] for _, row in rows if row['seconds'] is not None]
    return {
        'count': len(rows), 'chance': chance(pairs),
        'groups': {name: summary(groups[name]) for name in sorted(groups)},
        'effects': {name: {strength: summary(some) for strength, some in sorted(by.items())}
                    for name, by in sorted(effects.items())},
        'unknown_falsely_claimed': rate(known, 'unknown'),
        'calibration': {'clean': calibration([p for p in pairs if not p[0]['faulty']]),
                        'faulty': calibration([p for p in pairs if p[0]['faulty']])},
        'coverage': {'clean': coverage([p for p in pairs if not p[0]['faulty']]),
                     'faulty': coverage([p for p in pairs if p[0]['faulty']])},
        'gap_agrees': agreement(pairs),
        'seconds': {'median': float(np.median(seconds)), 'most': float(np.max(seconds))}
        if seconds else None}


def chance(pairs):
    """Return how often top place and set are right when each case gets another one's diagnosis."""
    firsts, exacts = [], []
    for k, (label, _) in enumerate(pairs):
        others = [judge(label, one) for j, (_, one) in enumerate(pairs) if j != k]
        firsts += [row['first'] for row in others if row['first'] is not None]
        exacts += [row['exact'] for row in others if row['exact'] is not None]
    return {'first': float(np.mean(firsts)) if firsts else None,
            'exact': float(np.mean(exacts)) if exacts else None}


def calibration(pairs):
    """Return the reliability table of the probabilities, their Brier score and error."""
    given, present = [], []
    for label, one in pairs:
        for row in one.get('ranking', ()):
            given.append(row['probability'])
            present.append(row['effect'] in label['effects'])
    if not given:
        return None
    given, present = np.array(given), np.array(present, float)
    which = np.clip(np.searchsorted(BINS, given, side='right') - 1, 0, len(BINS) - 2)
    inside = [(k, which == k) for k in range(len(BINS) - 1) if (which == k).any()]
    table = [{'from': BINS[k], 'to': BINS[k + 1], 'count': int(some.sum()),
              'given': float(given[some].mean()), 'present': float(present[some].mean())}
             for k, some in inside]
    error = sum(row['count'] * abs(row['given'] - row['present']) for row in table) / len(given)
    return {'table': table, 'brier': float(np.mean((given - present) ** 2)),
            'error': float(error), 'count': len(given),
            'brier_of_base_rate': float(present.mean() * (1.0 - present.mean()))}


def coverage(pairs):
    """Return {effect: {'rate', 'count'}} of true parameters inside their 95 % intervals."""
    inside = {}
    for label, one in pairs:
        if label['stranger'] or set(one.get('verdict', ())) != truth_of(label):
            continue
        for row in one.get('ranking', ()):
            true = label['effects'].get(row['effect'])
            if true is None or row['effect'] not in COMPARED:
                continue
            for name, value in true['parameters'].items():
                got = row['parameters'].get(name)
                if got is not None:
                    inside.setdefault(row['effect'], []).append(
                        abs(got['value'] - value) <= 1.96 * got['std'])
    every = [value for values in inside.values() for value in values]
    return {name: {'rate': float(np.mean(values)), 'count': len(values)}
            for name, values in [('all', every), *sorted(inside.items())] if values}


def agreement(pairs):
    """Return the largest relative difference of the gap before, theirs against ours, or None."""
    differences = [abs(one['gap']['before']['velocity'] / label['held_out']['before']['velocity']
                       - 1.0)
                   for label, one in pairs if one.get('gap') and not label['faulty']]
    return float(max(differences)) if differences else None
