# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident info`: what is in a flight record, and what is wrong with it."""

import argparse
from collections.abc import Sequence

from rich import box
from rich.table import Table

from quad_ident_ros.cli.options import (
    add_selection,
    AUTO,
    read_flights,
    selection_of,
    thrust_by_log,
    vehicle_from,
)
from quad_ident_ros.data.begin_mapping import begin_mapping
from quad_ident_ros.data.load import contents_of
from quad_ident_ros.data.mapping import load_mapping
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.selection import refuse_spoilt, segment_of, selected, Selection
from quad_ident_ros.data.summary import contents, segments, summarise, unread
from quad_ident_ros.diagnose.intake import lacking
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.screen import console, progress_bar

FAULTY = 3
"""Exit code where there is a finding of severity error."""

STYLE = {'error': 'bold red', 'warning': 'yellow', 'info': 'default'}


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'info', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Say what is in a file: its streams, their rates and spans, and what they '
                    'could be read for; and of\nthe flight in it: columns, rates, gaps, ranges, '
                    'how much each axis is moved, the offset between\nthe clocks of its streams, '
                    'and what is wrong with it and how to correct it: units, frames, '
                    'stale\nsamples, saturation, order and spin of the rotors.',
        epilog='  quad_ident info flight.csv.gz --vehicle quad.yaml\n'
               '  quad_ident info log_12.ulg --mapping px4.yaml --vehicle quad.yaml --json -\n\n'
               '  quad_ident info others_bag --write-mapping map.yaml\n'
               '  quad_ident info log_12.ulg --segment 2 --from 35 --to 95\n\n'
               'Without --vehicle, saturation and rotors are not checked. docs/records.md '
               'explains the findings.\n\n'
               'exit code: 0; 2 for a file that cannot be read; 3 where a finding is an error, as '
               'where a file\nis not a flight record without a mapping.')
    parser.add_argument('flight', metavar='FILE', help='a flight record, a log, a bag or a table')
    parser.add_argument('--vehicle', help='vehicle name or file; auto: the file beside a PX4 log')
    parser.add_argument('--mapping', metavar='FILE', help='which topics and outputs of other '
                        "people's records mean what (YAML)")
    parser.add_argument('--write-mapping', metavar='FILE.yaml', help='write a mapping file to '
                        'begin with')
    parser.add_argument('--json', metavar='FILE', help='write it as data; - prints it')
    add_selection(parser)
    parser.set_defaults(run=run)


def run(options):
    """Read a file, show what is in it, and return the exit code."""
    vehicle, without = _vehicle(options)
    by_log = vehicle is not None and thrust_by_log(options.vehicle, options.flight)
    selection = selection_of(options)
    if options.mapping:
        load_mapping(options.mapping)   # what is wrong with it is no fault of the flight
    with progress_bar() as bar:
        bar.add_task(f'reading {options.flight}', total=None)
        title, streams = contents_of(options.flight)
        if options.write_mapping:
            begin_mapping(options.write_mapping, options.flight, streams)
        try:
            records = read_flights(options.flight, options.mapping, vehicle, selection, by_log)
        except InputError as error:
            records, found = [], [unread(options.flight, error)]
        else:
            found = _summaries(options.flight, records, selection, vehicle)
            found = [{**one, 'findings': [*without, *one['findings']]} for one in found]
    inside = {**contents(options.flight, title, streams), 'segments': segments(records)}
    if options.json != '-':
        show_streams(inside)
        if len(records) > 1:
            show_segments(inside)
        for summary in found:
            show(summary)
        if options.write_mapping:
            console().print(f'written: {options.write_mapping}', markup=False, highlight=False)
    if options.json:
        found = [{**summary, **inside} for summary in found]
        write_json(options.json, found[0] if len(found) == 1 else found)
    errors = any(finding['severity'] == 'error' for summary in found
                 for finding in summary['findings'])
    return FAULTY if errors else 0


def _summaries(path: str, records: Sequence[FlightRecord], selection: Selection,
               vehicle: Vehicle | None) -> list[dict]:
    """Return what is in the part of a file that is asked for, or what is wrong with it."""
    chosen = segment_of(path, records, selection)
    try:
        refuse_spoilt(chosen, selection)
    except InputError as error:
        return [unread(path, error)]
    return [summarise(record, vehicle, lacking(record, vehicle) if vehicle else ())
            for record in selected(path, records, selection)]


def _vehicle(options: argparse.Namespace) -> tuple[Vehicle | None, list[dict]]:
    """Return the Vehicle, and findings: why it is None where a log does not fill its file."""
    if not options.vehicle:
        return None, []
    try:
        return vehicle_from(options.vehicle, options.flight, options.mapping), []
    except InputError as error:
        if options.vehicle != AUTO:
            raise
        return None, [{'code': 'vehicle', 'severity': 'warning', 'where': '--vehicle auto',
                       'message': str(error), 'remedy': ''}]


def show_streams(inside: dict) -> None:
    """Print the streams of a file."""
    screen = console()
    count = len(inside['streams'])
    screen.print(f'{inside["file"]}: {inside["kind"]}, {count} stream{"s" * (count != 1)}',
                 markup=False, highlight=False, soft_wrap=True)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    for name in ('stream', 'type'):
        table.add_column(name, overflow='fold')
    for name in ('samples', 'Hz', 'from, s', 'to, s'):
        table.add_column(name, justify='right', no_wrap=True)
    table.add_column('could be', overflow='fold')
    for stream in inside['streams']:
        table.add_row(stream['name'], stream['type'], str(stream['samples']),
                      f'{stream["rate_hz"]:.4g}', f'{stream["start_s"]:.2f}',
                      f'{stream["start_s"] + stream["duration_s"]:.2f}',
                      ', '.join(stream['roles']))
    screen.print(table)
    # A table is recognised by its columns.
    for stream in inside['streams'] if len(inside['streams']) == 1 else ():
        screen.print(f'fields: {", ".join(stream["fields"])}', markup=False, highlight=False,
                     soft_wrap=True)


def show_segments(inside: dict) -> None:
    """Print the records that a file holds."""
    screen = console()
    screen.print(f'{len(inside["segments"])} segments; --segment N takes one of them',
                 markup=False, highlight=False, soft_wrap=True)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    for name in ('N', 'from t, s', 'to t, s', 'duration, s'):
        table.add_column(name, justify='right', no_wrap=True)
    table.add_column('what', overflow='fold')
    for one in inside['segments']:
        end = one['start_s'] + one['duration_s']
        table.add_row(str(one['number']), f'{one["start_s"]:.2f}', f'{end:.2f}',
                      f'{one["duration_s"]:.2f}', one['name'] or '')
    screen.print(table)


def show(summary):
    """Print what is in a flight."""
    screen = console()

    def say(text, style=None):
        screen.print(text, style=style, markup=False, highlight=False, soft_wrap=True)

    if 'time' in summary:
        _show_record(screen, say, summary)
    for finding in summary['findings']:
        remedy = f'; {finding["remedy"]}' if finding['remedy'] else ''
        say(f'{finding["severity"]}: {finding["where"]}: {finding["message"]}{remedy} '
            f'[{finding["code"]}]', STYLE[finding['severity']])
    if not summary['findings']:
        say('no findings')


def _show_record(screen, say, summary):
    """Print the columns of a flight and how they fit together."""
    time = summary['time']
    say(f'{summary["source"] or summary["name"]}: {time["samples"]} samples, '
        f'{time["duration_s"]:.3f} s from t = {time["start_s"]:.3f} s, '
        f'{time["rate_hz"]:.1f} Hz, {time["gaps"]} gap{"" if time["gaps"] == 1 else "s"}')
    if summary['modes']:
        say('flight modes: ' + ', '.join(f'{one["mode"]} {one["from_s"]:.2f} to {one["to_s"]:.2f} '
                                         's' for one in summary['modes']))
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


def _number(value):
    return '' if value is None else f'{value:.5g}'
