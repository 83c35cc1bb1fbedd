# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Run the benchmarks: `./run bench [SECTION ...] [--quick]`."""

import argparse
import contextlib
import sys

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from benchmarks import accuracy, limit, p1, p2, scaling, start
from benchmarks.machine import described, take_one_core
from benchmarks.size import QUICK, Size
from benchmarks.tables import keep
from quad_ident_ros.errors import InputError

# The function of each section, and the document that keeps its results.
SECTIONS = {'p1': (p1.run, 'performance.md'), 'p2': (p2.run, 'performance.md'),
            'scaling': (scaling.run, 'performance.md'), 'limit': (limit.run, 'performance.md'),
            'start': (start.run, 'performance.md'), 'accuracy': (accuracy.run, 'accuracy.md')}
PACKAGES = ('numpy', 'scipy', 'numba', 'pyswarms', 'mealpy', 'nevergrad', 'cma', 'pymoo',
            'sippy-unipi')


def main(arguments=None):
    """Run the sections that are asked for, print their tables and keep them in docs/."""
    parser = argparse.ArgumentParser(prog='./run bench', description=__doc__)
    parser.add_argument('sections', nargs='*', metavar='SECTION',
                        help=f'one of {", ".join(SECTIONS)}; by default all but accuracy')
    parser.add_argument('--quick', action='store_true',
                        help='few draws, to see that it works: prints and keeps nothing')
    options = parser.parse_args(arguments)
    for name in options.sections:
        if name not in SECTIONS:
            parser.error(f'{name}: no such section, expected one of {", ".join(SECTIONS)}')
    take_one_core()
    screen = Console(stderr=True)

    @contextlib.contextmanager
    def bar(title, total):
        with Progress(TextColumn('{task.description}'), BarColumn(), TimeElapsedColumn(),
                      console=screen) as progress:
            task = progress.add_task(title, total=total)
            yield lambda: progress.advance(task)

    for name in options.sections or [name for name in SECTIONS if name != 'accuracy']:
        run, document = SECTIONS[name]
        found = run(QUICK if options.quick else Size(), bar)
        text = f'{found}\n\nMeasured: {described(PACKAGES)}.'
        print(f'\n## {name}\n\n{text}\n', flush=True)
        if not options.quick:
            try:
                keep(document, name, text)
            except InputError as error:
                screen.print(f'error: {error}', markup=False)
                return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
