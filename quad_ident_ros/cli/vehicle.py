# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident vehicle`: what a simulator's file says of the vehicle that it flies."""

import argparse
from dataclasses import asdict
from typing import Any

import yaml

from quad_ident_ros import schema
from quad_ident_ros.effects.registry import titled
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import (
    hover_fault,
    load_vehicle,
    vehicle_to_mapping,
    write_vehicle,
)
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.screen import console, progress_bar, say, table_of
from quad_ident_ros.vehicle_files.kinds import KINDS
from quad_ident_ros.vehicle_files.load import read_vehicle, source_of
from quad_ident_ros.vehicle_files.reading import needed_vehicle, Reading, SETTABLE

OURS = 'a vehicle file'


def add(commands: Any, summary: str) -> None:
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'vehicle', help=summary, formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Show what a file says about a vehicle: each number with its unit and place '
                    'in the file, what\nis missing, and what was assumed. Lags, drags and the '
                    'like become effects of the nominal\nvehicle, so that the gap is that of this '
                    'simulator.',
        epilog='kinds, recognised by their content:\n'
        + ''.join(f'  {kind.title}\n' for kind in KINDS)
        + '\nwhat --set may supply if the file does not have it:\n'
        + ''.join(f'  {key}: {unit}\n' for key, unit in SETTABLE.items())
        + '\n  quad_ident vehicle models/x500/model.sdf\n'
          '  quad_ident vehicle x2.xml -o x2.yaml\n'
          '  quad_ident vehicle params.toml:cf2x_L250 -o crazyflie.yaml\n'
          '  quad_ident vehicle drone.urdf --set thrust_coefficient=8.5e-6 \\\n'
          '      --set torque_coefficient=1.4e-7 --set spins=[1,-1,1,-1] -o drone.yaml\n\n'
          'docs/vehicles.md says what is read of each kind. All commands take such files as '
          '--vehicle.')
    parser.add_argument('vehicle', metavar='FILE', help='the file; FILE:NAME for one of several '
                        'vehicles in it')
    parser.add_argument('-o', '--out-vehicle', metavar='FILE.yaml',
                        help='write the vehicle file')
    parser.add_argument('--set', action='append', default=[], metavar='KEY=VALUE',
                        help='supply what the file does not have (YAML); may be repeated')
    parser.add_argument('--json', metavar='FILE', help='write it as data; - prints it')
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Read the file, show what is in it, and write the vehicle file asked for."""
    supplied = dict(_entry(entry) for entry in options.set)
    with progress_bar() as bar:
        bar.add_task(f'reading {options.vehicle}', total=None)
        reading = _read(options.vehicle, supplied)
    if options.json != '-':
        show(reading)
    if options.out_vehicle:
        write_vehicle(options.out_vehicle, needed_vehicle(reading))
    if options.json:
        write_json(options.json, as_data(reading))


def _read(path: str, supplied: dict[str, Any]) -> Reading:
    """Return what a file says, with what --set supplies; raises InputError."""
    source = source_of(path)
    if source is not None:
        return read_vehicle(source, supplied)
    reading = Reading(path, OURS, load_vehicle(path), (), {}, ())
    if supplied:
        raise InputError('--set: supplies what the file of a simulator does not have; change a '
                         'vehicle file itself')
    return reading


def as_data(reading: Reading) -> dict[str, Any]:
    """Return a Reading as data; `vehicle` is what a vehicle file has, or None."""
    vehicle = reading.vehicle
    return {'schema': 'quad_ident/vehicle/1', 'file': reading.path, 'kind': reading.kind,
            'vehicle': None if vehicle is None else vehicle_to_mapping(vehicle),
            'read': [asdict(entry) for entry in reading.read],
            'missing': reading.missing, 'assumed': list(reading.assumed),
            'warnings': _warnings(reading)}


def _warnings(reading: Reading) -> list[str]:
    """Return what a flight of the vehicle would be refused for."""
    fault = None if reading.vehicle is None else hover_fault(reading.vehicle)
    return [] if fault is None else ['; '.join(fault)]


def show(reading: Reading) -> None:
    """Print what was read and how it was used, what is missing and what was assumed."""
    screen = console()
    say(screen, f'{reading.path}: {reading.kind}')
    if reading.read:
        screen.print(table_of(('read', 'value', 'unit', 'place'), [
            (entry.key, _shown(entry.value), entry.unit, entry.place) for entry in reading.read]))
    if reading.vehicle is not None:
        _show_vehicle(reading, screen)
    for key, text in reading.missing.items():
        say(screen, f'missing: {key}: {text}')
    for text in reading.assumed:
        say(screen, f'assumed: {text}')


def _show_vehicle(reading: Reading, screen: Any) -> None:
    vehicle = reading.vehicle
    assert vehicle is not None
    most = ('' if vehicle.speed_max == float('inf') else
            f', {100 * vehicle.hover_speed / vehicle.speed_max:.3g} % of its maximum')
    say(screen, f'vehicle: {vehicle.name}, {vehicle.mass:.6g} kg, {len(vehicle.rotors)} rotors, '
                f'hovers at {vehicle.hover_speed:.4g} rad/s{most}')
    for text in _warnings(reading):
        say(screen, f'warning: {text}')
    for name, values in vehicle.effects.items():
        numbers = ', '.join(f'{key} = {value:.6g}' for key, value in values.items())
        say(screen, f'effect: {titled(name)} {numbers}')
    if not vehicle.effects:
        say(screen, 'effects: none')
    if vehicle.residual is not None:
        say(screen, f'residual: force and moment by {len(vehicle.residual.inputs)} inputs and '
                    f'{len(vehicle.residual.waves)} waves over them')


def _entry(text: str) -> tuple[str, Any]:
    """Return (key, value) of KEY=VALUE; raises InputError."""
    key, sign, value = text.partition('=')
    try:
        read = yaml.safe_load(value) if sign else None
    except (yaml.YAMLError, ValueError, RecursionError):
        read = None
    if read is None:
        raise InputError(f'--set {schema.shown(text)}: expected KEY=VALUE, for example '
                         'torque_coefficient=1e-7')
    return key.strip(), read


def _shown(value: Any) -> str:
    """Return a value in six digits."""
    if isinstance(value, dict):
        return ', '.join(f'{key} {_shown(each)}' for key, each in value.items())
    if isinstance(value, list | tuple):
        inner = [_shown(each) for each in value]
        return '\n'.join(inner) if value and isinstance(value[0], dict) else ', '.join(inner)
    return f'{value:.6g}' if isinstance(value, float) else str(value)
