# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One evaluation of the objective beside the arithmetic that the machine could do."""

import numpy as np

from benchmarks.machine import peak_flops, timed
from benchmarks.problems import GAIN_BOUNDS, p1, p2, POLE_BOUNDS
from benchmarks.tables import markdown, number, targets
from quad_ident_ros.identify.objective import Objective

CANDIDATES, REPEATS, FARTHEST = 4000, 21, 4.0

# Operations per candidate and sample of the shortest recursion known to us: f(k+2) = b0 u(k) +
# b1 u(k+1) - a0 f(k) - a1 f(k+1) has 7 at a gain within b0 and b1; then the error, its square and
# the sum, 3, or with the gain projected out the two sums of f f and f y, 4.
FLOPS = {'gain given': 10, 'gain projected out': 11}


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    random = np.random.default_rng(0)
    gain = random.uniform(*GAIN_BOUNDS, CANDIDATES)
    a, b = random.uniform(*POLE_BOUNDS, (2, CANDIDATES))
    calls = {'gain given': lambda objective: objective.of_models(gain, a + b, a * b),
             'gain projected out': lambda objective: objective.of_poles(a + b, a * b)}
    problems = {'step': p1()[0], 'PRBS': p2(500, 'PRBS', 30)}
    with bar('the arithmetic limit', REPEATS * len(calls) * len(problems)) as advance:
        peaks, seconds = [], {(name, kind): [] for name in problems for kind in calls}
        objectives = {name: [Objective(signal) for signal in problem.draw(0)]
                      for name, problem in problems.items()}
        for repeat in range(REPEATS):
            peaks.append(peak_flops() if repeat % 5 == 0 else peaks[-1])
            for (name, kind), measured in seconds.items():
                measured.append(timed(lambda call=calls[kind], name=name: [
                    call(objective) for objective in objectives[name]])[1])
                advance()
    peak = max(peaks)
    rows, ratios = [], []
    for (name, kind), measured in seconds.items():
        took = float(np.median(measured))
        flops = FLOPS[kind] * CANDIDATES * sum(len(objective.signal.y)
                                               for objective in objectives[name])
        ratios.append(took * peak / flops)
        rows.append((f'{name}, {kind}', FLOPS[kind], number(1e3 * took),
                     number(1e9 * took / (flops / FLOPS[kind])), number(flops / took / 1e9),
                     number(1e3 * flops / peak), number(ratios[-1])))
    goals = [(f'{kind}, of {number(peak / 1e9)} GFLOP/s', f'≤ {FARTHEST:.0f}', number(ratio),
              ratio <= FARTHEST) for (kind, *_), ratio in zip(rows, ratios, strict=True)]
    head = ('4,000 evaluations of 4 outputs, 500 samples', 'flop per sample', 'CPU, ms',
            'ns per sample', 'GFLOP/s', 'at the limit, ms', 'distance')
    return f'{targets(goals)}\n\n{markdown(head, rows)}'
