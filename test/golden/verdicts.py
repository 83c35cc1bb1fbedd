# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The verdicts that were recorded of the golden cases, and what has changed since."""

import json
from pathlib import Path

from flights import Case, CASES

from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError

RECORDED = Path(__file__).with_name('verdicts.json')
LIKELY = 0.05       # probability from which on an effect is recorded
GROUPS = ('velocity', 'attitude')


def summary_of(case: Case) -> dict:
    """Return what is recorded of a case: verdict, probabilities, gap, parameters with std."""
    try:
        return summary(diagnose(case.flights(), case.nominal()).as_data())
    except InputError as error:
        return {'verdict': ['refused'], 'why': str(error)}


def summary(data: dict) -> dict:
    """Return what is recorded of a diagnosis as data."""
    ranking = {row['effect']: row for row in data['ranking']}
    gap = data['gap']
    return {
        'verdict': data['verdict'],
        'probability': {name: round(row['probability'], 3) for name, row in ranking.items()
                        if row['probability'] > LIKELY},
        'gap': {group: {when: _short(gap[when][group]) for when in ('before', 'after', 'noise')}
                for group in GROUPS},
        'parameters': {name: {key: [_short(each['value']), _short(each['std'])]
                              for key, each in ranking[name]['parameters'].items()}
                       for name in data['verdict'] if name in ranking}}


def recorded() -> dict:
    """Return {name of a case: what was recorded of it}."""
    return json.loads(RECORDED.read_text(encoding='utf-8'))


def record() -> None:
    """Write what every case gives now."""
    found = {case.name: summary_of(case) for case in CASES}
    rows = ',\n'.join(f'{json.dumps(name)}: {json.dumps(row)}' for name, row in found.items())
    RECORDED.write_text(f'{{\n{rows}\n}}\n', encoding='utf-8')


def compare() -> None:
    """Print what has changed: verdict, gap after, the parameter that moved most."""
    kept = recorded()
    print(f'{"case":32} {"velocity after, m/s":21} {"moved most, standard errors":40} verdict')
    for case in CASES:
        old, new = kept[case.name], summary_of(case)
        gaps = ' -> '.join(f'{one["gap"]["velocity"]["after"]:.4g}' if 'gap' in one else 'refused'
                           for one in (old, new))
        same = same_verdict(old, new)
        verdict = ', '.join(new['verdict']) if same else (
            f'CHANGED: {", ".join(old["verdict"])} -> {", ".join(new["verdict"])}')
        print(f'{case.name:32} {gaps:21} {_moved_most(old, new):40} {verdict}', flush=True)


def same_verdict(old: dict, new: dict) -> bool:
    """Return whether two summaries name the same; their order came with the second schema."""
    return sorted(old['verdict']) == sorted(new['verdict'])


def _moved_most(old: dict, new: dict) -> str:
    """Return the shared parameter that differs by the most of its recorded standard errors."""
    before, now = old.get('parameters', {}), new.get('parameters', {})
    moves = {f'{effect}.{name}': abs(now[effect][name][0] - value) / (std or 1e-300)
             for effect, parameters in before.items() for name, (value, std) in parameters.items()
             if name in now.get(effect, {})}
    if not moves:
        return '-'
    name = max(moves, key=lambda each: moves[each])
    return f'{moves[name]:.2g} {name}'


def _short(value: float) -> float:
    return float(f'{value:.5g}')
