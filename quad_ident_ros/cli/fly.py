# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident fly`: make a closed-loop flight whose truth is known."""

import argparse
from pathlib import Path

import numpy as np

from quad_ident_ros import resources, schema
from quad_ident_ros.closed_loop.reference import with_asked
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.effects.registry import EFFECTS, from_entries, titled
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.flight.trajectories import plan, TRAJECTORIES
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.screen import progress_bar
from quad_ident_ros.vehicle_files.load import load_any_vehicle


def _effects_text():
    """Return the name, title and parameters, with their units, of each effect."""
    return ''.join(f'  {effect.name}: {effect.title}\n      ' + ', '.join(
        f'{parameter.name} ({parameter.unit})' if parameter.unit != '1' else parameter.name
        for parameter in effect.parameters) + '\n' for effect in EFFECTS.values())


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'fly', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Fly a trajectory in simulation under a geometric controller and write the '
                    'flight record.\nThe controller knows the vehicle of the file; the vehicle '
                    'that flies also has the effects. A\ndiagnosis of the record can be '
                    'compared with this truth.',
        epilog='trajectories; the vehicle sets their size and speed, the seed the rest:\n  '
        + ', '.join(TRAJECTORIES)
        + '\n\neffects and their parameters:\n'
        + _effects_text()
        + '\nvehicles that ship:\n  ' + ', '.join(resources.names('vehicles'))
        + '\n\nexamples:\n'
          '  quad_ident fly figure8 --vehicle paper_quadrotor -o nominal.csv\n'
          '  quad_ident fly lissajous --vehicle paper_quadrotor --noise mocap_imu --seed 3 \\\n'
          '      --effect rotor_drag:coefficient=0.1 --effect wind:x=2 -o drag.csv.gz\n\n'
          'The first flight compiles the model, which takes a minute or more, only once.')
    parser.add_argument('trajectory', help='name of a trajectory, see below')
    parser.add_argument('--vehicle', required=True, metavar='V',
                        help='name of a shipped vehicle, or a file of a kind that `quad_ident '
                        'vehicle --help` names')
    parser.add_argument('--effect', action='append', default=[],
                        metavar='NAME:PARAMETER=VALUE',
                        help='an effect of the flown vehicle, in SI units; may be repeated; '
                             'overrides that of the vehicle file')
    parser.add_argument('--seed', type=int, default=0,
                        help='seed of the trajectory and of the noise (default 0)')
    parser.add_argument('--duration', type=float, default=30.0, metavar='S',
                        help='length of the flight, s (default 30)')
    parser.add_argument('--rate', type=float, default=100.0, metavar='HZ',
                        help='samples and commands per second (default 100)')
    parser.add_argument('--noise', default='clean', metavar='SENSORS',
                        help='clean: none (default); mocap_imu: usual white and coloured noise; '
                             'faulty: in addition, the motion capture is late and slow, velocity '
                             'is differentiated, packets are lost, attitude jumps')
    parser.add_argument('-o', '--output', required=True, metavar='FILE',
                        help='the flight record, .csv or .csv.gz')
    parser.add_argument('--json', metavar='FILE', help='write the truth as data; - prints it')
    parser.set_defaults(run=run)


def run(options):
    """Fly, write the record and say what was flown."""
    schema.check_keys('--noise', {options.noise: None}, SENSORS)
    vehicle = load_any_vehicle(options.vehicle)
    effects = from_entries(options.effect, vehicle.effects, '--effect')
    path = Path(options.output)
    if not path.name.endswith(('.csv', '.csv.gz')):
        raise InputError(f'--output {options.output}: expected the name of a .csv or .csv.gz file')
    with progress_bar() as bar:
        bar.add_task('flying', total=None)
        record = fly_closed_loop(vehicle, effects, options.trajectory, duration=options.duration,
                                 rate=options.rate, seed=options.seed,
                                 noise=SENSORS[options.noise])
    record = with_asked(record, plan(options.trajectory, vehicle, options.duration, options.seed))
    write_csv(path, record)
    if options.json != '-':
        speed = np.linalg.norm(record.stack('vx', 'vy', 'vz'), axis=1)
        print(f'{path}: {len(record)} samples, {record.t[-1]:g} s, up to {speed.max():.3g} m/s, '
              f'{record.columns["pz"].min():.3g} to {record.columns["pz"].max():.3g} m high')
        print('  effects: ' + ('; '.join(
            titled(name) + ' ' + ', '.join(f'{key} = {value:g}' for key, value in values.items())
            for name, values in effects.items()) or 'none'))
    if options.json:
        write_json(options.json, {**record.info, 'noise': options.noise, 'file': str(path),
                                  'samples': len(record)})
