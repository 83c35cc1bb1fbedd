# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Problem P2: longer records of rich input, without a start value."""

from benchmarks import ours, peers, peers_direct
from benchmarks.compare import compare, Contender, each
from benchmarks.joint import searching
from benchmarks.problems import p2
from benchmarks.tables import markdown, number, targets

VP = '`vp`'
CLOSE = 0.01            # of the best cost
EQUAL = 1e-6            # of the best cost: where the same optimum is meant
TOO_SLOW = ('scipy least_squares, lsim', 'SIPPY OE')    # a minute and more per draw
SHORT, LONG = 5_000, 50_000
FIRST_CALL = 200        # evaluations of a first call that is not measured
POPULATIONS = ('pyswarms PSO', 'scipy differential_evolution', 'pycma CMA-ES')


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    parts, goals = [], []
    for number_, (samples, excitation) in enumerate(
            (samples, excitation) for samples in (SHORT, LONG)
            for excitation in ('PRBS', 'multisine')):
        problem = p2(samples, excitation, 10 + number_)
        contenders = _contenders(samples)
        with bar(problem.title, size.draws * len(contenders)) as advance:
            scores, _ = compare(problem, contenders, size.draws, size.seconds, advance)
        with bar(f'{problem.title}, vp', size.share_draws) as advance:
            alone, _ = compare(problem, contenders[:1], size.share_draws, float('inf'), advance)
        alone = alone[VP]
        rows = [_row(label, score, scores[VP]) for label, score in scores.items()]
        parts.append(f'{problem.title}:\n\n' + markdown(
            ('method', 'draws', 'CPU, ms', 'over vp', 'evaluations', 'J/J_ML',
             f'draws within {100 * CLOSE:.0f} %', 'RMSE/CRB'), rows))
        if samples == LONG:
            goals += [
                (f'`vp`, {excitation}, {samples:,} samples, CPU time', '≤ 25 ms',
                 f'{number(alone.milliseconds)} ms', alone.milliseconds <= 25),
                (f'its share of {size.share_draws} draws at the global optimum', '100 %',
                 f'{100 * alone.at_best(EQUAL):.1f} %', alone.at_best(EQUAL) == 1),
                (f'its RMSE/CRB over {size.share_draws} draws', '≤ 1.1', f'{alone.rmse:.2f}',
                 alone.rmse <= 1.1)]
    return '\n\n'.join([targets(goals), *parts])


def _contenders(samples):
    direct = [*peers_direct.LEAST_SQUARES, *peers_direct.SIPPY]
    if samples == LONG:
        direct = [entry for entry in direct if entry[0] not in TOO_SLOW]
    return [Contender(VP, ours.fit_vp),
            *(Contender(label, searching(search, ours.BUDGET), searching(search, FIRST_CALL))
              for label, search in peers.PEERS if label in POPULATIONS),
            *(Contender(label, each(fit)) for label, fit in direct)]


def _row(label, score, best):
    if score.failure and not score.seconds:
        return (label, score.failure, *[''] * 6)
    return (label, len(score.seconds), number(score.milliseconds),
            number(score.milliseconds / best.milliseconds), score.spent, number(score.ratio, 4),
            f'{100 * score.at_best(CLOSE):.0f} %', number(score.rmse))
