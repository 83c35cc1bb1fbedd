# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Run the benchmarks: `./run bench [SECTION ...] [--quick | --keep]`."""

import argparse
import contextlib
import importlib
import sys

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from benchmarks import runs
from benchmarks.machine import described, take_one_core
from benchmarks.size import QUICK, Size
from benchmarks.tables import keep
from quad_ident_ros.errors import InputError

# The document that keeps the results of each section, which is a module of the same name.
SECTIONS = {'p1': 'performance.md', 'p2': 'performance.md', 'p3': 'performance.md',
            'scaling': 'performance.md', 'limit': 'performance.md', 'start': 'performance.md',
            'accuracy': 'accuracy.md', 'rollout': 'performance.md',
            'diagnosis': 'performance.md', 'graph': 'performance.md', 'long': 'performance.md',
            'fleet': 'performance.md', 'days': 'fleet.md', 'spring': 'fleet.md',
            'cautions': 'reliability.md', 'changes': 'reliability.md'}
# Only where they are asked for, one at a time, as the program is installed, see run.
APART = ('accuracy', 'graph', 'long', 'fleet', 'days', 'spring', 'cautions', 'changes')
ALL_CORES = ('accuracy', 'graph', 'fleet', 'cautions', 'changes')     # all but `graph` by Dask
PACKAGES = ('numpy', 'scipy', 'numba', 'pyswarms', 'mealpy', 'nevergrad', 'cma', 'pymoo',
            'sippy-unipi', 'rotorpy', 'distributed', 'pyarrow', 'mujoco', 'ros-jazzy-rclpy')


def main(arguments=None):
    """Run the sections that are asked for, print their tables, and keep them if asked to."""
    parser = argparse.ArgumentParser(
        prog='./run bench', description=__doc__,
        epilog='There is no --scheduler: most sections measure times of this machine, which a '
        'cluster would not have. The draws of accuracy, cautions and changes go over the cores of '
        'this machine, by functions of the checkout that workers elsewhere do not have.')
    parser.add_argument('sections', nargs='*', metavar='SECTION',
                        help=f'one of {", ".join(SECTIONS)}; by default all but '
                        f'{" and ".join(APART)}')
    parser.add_argument('--quick', action='store_true', help='few draws, to see that it works')
    parser.add_argument('--keep', action='store_true',
                        help='put the tables into docs/, which is tracked, and those that they '
                        'replace into docs/performance/; not with --quick')
    options = parser.parse_args(arguments)
    if options.quick and options.keep:
        parser.error('--keep: few draws are nothing to keep')
    for name in options.sections:
        if name not in SECTIONS:
            parser.error(f'{name}: no such section, expected one of {", ".join(SECTIONS)}')
    for name in APART:
        if name in options.sections and len(options.sections) > 1:
            parser.error(f'{name}: name it by itself, it needs no other library')
    whole = options.sections[:1] in ([name] for name in ALL_CORES)
    if not whole:
        take_one_core()
    screen = Console(stderr=True)

    @contextlib.contextmanager
    def bar(title, total):
        with Progress(TextColumn('{task.description}'), BarColumn(), TimeElapsedColumn(),
                      console=screen) as progress:
            task = progress.add_task(title, total=total)
            yield lambda: progress.advance(task)

    for name in options.sections or [name for name in SECTIONS if name not in APART]:
        run = importlib.import_module(f'benchmarks.{name}').run
        try:
            found = run(QUICK if options.quick else Size(), bar)
            text = f'{found}\n\nMeasured: {described(PACKAGES, "all" if whole else "one")}.'
            print(f'\n## {name}\n\n{text}\n', flush=True)
            if options.keep:
                with runs.older_kept(SECTIONS[name], name):
                    keep(SECTIONS[name], name, text)
        except InputError as error:
            screen.print(f'error: {error}', markup=False)
            return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
