# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident paper`: the paper reproduced, and what of it holds."""

import argparse
from contextlib import contextmanager
from functools import partial
from pathlib import Path
import time

from quad_ident_ros.cluster import cluster, values
from quad_ident_ros.errors import InputError
from quad_ident_ros.paper import page
from quad_ident_ros.paper.claims import claims as claims_of
from quad_ident_ros.paper.presets import PRESETS
from quad_ident_ros.paper.reproduce import as_data, reproduce
from quad_ident_ros.paper.study import in_turn
from quad_ident_ros.paper.summary import conclusions_table, errors_table
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.screen import console, progress_bar
from quad_ident_ros.report.svg import drawings


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'paper', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Reproduce the paper: fit all methods to its experiments over many seeds, '
                    'compute its Table 3 from\nits Table 2, fly its equations as printed, and say '
                    'which of its claims hold. Writes paper.html,\npaper.json and the pictures.',
        epilog='presets; the last one is the responses that Table 3 implies, not a flight:\n'
        + ''.join(f'  {name}\n' for name in PRESETS)
        + '\nAll of them with 20 seeds take half a minute. A quick look, and many seeds on all '
          'cores or a cluster:\n'
          '  quad_ident paper --seeds 6 --preset hover_single_axis\n'
          '  quad_ident paper --seeds 1000 --workers 8')
    parser.add_argument('--preset', action='append', choices=tuple(PRESETS), metavar='NAME',
                        help='an experiment to reproduce, may be repeated (default: all)')
    parser.add_argument('--seeds', type=int, default=20, metavar='N',
                        help='seeds of the searches: 0 to N - 1 (default 20; fewer than 6 decide '
                             'nothing about which is better)')
    parser.add_argument('--workers', type=int, metavar='N',
                        help='processes on this machine that share the seeds, by Dask (default: '
                             'this process runs all of them)')
    parser.add_argument('--scheduler', metavar='tcp://HOST:PORT',
                        help='address of a running Dask cluster, whose workers share the seeds')
    parser.add_argument('-o', '--output', default='quad_ident_paper', metavar='FOLDER',
                        help='where everything goes (default: quad_ident_paper)')
    parser.add_argument('--json', metavar='FILE',
                        help='write the results as data here as well; - prints them')
    parser.set_defaults(run=run)


def run(options):
    """Reproduce the paper, write page, data and pictures, and show the conclusions."""
    if options.seeds < 1:
        raise InputError(f'--seeds: expected at least 1, got {options.seeds}')
    if options.workers is not None and options.workers < 1:
        raise InputError(f'--workers: expected at least 1, got {options.workers}')
    if options.workers and options.scheduler:
        raise InputError('--workers: it is for processes on this machine; with --scheduler its '
                         'own workers are used')
    if not options.output:
        raise InputError('--output: expected the name of a folder, got nothing')
    names = tuple(dict.fromkeys(options.preset or PRESETS))
    folder = Path(options.output)
    # Before a minute of work, not after it: a folder that cannot be made.
    folder.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter()
    with _each(options) as each, progress_bar() as bar:
        task = bar.add_task('', total=1.0)
        found = reproduce(names, options.seeds, lambda text, share: bar.update(
            task, description=text, completed=share), each)
        bar.update(task, description='drawing')
        pictures = drawings(page.figures(found), folder)
    claims = claims_of(found)
    data = as_data(found, claims)
    page.write(folder / 'paper.html', found, claims, pictures)
    write_json(folder / 'paper.json', data)
    if options.json != '-':
        show(found, claims)
        for name, value in (('page', folder / 'paper.html'), ('data', folder / 'paper.json'),
                            ('pictures', folder / '*.svg')):
            print(f'{name:>8}: {value}')
        print(f'    took: {time.perf_counter() - began:.1f} s, {options.seeds} seeds')
    if options.json:
        write_json(options.json, data)


@contextmanager
def _each(options):
    """Give what does the work of each seed: workers of Dask where they are asked for."""
    if not options.workers and not options.scheduler:
        yield in_turn
        return
    with cluster(options.scheduler, options.workers) as client:
        yield partial(values, client)


def show(reproduction, claims):
    """Print the errors of all methods and the verdicts."""
    screen = console()
    screen.print(errors_table(reproduction))
    screen.print(conclusions_table(claims))
