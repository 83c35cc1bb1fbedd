# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Time and memory of `vp`, and of all that goes with it, from 500 to 5,000,000 samples."""

from pathlib import Path
import subprocess
import sys
import tempfile

import numpy as np

from benchmarks import ours
from benchmarks.machine import timed
from benchmarks.problems import p2, PERIOD
from benchmarks.tables import markdown, number, targets
from quad_ident_ros.identify.signals import Signal

SAMPLES = (500, 5_000, 50_000, 500_000, 5_000_000)
TOTAL = 500_000      # samples over which the time of a short record is averaged
MOST_COPIES = 3.0
LONG = 5_000         # samples from which memory is held against the data
FIRST_CALL = 5_000   # samples of a first call that is not measured


WAYS = {'the fit': ours.fit_vp, 'with errors and residual tests': ours.fit_whole,
        'with other orders too': ours.fit_with_orders}


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    counts = [samples for samples in SAMPLES if samples <= size.largest]
    goals, tables = [], []
    with bar('from 500 to 5,000,000 samples', len(counts) * len(WAYS)) as advance:
        for way in WAYS:
            rows, times, copies = _rows(way, counts, advance)
            goals += _goals(way, counts, times, copies)
            head = (way, 'CPU, ms', 'ns per sample', 'evaluations', 'u and y, MB',
                    'beside them, MB', 'copies')
            tables.append(markdown(head, rows))
    return '\n\n'.join([targets(goals), *tables])


def _rows(way, counts, advance):
    """Return the rows of a table, the CPU times and the copies of the data, by samples."""
    rows, times, copies = [], [], []
    for samples in counts:
        signal = p2(samples, 'PRBS', 20).draw(0)[0]
        _, spent = WAYS[way]([signal], 0)
        repeats = max(3, TOTAL // samples)
        times.append(float(np.median([timed(WAYS[way], [signal], 0)[1]
                                      for _ in range(repeats)])))
        data, extra = _memory(signal, way)
        copies.append(extra / data)
        rows.append((f'{samples:,}', number(1e3 * times[-1]), number(1e9 * times[-1] / samples),
                     number(spent), number(data / 1e6), number(extra / 1e6), number(copies[-1])))
        advance()
    return rows, times, copies


def _goals(way, counts, times, copies):
    slope = np.polyfit(np.log(counts), np.log(times), 1)[0]
    longer, growth = counts[-1] / counts[0], times[-1] / times[0]
    # 500 samples are 8 kB, less than the working arrays of any fit.
    most = max(copy for samples, copy in zip(counts, copies, strict=True) if samples >= LONG)
    return [(f'{way}: growth of time over × {longer:,.0f} of samples; as a power of them',
             'no faster than linear', f'× {number(growth)}; {slope:.2f}',
             growth <= longer and slope <= 1.0),
            (f'{way}: memory beside the data, from {LONG:,} samples on, at most',
             f'≤ {MOST_COPIES:.0f} copies', number(most), most <= MOST_COPIES)]


def _memory(signal, way):
    """Return the bytes of u and y, and the most that a fit in a fresh process takes beside."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'signal.npy'
        np.save(path, np.array([signal.u, signal.y]))
        done = subprocess.run([sys.executable, '-m', 'benchmarks.scaling', str(path), way],
                              capture_output=True, text=True, check=True)
    return signal.u.nbytes + signal.y.nbytes, int(done.stdout)


def _measure(path, way):
    """Print the bytes by which a fit of the data in a file raises this process's memory."""
    u, y = np.load(path)
    WAYS[way]([p2(FIRST_CALL, 'PRBS', 20).draw(0)[0]], 0)     # loads the program
    signal = Signal('phi', PERIOD * np.arange(len(u)), u, y, PERIOD, True)
    before = _status('VmRSS')
    Path('/proc/self/clear_refs').write_text('5', encoding='ascii')    # forgets the peak
    WAYS[way]([signal], 0)
    print(max(0, _status('VmHWM') - before))


def _status(key):
    lines = Path('/proc/self/status').read_text(encoding='ascii').splitlines()
    return 1024 * int(next(line for line in lines if line.startswith(key)).split()[1])


if __name__ == '__main__':
    _measure(*sys.argv[1:])
