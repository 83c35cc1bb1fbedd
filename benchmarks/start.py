# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the first start costs, when everything is compiled, and a later one."""

import os
import subprocess
import sys
import tempfile
import time

from benchmarks.tables import markdown, number

TASKS = ('import', 'vp', 'PSO-CS')


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    with tempfile.TemporaryDirectory() as folder, bar('starts', 2) as advance:
        starts = []
        for _ in range(2):
            starts.append(_start(folder))
            advance()
    first, later = starts
    rows = [(name, number(one), number(other))
            for name, one, other in zip(TASKS, first, later, strict=True)]
    rows.append(('together', number(sum(first)), number(sum(later))))
    return markdown(('P1, CPU time in s', 'first start, compiling', 'later, cached'), rows)


def _start(folder):
    done = subprocess.run([sys.executable, '-m', 'benchmarks.start'], capture_output=True,
                          text=True, check=True, env={**os.environ, 'NUMBA_CACHE_DIR': folder})
    return [float(value) for value in done.stdout.split()]


def _measure():
    """Print the CPU time of the import, of the first vp and of the first PSO-CS, s."""
    begin = time.process_time()
    from benchmarks import ours
    from benchmarks.problems import p1
    times = [time.process_time() - begin]
    signals = p1()[0].draw(0)
    for fit in (ours.fit_vp, ours.fit_pso_cs):
        begin = time.process_time()
        fit(signals, 0)
        times.append(time.process_time() - begin)
    print(*times)


if __name__ == '__main__':
    _measure()
