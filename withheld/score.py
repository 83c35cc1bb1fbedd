# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnoses held against what was withheld: counts and rates, without any tuning."""

import numpy as np
from numpy.typing import NDArray

from quad_ident_ros.effects.registry import EFFECTS as LIBRARY
from withheld.cases import EFFECTS
from withheld.hybrids import judge as judge_hybrid

COLUMNS = ('ours', 'forms', 'files', 'logs', 'estimator', 'faulty')
TITLES = {'ours': 'forms as ours', 'forms': 'other forms', 'files': 'wrong files',
          'logs': 'logs', 'estimator': 'estimator states', 'faulty': 'faulty records',
          'hybrids': 'real flights, changed'}
MEASURES = ('first', 'exact', 'alarm', 'unknown', 'instead', 'undetermined', 'closed',
            'precision', 'recall')      # of judge
BINS = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)
# Between samples nothing separates a delay from a lag where both are over at the next.
PASSED = {'actuation_delay': ('delay', 1.0), 'motor_lag': ('time_constant', 0.5)}   # periods
# Effects of which a ratio shows, and {effect: the parameters that change with the one that stands
# for it}: of what scales the whole motion all, of the rest those with mass in their unit.
OF_A_RATIO = {name for name, effect in LIBRARY.items() if effect.ratio}
RESCALED = {name: {parameter.name for parameter in effect.parameters
                   if effect.scale_group or parameter.unit.startswith(('kg', 'N'))}
            for name, effect in LIBRARY.items()}
ROOM = 0.03         # of the noise: a gap that is less above it has no share that was closed


def truth_of(label):
    """Return the set of names that a diagnosis should give."""
    names = set(label['effects']) | ({'unknown'} if label['stranger'] else set())
    return names or {'none'}


def undetermined_of(found):
    """Return the set of names between which a diagnosis could not decide."""
    doubts = found.get('undetermined') or []
    if isinstance(doubts, dict):
        doubts = doubts.get('effects', [])
    return set(doubts)


def twins_of(label):
    """Return the effects between which the records cannot decide, or an empty set."""
    for name, (parameter, most) in PASSED.items():
        true = label['effects'].get(name)
        value = None if true is None else true['parameters'].get(parameter)
        if len(label['effects']) == 1 and value is not None and value <= most * label['period']:
            return set(PASSED)
    return set()


def findings_of(found):
    """
    Return what a diagnosis names as one finding, as a list of sets of names.

    Effects that motion cannot separate are one finding: it names each of its members.
    """
    return [set(one['effects']) for one in found.get('one_finding') or ()]


def named_in(name, names, findings):
    """Return whether a name is among names, or another member of its finding is."""
    return name in names or any(name in one and one & names for one in findings)


def minor_of(found):
    """Return the set of effects that a diagnosis is sure of and holds for small."""
    return {row['effect'] for row in found.get('minor') or ()}


def is_exact(label, found):
    """
    Return whether a verdict names what is present, no more and no less.

    Effects that are present but small may stand in `minor`. What the label allows beside the
    effects (`beside`) may be named and need not be; `instead` are names that do as well.
    """
    truth, verdict = truth_of(label), set(found.get('verdict', ()))
    findings, beside = findings_of(found), set(label.get('beside', ()))
    if verdict and verdict <= set(label.get('instead', ())):
        return True
    extra = {name for name in verdict if not named_in(name, truth | beside, findings)}
    known = verdict | minor_of(found)
    missing = {name for name in truth if not named_in(name, known, findings)}
    if truth == {'none'}:
        return bool(verdict) and not extra
    return not extra and not missing


def judge(label, found):
    """
    Return what came of one case: {measure: True, False, a number, or None where it has none}.

    A failure is wrong; a refusal is neither right nor wrong but counted as refused. `exact` is
    also right where the records cannot decide (poor flights, twins_of) and `undetermined` names
    what is present beside what the verdict names rightly; with twins, `first` is right with
    either. `instead`: the verdict is `unknown` where known effects are present, and names none of
    them; without effects `alarm` has it.
    """
    truth = truth_of(label)
    out = {'refused': 'refused' in found, 'failed': 'failed' in found,
           'seconds': found.get('seconds')}
    if out['refused']:
        return out | dict.fromkeys(MEASURES)
    verdict, findings = set(found.get('verdict', ())), findings_of(found)
    doubts = undetermined_of(found)
    named, effects = verdict & set(EFFECTS), truth & set(EFFECTS)
    # What the label allows beside the effects is there, too, and decides nothing.
    ranking = [row['effect'] for row in found.get('ranking', ())
               if row['effect'] not in label.get('beside', ())]
    exact = is_exact(label, found)
    twins = twins_of(label)
    if doubts and (label['kind'] == 'poor' or doubts == twins):
        sure = set(found.get('sure') or ())
        exact = sure <= truth <= doubts | sure if effects else False
    right = {name for name in effects if named_in(name, verdict, findings)}
    counted = named - set(label.get('beside', ()))
    allowed = set(label.get('instead', ()))
    return out | {
        'first': bool(ranking) and named_in(ranking[0], effects | twins, findings)
        if effects else None,
        'exact': exact,
        'alarm': not exact if truth == {'none'} else None,
        'unknown': 'unknown' in verdict or bool(verdict) and verdict <= allowed
        if label['stranger'] else 'unknown' in verdict,
        'instead': None if not effects or 'unknown' in allowed
        else 'unknown' in verdict and not right,
        'undetermined': bool(doubts) and truth <= doubts | {'unknown'} if doubts else None,
        'closed': _closed(label, found),
        'precision': len(right) / len(counted | right) if counted | right else None,
        'recall': len(right) / len(effects) if effects else None}


def _closed(label, found):
    """
    Return the share of the closable gap that was closed, velocity on the held-out flight.

    The noise is what remains where every effect is known: `floor`, which holds what a log hides.

    Where records are not as they should be the gap before is the diagnosis's, as clocks are its
    own to mend, and rows on the floor its own to leave out.
    """
    held, gap = label['held_out'], found.get('gap') or {}
    before = held['before']['velocity']
    noise = held.get('floor', held['noise'])['velocity']
    if label['faulty'] or label.get('log'):
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
        'first', 'exact', 'alarm', 'unknown', 'instead', 'refused', 'failed')},
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


def column_of(label):
    """
    Return the column of the tables that a case counts in.

    ours, forms (of effects that the library has otherwise), files (vehicle files that are wrong
    elsewhere, or data sheets), logs (what logging does), estimator (states), or faulty.
    """
    return label.get('column') or ('faulty' if label['faulty'] else 'ours')


def score(labels, found):
    """
    Return the score of diagnoses {name: diagnosis} against labels {name: label}.

    A case without a diagnosis counts as failed.
    """
    missing = {'failed': 'no diagnosis was written'}
    pairs = [(label, found.get(name, missing)) for name, label in sorted(labels.items())
             if label['kind'] != 'hybrid']
    rows = [(label, judge(label, one)) for label, one in pairs]
    names = [name for name, label in sorted(labels.items()) if label['kind'] != 'hybrid']
    groups, effects, columns = {}, {}, {}
    for (label, row), pair in zip(rows, pairs, strict=True):
        column = column_of(label)
        name = f'{column}: {label["kind"]}'
        columns.setdefault(column, []).append((pair, row))
        groups.setdefault(name, []).append(row)
        if label['kind'] in ('single', 'unknown'):
            groups.setdefault(f'{name} {strength_of(label):g}', []).append(row)
        if label['kind'] == 'single' and column in ('ours', 'forms'):
            (effect,), strength = label['effects'], strength_of(label)
            effects.setdefault(f'{column}: {effect}', {}).setdefault(
                f'{strength:g}', []).append(row)
    seconds = [row['seconds'] for _, row in rows if row['seconds'] is not None]
    changes = hybrids_of(labels, found)
    if changes:
        groups['hybrids: changed'] = [
            dict.fromkeys(MEASURES) | {'exact': row['right'], 'refused': row['refused'],
                                       'failed': row['failed']} for row in changes]
    return {
        'count': len(rows), 'chance': chance(pairs),
        'cases': [case_of(name, *pair, row) for name, pair, (_, row) in zip(
            names, pairs, rows, strict=True)],
        'groups': {name: summary(groups[name]) for name in sorted(groups)},
        'columns': {name: _column(columns[name]) for name in COLUMNS if name in columns},
        'effects': {name: {strength: summary(some) for strength, some in sorted(by.items())}
                    for name, by in sorted(effects.items())},
        'gap_agrees': agreement(pairs), 'hybrids': changes,
        'calibration': calibration(pairs),
        'seconds': {'median': float(np.median(seconds)), 'most': float(np.max(seconds))}
        if seconds else None}


def case_of(name: str, label: dict, found: dict, row: dict) -> dict:
    """
    Return a judged case for the lists of what was missed.

    Beside `judge`: column, kind, group; text: the truth and the verdict; outside: whether a
    true parameter is outside its interval; misjudged: how far off the worst probability between
    0.05 and 0.95 is.
    """
    strength = strength_of(label) if label['kind'] in ('single', 'unknown') else None
    group = label['kind'] if strength is None else f'{label["kind"]} {strength:g}'
    off = [abs(given - there) for given, there in given_and_present(label, found)
           if BINS[1] <= given < BINS[-2]]
    inside = [one for values in _inside(label, found).values() for one in values]
    return row | {'name': name, 'column': column_of(label), 'kind': label['kind'],
                  'group': group, 'text': text_of(name, label, found),
                  'outside': not all(inside), 'misjudged': max(off, default=0.0)}


def text_of(name: str, label: dict, found: dict) -> str:
    """Return a case in words: its name, its truth, the verdict."""
    effects = [f'{effect}' + (f' ({one["form"]})' if one.get('form', 'ours') != 'ours' else '')
               + (f' {one["asked"]:g}' if one.get('asked') else '')
               for effect, one in label['effects'].items()]
    if label['stranger']:
        effects.append(f'stranger {label["stranger"]["kind"]} {label["stranger"]["asked"]:g}')
    about = [str(label[key]) for key in ('log', 'vehicle', 'path') if label.get(key)]
    about += [key for key in ('bodies', 'gusts') if label.get(key)]
    if label.get('setup') is not None:
        about.append(f'estimator {label["setup"] + 1}')
    return f'`{name}` {" + ".join(effects) or "none"} ({", ".join(about)}): {_in_words(found)}'


def hybrids_of(labels: dict[str, dict], found: dict[str, dict]) -> list[dict]:
    """
    Return the changes to real flights, each as hybrids.judge makes of it, by name of the change.

    Beside that: name; change; text: the truth, the verdict and what is wrong in it; refused,
    failed: the flights were, as flown or changed. What was refused is neither right nor wrong,
    what failed is wrong.
    """
    missing = {'failed': 'no diagnosis was written'}
    rows = []
    for name, label in labels.items():
        if label['kind'] != 'hybrid' or name == label['base']:
            continue
        base, changed = (found.get(one, missing) for one in (label['base'], name))
        refused, failed = ('refused' in base or 'refused' in changed,
                           'failed' in base or 'failed' in changed)
        row = {'name': name, 'change': label['change'], 'refused': refused, 'failed': failed}
        if refused or failed:
            row |= dict.fromkeys(('named', 'gained', 'moved'), None) | {
                'lost': [], 'added': [], 'right': None if refused else False}
        else:
            row |= judge_hybrid(label, base, changed)
        rows.append(row | {'text': _text_of_change(label, row, base, changed)})
    return sorted(rows, key=lambda row: (row['change'], row['name']))


def _text_of_change(label: dict, row: dict, base: dict, changed: dict) -> str:
    """Return a change to real flights in words: the truth, the verdict, what is wrong."""
    amounts = [' '.join([effect, *(f'{parameter} {value:.3g}' for parameter, value in
                                   parameters.items())])
               for effect, parameters in label['effects'].items()]
    said = _in_words(changed) if 'verdict' in base else f'as flown: {_in_words(base)}'
    wrong = [text for applies, text in (
        (row['named'] is False, 'not named'), (row['moved'] is False, 'moved by another amount'),
        (row['lost'], f'lost {", ".join(row["lost"])}'),
        (row['added'], f'added {", ".join(row["added"])}')) if applies]
    return '; '.join([f'`{row["name"]}` {row["change"]} ({", ".join(amounts)}): {said}', *wrong])


def _in_words(found: dict) -> str:
    """Return a diagnosis in words: its verdict, or why it has none."""
    return found.get('refused') or found.get('failed') or ', '.join(found.get('verdict', ()))


def _column(some):
    """Return what a column has beside its groups, of [((label, diagnosis), judged)]."""
    pairs, rows = [pair for pair, _ in some], [row for _, row in some]
    return summary(rows) | {'calibration': calibration(pairs), 'coverage': coverage(pairs)}


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
    """
    Return the reliability table of the probabilities, their Brier score and error.

    `middle` is the error over the probabilities between 0.05 and 0.95 alone: among the others
    nine in ten are near 0. What a label allows beside its effects is neither there nor not.
    """
    both = [one for pair in pairs for one in given_and_present(*pair)]
    if not both:
        return None
    given, present = np.array(both, float).T
    table = reliability(given, present)
    middle = [row for row in table if row['from'] > BINS[0] and row['to'] < BINS[-1]]
    return {'table': table, 'brier': float(np.mean((given - present) ** 2)),
            'error': _error(table), 'count': len(given), 'middle': _error(middle),
            'middle_count': sum(row['count'] for row in middle),
            'brier_of_base_rate': float(present.mean() * (1.0 - present.mean()))}


def reliability(given: NDArray[np.float64], present: NDArray[np.float64]) -> list[dict]:
    """
    Return [{'from', 'to', 'count', 'given', 'present'}] of probabilities by BINS, empty ones not.

    Args: given (N,): probabilities; present (N,): 1 where the effect is present, or 0.
    """
    which = np.clip(np.searchsorted(BINS, given, side='right') - 1, 0, len(BINS) - 2)
    return [{'from': BINS[k], 'to': BINS[k + 1], 'count': int((which == k).sum()),
             'given': float(given[which == k].mean()),
             'present': float(present[which == k].mean())}
            for k in range(len(BINS) - 1) if (which == k).any()]


def given_and_present(label: dict, found: dict) -> list[tuple[float, bool]]:
    """Return [(probability, whether the effect is present)] of what a label decides."""
    return [(row['probability'], row['effect'] in label['effects'])
            for row in found.get('ranking', ()) if row['effect'] not in label.get('beside', ())]


def _error(table):
    count = sum(row['count'] for row in table)
    return sum(row['count'] * abs(row['given'] - row['present'])
               for row in table) / count if count else None


def coverage(pairs):
    """
    Return {effect: {'rate', 'count'}} of true parameters inside their 95 % intervals.

    Only where the set is exact, and of the parameters that mean the same as the library's, also
    in this diagnosis: see rescaled.
    """
    inside = {}
    for pair in pairs:
        for name, values in _inside(*pair).items():
            inside.setdefault(name, []).extend(values)
    every = [value for values in inside.values() for value in values]
    return {name: {'rate': float(np.mean(values)), 'count': len(values)}
            for name, values in [('all', every), *sorted(inside.items())] if values}


def rescaled(label: dict, found: dict) -> bool:
    """
    Return whether a diagnosis names the wrong effect of a ratio, such as thrust per mass.

    Motion shows ratios only: where m times the mass is stated as 1 / m of the thrust, inertia,
    drag and all else with mass in its unit come out as 1 / m of what they are.
    """
    there, beside = set(label['effects']), set(label.get('beside', ()))
    said = set(found.get('verdict', ())) | minor_of(found)
    return bool(OF_A_RATIO & ((there - said) | (said - there - beside)))


def _inside(label: dict, found: dict) -> dict[str, list[bool]]:
    """Return {effect: [whether each true parameter is inside its interval]} of one case."""
    inside = {}
    if label['stranger'] or not is_exact(label, found):
        return inside
    other = rescaled(label, found)
    for row in found.get('ranking', ()):
        true = label['effects'].get(row['effect'])
        if true is None or not true.get('comparable', True):
            continue
        for name, value in true['parameters'].items():
            got = row['parameters'].get(name)
            if got is not None and not (other and name in RESCALED[row['effect']]):
                inside.setdefault(row['effect'], []).append(
                    abs(got['value'] - value) <= 1.96 * got['std'])
    return inside


def agreement(pairs):
    """Return the largest relative difference of the gap before, theirs against ours, or None."""
    differences = [abs(one['gap']['before']['velocity'] / label['held_out']['before']['velocity']
                       - 1.0)
                   for label, one in pairs if one.get('gap') and column_of(label) in (
                       'ours', 'forms', 'files')]
    return float(max(differences)) if differences else None
