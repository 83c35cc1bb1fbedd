# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Known truth over many draws of the noise: errors, bias and coverage of the intervals."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.stats import binom, norm

from benchmarks import ours
from benchmarks.bound import NAMES, pole_values
from benchmarks.compare import quiet
from benchmarks.problems import INPUTS, Problem
from benchmarks.tables import markdown, targets
from quad_ident_ros.cluster import cluster, values
from quad_ident_ros.identify.transfer import SecondOrder

SYSTEMS = {'stable': SecondOrder.from_poles(4.0, 2.0, 0.5),
           'integrating': SecondOrder.from_poles(4.0, 2.0, 0.0),
           'unstable': SecondOrder.from_poles(4.0, 2.0, -0.3),
           'complex': SecondOrder.from_half_difference(4.0, 0.5, -2.0)}
NOISE = (0.001, 0.01, 0.1)      # standard deviation over the response's range
SAMPLES = 1000
AT_ONCE = 50        # draws that a task fits: each is a matter of milliseconds

LEVEL = 0.95
CURVED = 0.1            # bias that linear theory must not predict, in standard deviations
MOST_RMSE, MOST_BIAS, COVERAGE = 1.1, 0.25, (0.92, 0.98)


@dataclass(frozen=True)
class Cell:
    """What was found of one parameter in one scenario; all ratios but the coverage to errors."""

    name: str
    meaningful: bool
    rmse: float
    bias: float
    coverage: float


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    few, many = size.accuracy_draws
    scenarios = [(excitation, share) for excitation in INPUTS for share in NOISE]
    first, all_ = {}, {}
    with bar('known truth', len(scenarios) * many) as advance, cluster() as client:
        for number, (excitation, share) in enumerate(scenarios):
            problem = Problem(f'{excitation}, {share:.1%}', tuple(SYSTEMS.values()), excitation,
                              SAMPLES, share, 100 + number)
            misses, errors = _fits(client, problem, many, advance)
            for i, (name, bound) in enumerate(zip(SYSTEMS, problem.bounds, strict=True)):
                key = name, excitation, share
                first[key] = _cells(bound, misses[:few, i], errors[:few, i])
                all_[key] = _cells(bound, misses[:, i], errors[:, i])
    rows = [(*key[:2], f'{100 * key[2]:g} %', *_shown(all_[key]))
            for key in sorted(all_, key=lambda key: list(SYSTEMS).index(key[0]))]
    head = ('system', 'input', 'noise', 'RMSE/CRB', 'bias over error', 'coverage, %',
            'no meaningful bound')
    return (f'{targets([*_goals(first, few), *_goals(all_, many)])}\n\n'
            f'Of {many:,} draws:\n\n{markdown(head, rows)}')


def _fits(client, problem, draws, advance):
    """Return the misses and the standard errors of all fits, (draws, systems, parameters)."""
    some = [range(first, min(first + AT_ONCE, draws)) for first in range(0, draws, AT_ONCE)]
    found = {}
    for each, fits in values(client, partial(_fits_of, problem), some):
        found[each] = fits
        for _ in each:
            advance()
    misses, errors = zip(*(fits for each in some for fits in found[each]), strict=True)
    return np.array(misses), np.array(errors)


def _fits_of(problem, draws):
    """Return the misses and the standard errors of each draw, (systems, parameters)."""
    fits = []
    for draw in draws:
        misses, errors = np.full((2, len(problem.truths), len(NAMES)), np.nan)
        for i, signal in enumerate(problem.draw(draw)):
            with quiet():
                model, deviations = ours.fit_vp_any(signal)
            misses[i] = _estimate(model, problem.truths[i].form) - problem.bounds[i].values
            errors[i] = [np.nan if deviations[name] is None else deviations[name]
                         for name in NAMES]
        fits.append((misses, errors))
    return fits


def _cells(bound, misses, errors):
    """Return the Cells of one scenario from misses and standard errors (draws, parameters)."""
    rmse = np.sqrt(np.mean(misses ** 2, axis=0)) / bound.errors
    bias = np.abs(misses.mean(axis=0)) / bound.errors
    coverage = np.mean(np.abs(misses) <= norm.ppf(0.5 + LEVEL / 2) * errors, axis=0)
    meaningful = np.abs(bound.biases) <= CURVED * bound.errors
    return [Cell(*entry)
            for entry in zip(NAMES, meaningful, rmse, bias, coverage, strict=True)]


def _estimate(model, form):
    """Return K, c1, c0 and the poles; a and b are None where the true poles are alike."""
    poles = pole_values(model.c1, model.c0) if model.form == form else (np.nan, np.nan)
    return np.array([model.gain, model.c1, model.c0, *poles])


def _shown(cells):
    good = [cell for cell in cells if cell.meaningful]
    bad = ', '.join(cell.name for cell in cells if not cell.meaningful)
    if not good:
        return '–', '–', '–', bad
    covered = [100 * cell.coverage for cell in good]
    return (f'{min(cell.rmse for cell in good):.2f}–{max(cell.rmse for cell in good):.2f}',
            f'{max(cell.bias for cell in good):.2f}',
            f'{min(covered):.1f}–{max(covered):.1f}', bad)


def _goals(found, draws):
    """Return rows for the targets, each with what chance alone leaves of a perfect estimate."""
    cells = [cell for scenario in found.values() for cell in scenario if cell.meaningful]
    low, high = COVERAGE
    inside = (binom.cdf(np.floor(high * draws + 1e-9), draws, LEVEL)
              - binom.cdf(np.ceil(low * draws - 1e-9) - 1, draws, LEVEL))
    checks = (
        ('RMSE/CRB', f'≤ {MOST_RMSE}', [cell.rmse <= MOST_RMSE for cell in cells],
         norm.cdf((MOST_RMSE - 1) * np.sqrt(2 * draws)),
         f'worst {max(cell.rmse for cell in cells):.2f}'),
        ('bias over error', f'< {MOST_BIAS}', [cell.bias < MOST_BIAS for cell in cells],
         1 - 2 * norm.sf(MOST_BIAS * np.sqrt(draws)),
         f'worst {max(cell.bias for cell in cells):.2f}'),
        (f'coverage of {100 * LEVEL:.0f} % intervals', f'{100 * low:.0f}–{100 * high:.0f} %',
         [low - 1e-9 <= cell.coverage <= high + 1e-9 for cell in cells], inside,
         f'mean {100 * np.mean([cell.coverage for cell in cells]):.1f} %'))
    count = len(cells)
    return [(f'{what}, {draws:,} draws', target,
             f'{sum(met)} of {count} ({count * chance:.0f} by chance alone), {extra}', all(met))
            for what, target, met, chance, extra in checks]
