# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident simulate`: make flight records without ROS."""

import argparse
import math
from pathlib import Path

from quad_ident_ros import resources
from quad_ident_ros.cli.options import noise_from
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment, NOISE_UNITS
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.screen import progress_bar


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'simulate', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Fly an experiment in simulation, without ROS, and write one CSV per run.',
        epilog='experiments that ship:\n' + ''.join(
            f'  {name}\n' for name in resources.names('experiments'))
        + 'vehicles that ship:\n' + ''.join(
            f'  {name}\n' for name in resources.names('vehicles')))
    parser.add_argument('experiment', help='name of a shipped experiment, or path of a .yaml')
    parser.add_argument('--vehicle', help="vehicle name or file instead of the experiment's")
    parser.add_argument('--noise', action='append', metavar='CHANNEL=STD',
                        help='measurement noise, may be repeated; channels: '
                             + ', '.join(f'{name} ({unit})' for name, unit in NOISE_UNITS.items()))
    parser.add_argument('--seed', type=int, default=0, help='seed of the noise (default 0)')
    parser.add_argument('-o', '--output', default='flights', metavar='FOLDER',
                        help='where the CSV files go (default: flights)')
    parser.add_argument('--json', metavar='FILE', help='write what was flown as data; - prints it')
    parser.set_defaults(run=run)


def run(options):
    """Fly all runs of the experiment and write their records."""
    if options.seed < 0:
        raise InputError(f'--seed: expected a whole number of at least 0, got {options.seed}')
    experiment = load_experiment(options.experiment, options.vehicle)
    noise = {**experiment.noise, **noise_from(options.noise)}
    report = []
    for flight_run in experiment.runs:
        path = Path(options.output) / f'{experiment.name}_{flight_run.name}.csv'
        # A bar for each run: while one is shown, nothing may be printed.
        with progress_bar() as bar:
            flight = _flown(experiment, flight_run, noise, options.seed, bar)
            bar.add_task(f'writing {path}', total=None)
            try:
                write_csv(path, flight.record)
            except OSError as error:
                raise InputError(f'{path}: cannot be written: {error.strerror}') from None
        info = flight.record.info
        report.append({**info, 'file': str(path), 'samples': len(flight.record)})
        if options.json != '-':
            print(f'{path}: {len(flight.record)} samples, {flight.status}'
                  + (f' at t = {flight.end_time:.6g} s' if flight.status != 'complete' else ''))
            if info['infeasible']:
                print(f'  infeasible: {info["infeasible"]}')
            print('  last sample: ' + ', '.join(
                f'{name} = {flight.record.columns[name][-1]:.9g} {unit}' for name, unit in
                (('phi', 'rad'), ('theta', 'rad'), ('psi', 'rad'), ('pz', 'm'))))
    if options.json:
        write_json(options.json, [{key: None if isinstance(value, float)
                                   and not math.isfinite(value) else value
                                   for key, value in entry.items()} for entry in report])


def _flown(experiment, run, noise, seed, bar):
    """Return what flying a run gives; how far it is in closed loop, nobody says."""
    task = bar.add_task(f'flying {run.name}', total=None)
    flight = fly(experiment, run, noise=noise, seed=seed,
                 on_progress=lambda share: bar.update(task, total=1.0, completed=share))
    bar.remove_task(task)
    return flight
