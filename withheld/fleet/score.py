# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How much of what happened to a made fleet was found, and what was found that is not so."""

import hashlib
from pathlib import Path

NEAR = 2            # flights within which a change is dated
ALIKE = {'mass_offset': 'thrust_scale'}
"""Effects of which flights show only the ratio: thrust over mass."""


def numbers_of(folder: Path) -> dict[str, tuple[str, int]]:
    """Return {SHA-256 of a log: (vehicle, number of the flight)} of a made fleet."""
    return {hashlib.sha256(path.read_bytes()).hexdigest():
            (path.parent.name, int(path.stem.rpartition('_')[2]))
            for path in folder.glob('*/flight_*.csv')}


def score(truth: dict, insight: dict, numbers: dict[str, tuple[str, int]]) -> dict:
    """
    Return the score of an insight (JSON) by the truth of the fleet.

    A change is found where an event of its vehicle has its effect within NEAR flights of it; what
    else changes then comes with it, and every other event is false. An odd vehicle is found by its
    effect; one that changed or drifts differs from its sisters, too, and is not counted.
    """
    changes, drifts, odd = [], [], []
    false = []
    events = [(event, numbers[event['flight']][1]) for event in insight['events']]
    for vehicle, (effect, parameter, step, at) in truth['changes'].items():
        near = [(event, number) for event, number in events if event['vehicle'] == vehicle
                and event['kind'] == 'change' and abs(number - at) <= NEAR
                and _alike(effect) in map(_alike, _effects(event))]
        changes.append({'vehicle': vehicle, 'effect': effect, 'parameter': parameter,
                        'true_step': step, 'flight': at, 'found': bool(near),
                        'dated': near[0][1] if near else None,
                        'probability': near[0][0]['probability'] if near else None})
    for vehicle, (effect, parameter, slope) in truth['drifts'].items():
        there = [part['change'] for event, _ in events for part in event['parts']
                 if event['vehicle'] == vehicle and event['kind'] == 'drift'
                 and _alike(part['effect']) == _alike(effect)]
        drifts.append({'vehicle': vehicle, 'effect': effect, 'parameter': parameter,
                       'true_per_week': slope, 'found': bool(there),
                       'per_week': there[0]['per_week'] if there else None,
                       'std': there[0]['std'] if there else None})
    for event, number in events:
        known = truth['changes'].get(event['vehicle'])
        if known is not None and event['kind'] == 'change' and abs(number - known[3]) <= NEAR:
            continue
        if event['kind'] == 'drift' and event['vehicle'] in truth['drifts']:
            continue
        false.append({'vehicle': event['vehicle'], 'kind': event['kind'], 'flight': number,
                      'effects': _effects(event), 'probability': event['probability']})
    for vehicle, (effect, parameter, apart) in truth['odd'].items():
        odd.append({'vehicle': vehicle, 'effect': effect, 'parameter': parameter,
                    'true_difference': apart, 'found': any(
                        one['sister']['vehicle'] == vehicle
                        and _alike(one['effect']) == _alike(effect) for one in insight['odd'])})
    special = {*truth['changes'], *truth['drifts'], *truth['odd']}
    return {'changes': changes, 'drifts': drifts, 'odd': odd, 'false_events': false,
            'false_odd': [{'vehicle': one['sister']['vehicle'], 'effect': one['effect'],
                           'parameter': one['parameter']} for one in insight['odd']
                          if one['sister']['vehicle'] not in special],
            'logs': _logs(truth, insight), 'seed': truth['seed'], 'flights': truth['flights'],
            'vehicles': len(insight['vehicles'])}


def passed(result: dict) -> bool:
    """Return whether all was found and nothing false."""
    return (all(one['found'] for name in ('changes', 'drifts', 'odd') for one in result[name])
            and not result['false_events'] and not result['false_odd'])


def text_of(result: dict) -> str:
    """Return a score as lines of text."""
    lines = [f'{result["flights"]} flights of {result["vehicles"]} vehicles, seed '
             f'{result["seed"]}']
    for one in result['changes']:
        lines.append(f'change of {one["vehicle"]}, {one["effect"]} {one["parameter"]} by '
                     f'{one["true_step"]:g} before flight {one["flight"]}: '
                     + (f'found before flight {one["dated"]}' if one['found'] else 'MISSED'))
    for one in result['drifts']:
        lines.append(f'drift of {one["vehicle"]}, {one["effect"]} {one["parameter"]} by '
                     f'{one["true_per_week"]:g} a week: '
                     + (f'found, {one["per_week"]:.4f} ± {one["std"]:.4f}' if one['found']
                        else 'MISSED'))
    for one in result['odd']:
        lines.append(f'odd vehicle {one["vehicle"]}, {one["effect"]} {one["parameter"]} off by '
                     f'{one["true_difference"]:g}: ' + ('found' if one['found'] else 'MISSED'))
    lines.append(f'false changes and drifts: {len(result["false_events"])}; vehicles called odd '
                 f'that are not: {len(result["false_odd"])}')
    lines += [f'  false: {one}' for one in (*result['false_events'], *result['false_odd'])]
    logs = result['logs']
    lines.append(f'wrong logs: {logs["refused"]} of {logs["wrong"]} refused, '
                 f'{logs["suspect"]} to check, {logs["unnoticed"] or "none"} unnoticed; right '
                 f'logs: {logs["right_refused"]} refused, {logs["right_suspect"]} to check')
    return '\n'.join(lines)


def _logs(truth: dict, insight: dict) -> dict:
    refused, suspect = ({f'{vehicle}/{Path(name).stem.rpartition("_")[2]}'
                         for vehicle, name, _ in insight[kind]} for kind in ('refused', 'suspect'))
    wrong = truth['spoilt']
    kept: dict[str, int] = {}
    for place in set(wrong) - refused - suspect:
        kept[wrong[place]] = kept.get(wrong[place], 0) + 1
    return {'wrong': len(wrong), 'refused': len(refused & set(wrong)),
            'suspect': len(suspect & set(wrong)), 'unnoticed': kept,
            'right_refused': len(refused - set(wrong)),
            'right_suspect': len(suspect - set(wrong))}


def _effects(event: dict) -> list[str]:
    return [part['effect'] for part in event['parts']]


def _alike(effect: str) -> str:
    return ALIKE.get(effect, effect)
