# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident export`: a vehicle with its effects into a simulator's own file."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from rich import box
from rich.table import Table

from quad_ident_ros import resources
from quad_ident_ros.cli.options import flights_from
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.carried import Carried, carried
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.table import console
from quad_ident_ros.vehicle_files.export import Export, export, mean_left
from quad_ident_ros.vehicle_files.load import source_of
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.targets import TARGETS
from quad_ident_ros.vehicle_files.written import read_back, with_code
from quad_ident_ros.whole_file import write_whole

BOM = b'\xef\xbb\xbf'
FILE, CODE = 'file', 'file_and_code'
ROWS = {'nominal': 'the base', 'vehicle': 'the vehicle file', FILE: 'the written file',
        CODE: 'the written file with its code'}


def add(commands: Any, said: str) -> None:
    """Add the command to the parser; said: what it does."""
    parser = commands.add_parser(
        'export', help=said, formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Write a vehicle file, as `diagnose --out-vehicle` writes it, as the own file '
                    'of a simulator: a\nnew one, or with --base yours, in which just the numbers '
                    'change and all else stays byte for\nbyte. What the effects change is '
                    'listed, and which of them the file carries as they are, by the\nnearest, or '
                    'not at all.',
        epilog='  quad_ident export real.yaml --to rotorpy -o real_params.py\n'
               '  quad_ident diagnose *.csv --vehicle model.sdf --out-vehicle real.yaml\n'
               '  quad_ident export real.yaml --to gazebo --base model.sdf -o like_real.sdf\n\n'
               'docs/vehicles.md says what each target carries.')
    parser.add_argument('vehicle', metavar='V.yaml', help='the vehicle file')
    parser.add_argument('--to', required=True, choices=list(TARGETS), help='the simulator')
    parser.add_argument('--base', metavar='FILE',
                        help='your file that the numbers go into; FILE:NAME for one of several '
                             'vehicles in it (default: a new file)')
    parser.add_argument('--flight', nargs='+', metavar='FLIGHT',
                        help='flights, best those that the diagnosis held out, on which the gap '
                             'is told that the file closes, and over which a sag of the battery '
                             'becomes a mean factor')
    parser.add_argument('-o', '--output', required=True, metavar='OUT', help='the file to write')
    parser.add_argument('--json', metavar='FILE', help='write what changes as data; - prints it')
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Write the file and show what changes in it."""
    target = TARGETS[options.to]
    if Path(options.output).suffix not in target.endings:
        raise InputError(f'{options.output}: a file for {options.to} ends in '
                         f'{", ".join(target.endings)}; name one')
    vehicle = load_vehicle(_file_of_ours(options.vehicle))
    source = _base(options)
    records = [record for path in options.flight or [] for record in
               flights_from(path, None, vehicle)]
    found = export(vehicle, options.to, source, mean_left(vehicle, records) if records else None,
                   Path(options.output).name)
    cost = cost_of(found, vehicle, records, options.output) if records else None
    _write(options.output, _mark(source) + found.text)
    if found.code is not None:
        _write(_beside(options.output), found.code.text)
    if options.json != '-':
        show(found, options.output, source is None)
        if cost is not None:
            show_cost(cost)
    if options.json:
        write_json(options.json, as_data(found, cost, options))


def cost_of(found: Export, vehicle: Vehicle, records: Sequence[FlightRecord], path: str
            ) -> Carried:
    """Return what of the gap on flights the written file closes; raises InputError."""
    written = replace(found.base, path=path, text=found.text)
    before, after = (read_back(found, source, vehicle) for source in (found.base, written))
    parts = {FILE: after}
    if found.code is not None:
        parts[CODE] = with_code(found, after, vehicle)
    return carried(records, before, vehicle, parts)


def _base(options: argparse.Namespace) -> Source | None:
    """Return the file of --base, or None; InputError where it is none, or would be lost."""
    if options.base is None:
        return None
    source = source_of(options.base)
    if source is None:
        raise InputError(f'{options.base}: expected a file of a simulator as --base')
    if Path(options.output).resolve() == Path(source.path).resolve():
        raise InputError(f'{options.output}: this would write over the base file; give another '
                         'name')
    return source


def _beside(path: str) -> Path:
    """Return the path of the code beside a file."""
    return Path(path).with_suffix('.py')


def _write(path: str | Path, text: str) -> None:
    try:
        write_whole(path, text)
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None


def _mark(source: Source | None) -> str:
    """Return the mark with which some editors begin a file, where a base file has it."""
    if source is None:
        return ''
    with open(source.path, 'rb') as file:
        return '\ufeff' if file.read(len(BOM)) == BOM else ''


def as_data(found: Export, cost: Carried | None, options: argparse.Namespace) -> dict[str, Any]:
    """Return an Export as data, and its cost, None where no flight was named."""
    return {'schema': 'quad_ident/export/1', 'vehicle': options.vehicle, 'to': options.to,
            'base': options.base, 'output': options.output,
            'changes': [asdict(change) for change in found.changes],
            'remarks': list(found.remarks),
            **{key: [asdict(fate) for fate in getattr(found.fates, key)]
               for key in ('carried', 'by_code', 'nearest', 'not_carried')},
            'code': None if found.code is None else str(_beside(options.output)),
            'gap': None if cost is None else asdict(cost)}


def show(found: Export, path: str, new: bool) -> None:
    """Print what changes, and what becomes of each effect; new: whether the file is."""
    screen = console()

    def say(text: str) -> None:
        screen.print(text, markup=False, highlight=False, soft_wrap=True)

    if found.changes:
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
        for title in ('place', 'old', 'new', 'std', 'unit', 'from'):
            table.add_column(title, overflow='fold',
                             justify='right' if title in ('old', 'new', 'std') else 'left')
        for change in found.changes:
            table.add_row(change.place, _shown(change.old), _shown(change.new),
                          _shown(change.std), change.unit, change.source)
        screen.print(table)
    for text in found.remarks:
        say(f'note: {text}')
    for key, said in (('carried', 'carried'), ('by_code', 'carried'),
                      ('nearest', 'by the nearest'), ('not_carried', 'not carried')):
        for fate in getattr(found.fates, key):
            form = f' ({fate.form})' if fate.form else ''
            say(f'{said}: {fate.name}{form}: {fate.reason}')
    count = len(found.changes)
    say(f'{path}: {"new, " if new else ""}{count or "no"} number{"s" * (count != 1)} changed'
        + (' by the effects' if new else ''))
    if found.code is not None:
        say(f'{_beside(path)}: code for what the file has no number for; its first lines say how '
            'to use it')


def show_cost(cost: Carried) -> None:
    """Print the gaps on the flights, and what of them the file closes."""
    screen = console()
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    table.add_column(f'gap {cost.horizon:g} s ahead')
    for group, unit in cost.units.items():
        table.add_column(f'{group}, {unit}', justify='right')
    for name, values in cost.gaps.items():
        table.add_row(ROWS[name], *(f'{values[group]:.3g}' for group in cost.units))
    screen.print(table)
    for name, share in cost.shares.items():
        screen.print(f'{ROWS[name]} closes {100 * share:.3g} % of what the vehicle file closes of '
                     'the velocity gap', markup=False, highlight=False, soft_wrap=True)
    if not cost.shares:
        screen.print('the vehicle file closes nothing of the velocity gap on these flights',
                     markup=False, highlight=False, soft_wrap=True)


def _file_of_ours(path: str) -> Path:
    """Return the vehicle file of a path or of a shipped name; InputError for another kind."""
    if source_of(path) is not None:
        raise InputError(f'{path}: expected a vehicle file (.yaml), as `quad_ident vehicle {path} '
                         '-o v.yaml` writes it')
    return resources.find('vehicles', path)


def _shown(value: float | None) -> str:
    return '' if value is None else f'{value:.6g}'
