# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident info`: what is in a flight record, and what is wrong with it."""

import argparse

from rich import box
from rich.table import Table

from quad_ident_ros.cli.identify import progress_bar
from quad_ident_ros.cli.options import flights_from
from quad_ident_ros.data.summary import summarise
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.table import console

STYLE = {'error': 'bold red', 'warning': 'yellow', 'info': 'default'}


def add(commands):
    """Add the command to the parser."""
    parser = commands.add_parser(
        'info', help='say what is in a flight record, and what is wrong with it',
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Say what is in a flight: columns, rates, gaps, ranges, how much each axis '
                    'is moved, the offset\nbetween the clocks of its streams, and what is wrong '
                    'with it and how to mend that: units, frames,\nstale samples, saturation, '
                    'order and spin of the rotors.',
        epilog='  quad_ident info flight.csv.gz --vehicle quad.yaml\n'
               '  quad_ident info log_12.ulg --mapping px4.yaml --vehicle quad.yaml --json -\n\n'
               'Without --vehicle nothing is said of saturation and rotors. docs/records.md '
               'explains the findings.')
    parser.add_argument('flight', metavar='FLIGHT', help='.csv, .csv.gz, bag (folder, .mcap, '
                        '.db3) or .ulg')
    parser.add_argument('--vehicle', help='vehicle name or file')
    parser.add_argument('--mapping', metavar='FILE', help='which topics and outputs of other '
                        "people's records mean what (YAML)")
    parser.add_argument('--json', metavar='FILE', help='write it as data; - prints it')
    parser.set_defaults(run=run)


def run(options):
    """Read the flights and show what is in them."""
    vehicle = load_vehicle(options.vehicle) if options.vehicle else None
    with progress_bar() as bar:
        bar.add_task(f'reading {options.flight}', total=None)
        found = [summarise(record, vehicle) for record in
                 flights_from(options.flight, options.mapping, options.vehicle)]
    if options.json != '-':
        for summary in found:
            show(summary)
    if options.json:
        write_json(options.json, found[0] if len(found) == 1 else found)


def show(summary):
    """Print what is in a flight."""
    screen = console()

    def say(text, style=None):
        screen.print(text, style=style, markup=False, highlight=False, soft_wrap=True)

    time = summary['time']
    say(f'{summary["source"] or summary["name"]}: {time["samples"]} samples, '
        f'{time["duration_s"]:.3f} s from t = {time["start_s"]:.3f} s, '
        f'{time["rate_hz"]:.1f} Hz, {time["gaps"]} gaps')
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    for name in ('column', 'unit'):
        table.add_column(name, no_wrap=True)
    for name in ('changes, Hz', 'minimum', 'mean', 'maximum', 'std', 'missing'):
        table.add_column(name, justify='right', no_wrap=True)
    for name, column in summary['columns'].items():
        table.add_row(name, column['unit'] or '?', f'{column["changes_hz"]:.1f}',
                      *(_number(column[key]) for key in ('minimum', 'mean', 'maximum', 'std')),
                      str(column['missing'] or ''))
    screen.print(table)
    if summary['excitation']:
        say('excitation: ' + ', '.join(f'{name} {entry["value"]:.3g} {entry["unit"]}' for
                                       name, entry in summary['excitation'].items()))
    for name, clock in summary['clock'].items():
        if clock:
            drift = ('' if clock['drift_s_per_s'] is None else
                     f', drift {1e3 * clock["drift_s_per_s"]:+.3f} ± '
                     f'{1e3 * clock["drift_std_s_per_s"]:.3f} ms/s')
            say(f'{name.replace("_", " ")}: {1e3 * clock["offset_s"]:+.2f} ± '
                f'{1e3 * clock["std_s"]:.2f} ms{drift}')
    for finding in summary['findings']:
        say(f'{finding["severity"]}: {finding["where"]}: {finding["message"]}; '
            f'{finding["remedy"]} [{finding["code"]}]', STYLE[finding['severity']])
    if not summary['findings']:
        say('no findings')


def _number(value):
    return '' if value is None else f'{value:.5g}'
