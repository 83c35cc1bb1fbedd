# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Problem P3: physical parameters of a vehicle from a flight, beside mujoco.sysid."""

import numpy as np

from benchmarks import peers_mujoco
from benchmarks.compare import FEWEST, quiet
from benchmarks.flights import FlightProblem, NAMES
from benchmarks.machine import timed
from benchmarks.tables import markdown, number, targets
from quad_ident_ros.greybox.fit import fit

KNOWN, FREE = '`fit`, mass known', '`fit`, all eight free'
PEERS = {'mujoco.sysid, weighted by the noise': peers_mujoco.fit_weighted,
         'mujoco.sysid, default residual': peers_mujoco.fit_default}
YARDSTICK = 18.0    # ms, of a compiled fit with free initial states
MOST_TIME, MOST_RMSE = 3.0, 1.15
MORE_EXACT, FASTER = 5.0, 100.0
LEVEL, COVERED = 1.96, (0.90, 0.99)


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    problem = FlightProblem()
    draws = {KNOWN: size.accuracy_draws[0], FREE: size.draws, **dict.fromkeys(PEERS, FEWEST)}
    rows, scores = [], {}
    with bar('P3', sum(draws.values())) as advance:
        for label in draws:
            try:
                found, seconds = _measured(problem, label, draws[label], advance)
            except Exception as error:      # whatever a peer comes up with
                if label not in PEERS:
                    raise
                rows.append((label, f'fails: {type(error).__name__}', '', '', ''))
                continue
            misses = (found[:, 0] - problem.truth) / problem.bound
            rmse = float(np.sqrt(np.mean(misses ** 2)))
            inside = np.abs(found[:, 0] - problem.truth) <= LEVEL * found[:, 1]
            share = float(inside.mean()) if np.isfinite(found).all() else np.nan
            scores[label] = rmse, 1e3 * float(np.median(seconds)), share
            rows.append((label, number(scores[label][1]), number(rmse),
                         number(float(np.sqrt(np.mean(misses ** 2, axis=0)).max())),
                         '–' if share != share else f'{100 * share:.0f} %'))
    head = ('method', 'CPU, ms', 'RMSE/CRB', 'its worst parameter', 'coverage of 95 %')
    return f'{targets(_goals(scores))}\n\n{markdown(head, rows)}'


def ours(record, vehicle, names):
    """Return values and standard errors of NAMES but the mass, (2, 7)."""
    found = {parameter.name: parameter for parameter in fit([record], vehicle, names).parameters}
    return np.array([[getattr(found[name], field) for name in NAMES[1:]]
                     for field in ('value', 'std')], float)


def _measured(problem, label, draws, advance):
    """Return values and standard errors (draws, 2, 7), and CPU times s; one more draw first."""
    found, times = [], []
    for draw in [draws] * (label not in PEERS) + list(range(draws)):
        record, vehicle = problem.draw(draw), problem.start(draw)
        with quiet():
            if label in PEERS:
                values, seconds = timed(PEERS[label], record, vehicle)
                values = np.array([values, np.full_like(values, np.nan)])
            else:
                values, seconds = timed(ours, record, vehicle, NAMES[label == KNOWN:])
        found.append(values)
        times.append(seconds)
        advance()
    return np.array(found[-draws:]), times[-draws:]


def _goals(scores):
    rmse, milliseconds, share = scores[KNOWN]
    low, high = COVERED
    rows = [('CPU time', f'≤ {MOST_TIME * YARDSTICK:.0f} ms', f'{number(milliseconds)} ms',
             milliseconds <= MOST_TIME * YARDSTICK),
            ('RMSE/CRB', f'≤ {MOST_RMSE}', number(rmse), rmse <= MOST_RMSE),
            ('coverage of 95 % intervals', f'{100 * low:.0f}–{100 * high:.0f} %',
             f'{100 * share:.1f} %', low <= share <= high)]
    peers = [scores[label] for label in PEERS if label in scores]
    if peers:
        exact = min(peer[0] for peer in peers) / rmse
        faster = min(peer[1] for peer in peers) / milliseconds
        rows += [('times more exact than mujoco.sysid at its best', f'≥ {MORE_EXACT:.0f}',
                  number(exact), exact >= MORE_EXACT),
                 ('times faster than mujoco.sysid at its best', f'≥ {FASTER:.0f}',
                  number(faster), faster >= FASTER)]
    return rows
