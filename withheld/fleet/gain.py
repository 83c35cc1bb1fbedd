# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the priors of a fleet change in verdicts on vehicles that did not teach them."""

from pathlib import Path

import numpy as np

from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.fleet.store import read_table

LEAST = 1e-3        # of a probability: a mistake that is surer counts no more than seven nats


def verdicts_of(out: Path) -> dict[str, dict]:
    """Return {vehicle: verdict, minor and {effect: probability}} of a data set."""
    found = {row['vehicle']: {'verdict': set(row['verdict'] or ()), 'minor': set(
        row['minor'] or ()), 'probability': {}} for row in read_table(
            out, 'groups', ['vehicle', 'verdict', 'minor']).to_pylist()}
    for row in read_table(out, 'effects', ['vehicle', 'effect', 'probability']).to_pylist():
        found[row['vehicle']]['probability'][row['effect']] = row['probability']
    return found


def measures(truth: dict[str, list[str]], found: dict[str, dict]) -> dict[str, np.ndarray]:
    """
    Return {measure: (V,)} of verdicts on vehicles, in the order of the truth.

    exact: all effects are in the verdict or minor, and nothing else is in the verdict; missed,
    false: how many effects are not named, and are named and not there; log, square: mean over all
    effects of the logarithmic and the squared error of the probability.
    """
    rows = []
    for vehicle, names in truth.items():
        one = found.get(vehicle, {'verdict': set(), 'minor': set(), 'probability': {}})
        true = set(names) or {'none'}
        present = np.array([name in names for name in EFFECTS], float)
        told = np.clip([one['probability'].get(name, 0.0) for name in EFFECTS], LEAST, 1 - LEAST)
        rows.append((true <= one['verdict'] | one['minor'] and one['verdict'] <= true,
                     len(true - one['verdict'] - one['minor']),
                     len(one['verdict'] - true),
                     -np.mean(np.log(np.where(present, told, 1.0 - told))),
                     np.mean((told - present) ** 2)))
    return dict(zip(('exact', 'missed', 'false', 'log', 'square'),
                    np.array(rows, float).T, strict=True))


def calibration(truth: dict[str, list[str]], found: dict[str, dict]) -> tuple[float, float]:
    """Return how many effects are present among all, and how many the probabilities promise."""
    told = sum(one['probability'].get(name, 0.0) for vehicle, one in found.items()
               if vehicle in truth for name in EFFECTS)
    return float(sum(map(len, truth.values()))), float(told)


def compared(truth: dict[str, list[str]], without: dict[str, dict], given: dict[str, dict]
             ) -> dict:
    """Return each measure without and with priors, and the mean change with its standard error."""
    before, after = measures(truth, without), measures(truth, given)
    count = len(truth)
    result = {name: {'without': float(before[name].mean()), 'with': float(after[name].mean()),
                     'change': float(np.mean(after[name] - before[name])),
                     'std': float(np.std(after[name] - before[name], ddof=1) / np.sqrt(count))}
              for name in before}
    present, told = calibration(truth, without)
    return {'vehicles': count, 'measures': result, 'present': present, 'promised_without': told,
            'promised_with': calibration(truth, given)[1]}


def no_worse(result: dict) -> bool:
    """Return whether no measure is surely worse with priors: by two standard errors."""
    return all((one['change'] if name != 'exact' else -one['change']) <= 2.0 * one['std']
               for name, one in result['measures'].items())


def text_of(result: dict) -> str:
    """Return a comparison as a table of text."""
    said = {'exact': 'exact sets', 'missed': 'missed effects a vehicle',
            'false': 'false effects a vehicle', 'log': 'logarithmic error of the probabilities',
            'square': 'squared error of the probabilities'}
    lines = [f'{result["vehicles"]} vehicles that taught nothing, seed {result["seed"]}',
             f'{"":40}{"without":>9}{"with":>9}   change']
    for name, one in result['measures'].items():
        lines.append(f'{said[name]:40}{one["without"]:9.4f}{one["with"]:9.4f}   '
                     f'{one["change"]:+.4f} ± {one["std"]:.4f}')
    lines.append(f'effects present: {result["present"]:.0f}; the probabilities promise '
                 f'{result["promised_without"]:.1f} without and {result["promised_with"]:.1f} '
                 'with priors')
    return '\n'.join(lines)
