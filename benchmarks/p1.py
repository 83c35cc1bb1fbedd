# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Problem P1: speed and cost against population methods and least squares."""

import numpy as np
import scipy.signal

from benchmarks import ours, peers, peers_direct
from benchmarks.compare import compare, Contender, each, quiet
from benchmarks.joint import Joint, pursue, searching, Tracker
from benchmarks.machine import timed
from benchmarks.problems import p1
from benchmarks.tables import markdown, number, targets

VP, VP_AUTO = '`vp`, real poles', '`vp`, pairs of poles too'
PSO_CS, JOINT = 'PSO-CS, per output', 'PSO-CS, joint'
CLOSE = 0.01            # of the best cost: what counts as reaching it
LSIM_CANDIDATES = 20    # that the time per candidate is taken from
FIRST_CALL = 400        # evaluations of a first call that is not measured
SEARCHES = ((JOINT, ours.joint_pso_cs), *peers.PEERS)


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    stable, unstable = p1()
    contenders = _contenders()
    with bar('P1', 2 * size.draws * len(contenders)) as advance:
        scores, best = compare(stable, contenders, size.draws, size.seconds, advance)
        others, _ = compare(unstable, contenders, size.draws, size.seconds, advance)
    with bar('P1, to the best cost', len(SEARCHES) * size.long_runs) as advance:
        reached = {label: _reach(stable, search, best, size, advance)
                   for label, search in SEARCHES if not scores[label].failure}
    lsim = _lsim_seconds(stable)
    rows = [_row(label, scores, others, reached) for label in scores]
    rows.append(('`lsim` per candidate', f'{1e3 * lsim * ours.BUDGET:,.0f}', '', '',
                 f'{ours.BUDGET:,}', '', '', '', '', ''))
    swarm, joint, pyswarms = scores[PSO_CS], scores[JOINT], scores['pyswarms PSO']
    goals = [
        ("PSO-CS, the paper's settings, CPU time", '≤ 8 ms',
         f'{number(swarm.milliseconds)} ms', swarm.milliseconds <= 8),
        ('its J/J_ML, per output (joint beside it)', '≤ 1.05',
         f'{number(swarm.ratio, 4)} ({number(joint.ratio)})', swarm.ratio <= 1.05),
        *(goal for label in (VP, VP_AUTO) for goal in _vp_goals(label, scores, others)),
        ("PSO-CS against pyswarms' PSO, same evaluations", 'less time, lower cost',
         _against(swarm, pyswarms),
         not pyswarms.seconds or (swarm.milliseconds < pyswarms.milliseconds
                                  and swarm.ratio < pyswarms.ratio))]
    head = ('method', 'CPU, ms', 'over vp', 'over PSO-CS', 'evaluations', 'J/J_ML, stable',
            'unstable', 'RMSE/CRB, stable', 'unstable', f'to {100 * CLOSE:.0f} % of the best cost')
    return f'{targets(goals)}\n\n{markdown(head, rows)}'


def _vp_goals(label, scores, others):
    score, other = scores[label], others[label]
    worst = max(score.ratios.max(), other.ratios.max())
    return ((f'{label}: CPU time', '≤ 0.5 ms', f'{number(score.milliseconds)} ms',
             score.milliseconds <= 0.5),
            (f'{label}: J/J_ML, worst draw, stable and unstable', '1', f'{worst:.6f}',
             worst <= 1 + 1e-6),
            (f'{label}: RMSE/CRB, stable and unstable', '≤ 1.1',
             f'{score.rmse:.2f}, {other.rmse:.2f}', max(score.rmse, other.rmse) <= 1.1))


def _contenders():
    direct = (*peers_direct.LEAST_SQUARES, *peers_direct.SIPPY)
    return (Contender(VP, ours.fit_vp_real), Contender(VP_AUTO, ours.fit_vp),
            Contender(PSO_CS, ours.fit_pso_cs),
            *(Contender(label, searching(search, ours.BUDGET), searching(search, FIRST_CALL))
              for label, search in SEARCHES),
            *(Contender(label, each(fit)) for label, fit in direct))


def _reach(problem, search, best, size, advance):
    """Return what a search needs to come close to the best cost, as text."""
    spent, seconds, left = [], [], []
    for draw in range(min(size.long_runs, len(best))):
        target = (1 + CLOSE) * best[draw]
        tracker = Tracker(Joint(problem.draw(draw)), size.long_budget, size.long_seconds, target)
        with quiet():
            _, took = timed(pursue, search, tracker, draw)
        spent.append(tracker.spent)
        seconds.append(took)
        left.append(tracker.best_cost / best[draw])
        advance()
    if np.median(left) <= 1 + CLOSE:
        return f'{number(float(np.median(spent)))} in {number(float(np.median(seconds)))} s'
    return (f'not in {number(float(np.median(spent)))} or {number(float(np.median(seconds)))} s '
            f'(J/J_ML {number(float(np.median(left)))})')


def _row(label, scores, others, reached):
    score, other = scores[label], others[label]
    if score.failure:
        return (label, score.failure, *[''] * 8)
    close = reached.get(label) or (
        f'{number(score.milliseconds / 1e3)} s' if score.ratio <= 1 + CLOSE else 'not')
    return (label, number(score.milliseconds),
            number(score.milliseconds / scores[VP].milliseconds),
            number(score.milliseconds / scores[PSO_CS].milliseconds), score.spent,
            number(score.ratio, 4), number(other.ratio, 4), number(score.rmse),
            number(other.rmse), close)


def _against(swarm, pyswarms):
    if not pyswarms.seconds:
        return pyswarms.failure
    return (f'{number(swarm.milliseconds)} and {number(pyswarms.milliseconds)} ms, J/J_ML '
            f'{number(swarm.ratio)} and {number(pyswarms.ratio)}')


def _lsim_seconds(problem):
    """Return the CPU time of one joint evaluation whose responses come from lsim, s."""
    def evaluate():
        for truth in problem.truths:
            system = scipy.signal.StateSpace([[0.0, 1.0], [-truth.c0, -truth.c1]],
                                             [[0.0], [truth.gain]], [[1.0, 0.0]], [[0.0]])
            scipy.signal.lsim(system, problem.u, problem.t, interp=False)
    evaluate()
    return float(np.median([timed(evaluate)[1] for _ in range(LSIM_CANDIDATES)]))
