# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident fleet`: diagnose the flights of many vehicles, and keep all results."""

import argparse
from dataclasses import replace
import re
import sys

from quad_ident_ros.diagnose.priors import load_priors, write_priors
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError

DEFAULT_OUT = 'fleet'
FAULTY = 3
"""
Exit code where groups failed, which the next run tries again, or gave way to another run; and
where all groups were refused, in this run or before, so that there is no diagnosis at all.
"""
_BYTES = re.compile(r'(\d+(?:\.\d+)?) ?([kMGT]?)(i?)B?')


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'fleet', help=summary, formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Diagnose flights of many vehicles. Those of one vehicle, configuration and '
                    'day are diagnosed together; all\nresults are kept in a folder of Parquet '
                    'files, which pandas, polars and DuckDB read. Finished work is\nnot '
                    'repeated: start the same command again after new flights, or where it was '
                    'interrupted.',
        epilog='a folder: the first folder in it that is not a day names the vehicle, a second '
               'one the configuration;\n  without one the log does. The nominal vehicle is '
               'vehicle.yaml in a folder of its flights, or --vehicle.\n'
               'a manifest: a CSV table with the columns path, vehicle, configuration, date, '
               'group, vehicle_file, of which only\n  path is needed; each other column is a '
               'covariate (temperature_c, battery_cycles, ...).\n\n'
               '  quad_ident fleet flights/ --vehicle quad.yaml\n'
               '  quad_ident fleet manifest.csv --out all_of_2026 --json -\n'
               '  quad_ident fleet flights/ --vehicle quad.yaml --scheduler tcp://10.0.0.5:8786\n'
               '  duckdb -c "select vehicle, date, verdict from \'fleet/groups/*.parquet\'"\n\n'
               'docs/fleet.md explains the folder, and how to use SSH, Slurm and Kubernetes.')
    parser.add_argument('flights', nargs='+', metavar='FLIGHT|FOLDER|MANIFEST.csv',
                        help='flights, folders of flights, or manifests')
    parser.add_argument('--out', '-o', metavar='FOLDER', default=DEFAULT_OUT,
                        help='the data set (default: %(default)s)')
    parser.add_argument('--vehicle', help='vehicle name or file: the nominal one of flights '
                        'that have none of their own')
    parser.add_argument('--mapping', metavar='FILE', help='which topics and outputs of other '
                        "people's records mean what (YAML)")
    parser.add_argument('--json', metavar='FILE', help='write a line of JSON for each group as '
                        'it is done, and one for the whole run; - prints them')
    parser.add_argument('--report', metavar='FILE.html',
                        help='write a page for a browser: what to look at first, vehicles by '
                             'effects, every parameter over time, the gap')
    parser.add_argument('--out-priors', metavar='FILE.yaml',
                        help='write how often each effect is present, how large and how exact, '
                             'for --priors of `diagnose` and `fleet`')
    parser.add_argument('--priors', metavar='FILE', help='diagnose with what another fleet has '
                        'taught; verdicts that use priors teach none')
    group = parser.add_argument_group('where the work is done')
    group.add_argument('--scheduler', metavar='tcp://HOST:PORT', help='address of a running '
                       'Dask cluster (default: processes on this machine)')
    group.add_argument('--workers', type=_count, metavar='N', help='processes on this machine '
                       '(default: one for each core)')
    group.add_argument('--memory', type=_bytes, metavar='SIZE', help='memory of each process, for '
                       'example 2GB (default: an equal share of 80 %% of the memory here)')
    group.add_argument('--time-limit', type=_seconds, metavar='SECONDS', help='time after which '
                       'a group is given up (default: 1800)')
    parser.set_defaults(run=run)


def run(options):
    """Diagnose the flights and say what came of it; 3 where a group failed or all are refused."""
    try:
        from quad_ident_ros.fleet.insight import insight
        from quad_ident_ros.fleet.plan import planned
        from quad_ident_ros.fleet.priors import effects_without_priors, learned
        from quad_ident_ros.fleet.run import COMPARING, Progress, run_fleet, TIME_LIMIT
    except ModuleNotFoundError as error:
        if (error.name or '').partition('.')[0] not in ('pyarrow', 'distributed', 'dask'):
            raise
        raise InputError(f"{error.name} is not installed: pip install 'quad_ident_ros[fleet]'"
                         ) from None
    from quad_ident_ros.cluster import cluster
    from quad_ident_ros.report import fleet_page
    from quad_ident_ros.report.fleet import show_insight
    from quad_ident_ros.report.fleet_run import Reporter
    if options.scheduler and (options.workers or options.memory):
        raise InputError('--workers, --memory: they are for processes on this machine; with '
                         '--scheduler its own workers are used')
    if options.priors and options.out_priors:
        raise InputError('--out-priors: verdicts that use --priors would repeat these; '
                         'run without --priors, into another --out')
    rules = RULES if options.priors is None else replace(RULES,
                                                         priors=load_priors(options.priors))
    plan = planned(options.flights, vehicle=options.vehicle, mapping=options.mapping, rules=rules)
    with cluster(options.scheduler, options.workers, options.memory) as client, \
            Reporter(client, options.out, options.json) as reporter:
        summary = run_fleet(client, plan, options.out, tell=reporter.tell,
                            time_limit=options.time_limit or TIME_LIMIT)
        found = insight(options.out, lambda done, total: reporter.tell(
            Progress(COMPARING, total, done)))
        reporter.tell_insight(found)
        reporter.end(summary)
    if options.json != '-':
        show_insight(found, sys.stdout)
    if options.report:
        fleet_page.write(options.report, found)
    if options.out_priors:
        effects = effects_without_priors(options.out)
        write_priors(options.out_priors, learned(effects, found.histories),
                     len(effects['vehicle'].unique()))
    groups = summary.groups
    faulty = (groups['failed'] or groups['timeout'] or summary.untracked or summary.gave_way
              or summary.nothing_diagnosed)
    return FAULTY if faulty else 0


def _count(text):
    value = int(text) if text.isdecimal() else 0
    if value < 1:
        raise argparse.ArgumentTypeError(f'expected a whole number from 1 on, got {text!r}')
    return value


def _bytes(text):
    match = _BYTES.fullmatch(text)
    value = match and float(match[1]) * (1024 if match[3] else 1000) ** ' kMGT'.index(
        match[2] or ' ')
    if not value or value < 1e8:
        raise argparse.ArgumentTypeError(f'expected a size from 100MB on, such as 2GB, got '
                                         f'{text!r}')
    return int(value)


def _seconds(text):
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float('inf'):
        raise argparse.ArgumentTypeError(f'expected seconds above 0, got {text!r}')
    return value
