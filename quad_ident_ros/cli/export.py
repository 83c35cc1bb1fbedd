# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident export`: a vehicle with its effects into a simulator's own file."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from quad_ident_ros import resources
from quad_ident_ros.cli.export_draws import run_draws
from quad_ident_ros.cli.options import flights_with_bar
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.carried import Carried, carried
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.export import CODE, FILE, show, show_cost
from quad_ident_ros.report.screen import progress_bar
from quad_ident_ros.vehicle_files.export import Export, export, mean_left
from quad_ident_ros.vehicle_files.kinds import KINDS
from quad_ident_ros.vehicle_files.load import source_of
from quad_ident_ros.vehicle_files.mujoco_code import SAYS as CODE_SAYS
from quad_ident_ros.vehicle_files.source import mark_of, Source
from quad_ident_ros.vehicle_files.targets import TARGETS
from quad_ident_ros.vehicle_files.written import read_back, with_code
from quad_ident_ros.whole_file import write_whole


def add(commands: Any, summary: str) -> None:
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'export', help=summary, formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Write a vehicle file, as `diagnose --out-vehicle` writes it, as a file of a '
                    'simulator: a new\none, or with --base yours, in which only numbers change '
                    'and everything else stays byte for byte.\nLists what the effects change, '
                    'and which of them the file carries exactly, by the nearest\nequivalent, or '
                    'not at all. With --randomise, draws N vehicles as far apart as the flights '
                    'leave\nthe vehicle open, for domain randomisation.',
        epilog='  quad_ident export real.yaml --to rotorpy -o real_params.py\n'
               '  quad_ident diagnose *.csv --vehicle model.sdf --out-vehicle real.yaml\n'
               '  quad_ident export real.yaml --to gazebo --base model.sdf -o like_real.sdf\n'
               '  quad_ident export real.yaml --randomise 50 -o vehicles\n'
               '  quad_ident export real.yaml --randomise 50 --to mujoco --base q.xml -o models\n'
               '  quad_ident export real.yaml --randomise 4096 --seed 1 -o vehicles.npz\n\n'
               'docs/vehicles.md says what each target carries.')
    parser.add_argument('vehicle', metavar='V.yaml', help='the vehicle file')
    parser.add_argument('--to', choices=list(TARGETS),
                        help='the simulator (default with --randomise: our own vehicle files)')
    parser.add_argument('--base', metavar='FILE',
                        help='your file that the numbers go into; FILE:NAME for one of several '
                             'vehicles in it (default: a new file)')
    parser.add_argument('--flight', nargs='+', metavar='FLIGHT',
                        help='flights, preferably those that the diagnosis held out, on which the '
                             'gap that the file closes is measured, and over which a sag of the '
                             'battery becomes a mean factor')
    parser.add_argument('--randomise', type=int, metavar='N',
                        help='draw N vehicles from the normal distribution that the vehicle file '
                             'states: its covariance, and the std of constants apart from it; '
                             'what cannot be a vehicle is drawn again')
    parser.add_argument('--seed', type=int, metavar='N', help='of the draws (default: 0)')
    parser.add_argument('-o', '--output', required=True, metavar='OUT',
                        help='the file to write; with --randomise a folder for N files, or '
                             'FILE.npz for one array with names and units')
    parser.add_argument('--json', metavar='FILE', help='write what changes as data; - prints it')
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Write the file, or those of drawn vehicles, and show what changes."""
    if options.randomise is not None:
        run_draws(options, load_vehicle(_file_of_ours(options.vehicle)), _base(options))
        return
    if options.to is None:
        raise InputError(f'--to is missing: name the simulator ({", ".join(TARGETS)})')
    if options.seed is not None:
        raise InputError('--seed: only draws have a seed; give --randomise N too, or leave it out')
    target = TARGETS[options.to]
    if Path(options.output).suffix not in target.endings:
        endings = ', '.join(filter(None, target.endings))
        bare = ' or has no ending' if '' in target.endings else ''
        raise InputError(f'{options.output}: the name of a file for {options.to} ends in '
                         f'{endings}{bare}; give such a name')
    vehicle = load_vehicle(_file_of_ours(options.vehicle))
    source = _base(options)
    with progress_bar() as bar:
        task = bar.add_task('', total=None)
        records = flights_with_bar(options.flight or [], vehicle, bar, task)
        bar.update(task, description=f'changing {options.base or "a new file"}', total=None)
        found = export(vehicle, options.to, source,
                       mean_left(vehicle, records) if records else None,
                       Path(options.output).name)
        cost = None
        if records:
            bar.update(task, description='measuring the gap', total=1.0, completed=0.0)
            cost = cost_of(found, vehicle, records,
                           lambda share: bar.update(task, completed=share))
    if found.code is not None:
        _refuse_others(_beside(options.output))
    elif _is_code_of_ours(Path(options.output)):
        raise InputError(f'{options.output}: this would write over the code beside a file that '
                         'was exported before; give another name')
    _write(options.output, mark_of(source) + found.text)
    if found.code is not None:
        _write(_beside(options.output), found.code.text)
    if options.json != '-':
        show(found, options.output, source is None, _beside(options.output))
        if cost is not None:
            show_cost(cost)
    if options.json:
        write_json(options.json, as_data(found, cost, options))


def cost_of(found: Export, vehicle: Vehicle, records: Sequence[FlightRecord],
            on_progress: Callable[[float], object] = lambda share: None) -> Carried:
    """
    Return what of the gap on flights the written file closes; raises InputError.

    on_progress is called with the share done.
    """
    written = replace(found.base, text=found.text)
    before, after = (read_back(found, source, vehicle) for source in (found.base, written))
    parts = {FILE: after}
    if found.code is not None:
        parts[CODE] = with_code(found, after, vehicle)
    return carried(records, before, vehicle, parts, on_progress=on_progress)


def _base(options: argparse.Namespace) -> Source | None:
    """Return the file of --base, or None; InputError if it is missing or would be lost."""
    if options.base is None:
        return None
    source = source_of(options.base)
    if source is None:
        kinds = {kind.name: kind.title for kind in KINDS}
        takes = (kinds[TARGETS[options.to].kind] if options.to else 'a file of a simulator')
        what = ('this is a vehicle file' if Path(options.base).is_file() else
                'there is no such file')
        raise InputError(f'--base {options.base}: {what}; give {takes}, or leave --base '
                         'out for a new file')
    if Path(options.output).resolve() == Path(source.path).resolve():
        raise InputError(f'{options.output}: this would write over the base file; give another '
                         'name')
    return source


def _beside(path: str) -> Path:
    """Return the path of the code beside a file."""
    return Path(path).with_suffix('.py')


def _refuse_others(path: Path) -> None:
    """Raise InputError where code would overwrite a file that we did not write."""
    if path.exists() and not _is_code_of_ours(path):
        raise InputError(f'{path}: the code beside the file would be written over this; name '
                         'another --output')


def _is_code_of_ours(path: Path) -> bool:
    """Return whether a file is code that was written beside another one."""
    return path.is_file() and CODE_SAYS in path.read_text('utf-8', 'replace')[:200]


def _write(path: str | Path, text: str) -> None:
    try:
        write_whole(path, text)
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None


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


def _file_of_ours(path: str) -> Path:
    """Return the vehicle file of a path or of a shipped name; InputError for another kind."""
    if source_of(path) is not None:
        raise InputError(f'{path}: expected a vehicle file (.yaml), as `quad_ident vehicle {path} '
                         '-o v.yaml` writes it')
    return resources.find('vehicles', path)
