# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident convert`: flight records from one format into another."""

import argparse
from pathlib import Path

from quad_ident_ros.cli.options import add_selection, flights_from, selection_of, vehicle_from
from quad_ident_ros.cli.outputs import refuse_overwriting
from quad_ident_ros.data.export import save
from quad_ident_ros.data.record import CUT
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.screen import progress_bar


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'convert', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Read a flight of any known kind and write it as CSV or as a bag. '
                    'Nothing is lost: every\ncolumn, known or not, reads back number for number; '
                    'what could not be read is noted.\nA bag with several flights makes several '
                    'files, OUT_1, OUT_2, ...',
        epilog='  quad_ident convert flight.csv.gz flight.mcap\n'
               '  quad_ident convert recording_1/bag flights.csv\n'
               '  quad_ident convert log_12.ulg out.csv --mapping px4.yaml --vehicle quad.yaml\n'
               '  quad_ident convert others_bag flight.csv --mapping topics.yaml\n'
               '  quad_ident convert flight.csv part.csv --from 3.2 --to 18.4\n\n'
               'docs/records.md describes the formats and the mapping file.')
    parser.add_argument('flight', metavar='IN',
                        help='a table (CSV, Parquet), a bag (ROS 1 or 2), or a log of PX4, '
                             'ArduPilot, Crazyflie or Betaflight')
    parser.add_argument('out', metavar='OUT', help='.csv, .csv.gz, .mcap, or without an ending: '
                        'the new folder of a bag')
    parser.add_argument('--mapping', metavar='FILE', help='which topics and outputs of other '
                        "people's records mean what (YAML)")
    parser.add_argument('--vehicle', help='vehicle name or file, for the speeds of its '
                        'rotors; auto: the file beside a PX4 log')
    parser.add_argument('--json', metavar='FILE', help='write what was done as data; - prints it')
    add_selection(parser)
    parser.set_defaults(run=run)


def run(options):
    """Read the flights, write them, and say what was written."""
    out, done, selection = Path(options.out), [], selection_of(options)
    with progress_bar() as bar:
        task = bar.add_task(f'reading {options.flight}', total=None)
        vehicle = options.vehicle and vehicle_from(options.vehicle, options.flight,
                                                   options.mapping)
        flights = flights_from(options.flight, options.mapping, vehicle, selection)
        paths = [out] if len(flights) == 1 else [_numbered(out, number) for number in
                                                 range(1, len(flights) + 1)]
        for path in paths:
            refuse_overwriting(path, [options.flight])
        for path, record in zip(paths, flights, strict=True):
            bar.update(task, description=f'writing {path}', total=1.0, completed=0.0)
            save(path, record, lambda share: bar.update(task, completed=share))
            done.append({'file': str(path), 'samples': len(record),
                         'columns': ['t', *record.columns],
                         'notes': [*record.info.get('notes', ()),
                                   *([CUT] if record.info.get('truncated') else [])]})
    if options.json != '-':
        for entry in done:
            print(f'{entry["file"]}: {entry["samples"]} samples of {", ".join(entry["columns"])}')
            for note in entry['notes']:
                print(f'  note: {note}')
    if options.json:
        write_json(options.json, done)


def _numbered(path, number):
    """Return the path with _number before its ending."""
    stem, dot, ending = path.name.partition('.')
    return path.with_name(f'{stem}_{number}{dot}{ending}')
