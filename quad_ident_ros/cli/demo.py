# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident demo`: the whole main job on real ROS 2."""

import secrets
import sys

from quad_ident_ros.cli.identify import show
from quad_ident_ros.cli.options import asking_for_ros
from quad_ident_ros.effects.registry import EFFECTS, titled
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.result import as_data
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.diagnosis import show as show_diagnosis
from quad_ident_ros.report.picture import save_responses
from quad_ident_ros.report.received import diagnosis_from
from quad_ident_ros.report.screen import progress_bar
from quad_ident_ros.report.verdict import closed_of

PICTURE = 'responses.png'
HIDDEN = 1.2    # times the noise's gap, below which an effect does not show


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'demo', help=summary,
        description='Start simulator, recorder and identifier as three processes on a ROS domain '
                    'of their own, fly an experiment, and show what was identified. Writes a '
                    'picture, the bag, CSV files and logs. With --gap the vehicle has a hidden '
                    'effect, drawn at random and known only to the simulator: a diagnoser looks '
                    'for it, and only then is the truth printed.')
    parser.add_argument('--gap', action='store_true',
                        help='diagnose a vehicle with a hidden effect instead')
    parser.add_argument('--experiment', help='name of a shipped experiment, or path of a .yaml '
                        '(default: hover_single_axis; with --gap: closed_loop)')
    parser.add_argument('--seed', type=int,
                        help='seed of noise and searches (default 0), with --gap of the hidden '
                             'effect too (default: a new one each time)')
    parser.add_argument('--real-time-factor', type=float, default=0.0, metavar='X',
                        help='simulated seconds per second; 0 (default): as fast as it goes')
    parser.add_argument('-o', '--output', default='quad_ident_demo', metavar='FOLDER',
                        help='where everything goes, into run_1, run_2, ... '
                             '(default: quad_ident_demo)')
    parser.add_argument('--json', metavar='FILE', help='write the results as data; - prints them')
    parser.set_defaults(run=run)


def run(options):
    """Run the demo and show what came of it."""
    try:
        from quad_ident_ros.nodes.demo import run_demo
        from quad_ident_ros.nodes.gap_demo import run_gap_demo
    except ImportError as error:
        raise InputError(asking_for_ros(error)) from None
    if options.seed is None:
        options.seed = secrets.randbelow(10 ** 6) if options.gap else 0
    if options.real_time_factor < 0 or options.seed < 0:
        raise InputError('--real-time-factor and --seed must not be negative')
    if options.experiment is None:
        options.experiment = 'closed_loop' if options.gap else 'hover_single_axis'
    worker = 'diagnoser' if options.gap else 'identifier'
    with progress_bar() as bar:
        task = bar.add_task(f'starting simulator, recorder and {worker}', total=1.0)
        said = set()

        def on_progress(text, share):
            bar.update(task, description=text, completed=share)
            # Where the bar cannot be drawn, each stage gets a line.
            stage = text.split()[0]
            if bar.disable and stage not in said:
                said.add(stage)
                print(f'{text} ...', file=sys.stderr)

        outcome = (run_gap_demo if options.gap else run_demo)(options, on_progress)
    (_reveal if options.gap else _show)(options, outcome)


def _show(options, outcome):
    """Show what was identified."""
    result = outcome.identification
    picture = f'{outcome.folder}/{PICTURE}'
    save_responses(result, picture, f'{options.experiment}: measured and identified over ROS 2')
    if options.json != '-':
        show(result)
        _say_where(options, outcome, picture=picture)
    if options.json:
        write_json(options.json, {**as_data(result), 'picture': picture,
                                  'recording': outcome.recording, 'seconds': outcome.seconds})


def _reveal(options, outcome):
    """Show the diagnosis, and only then the truth."""
    found = outcome.diagnosis
    if options.json != '-':
        typed = diagnosis_from(found, load_vehicle(outcome.nominal))
        show_diagnosis(typed, sys.stdout)
        units = {(effect.name, one.name): '' if one.unit == '1' else f' {one.unit}'
                 for effect in EFFECTS.values() for one in effect.parameters}
        truth = '; '.join(', '.join([titled(name), *(
            f'{key} {value:.4g}{units[name, key]}' for key, value in values.items())])
            for name, values in outcome.effects.items())
        print(f'\n   truth: {truth}')
        gap = found['gap']
        hidden = all(gap['before'][name] < HIDDEN * gap['noise'][name] for name in gap['noise'])
        said = ('the verdict is right' if outcome.found else 'not in the verdict: its effect is '
                'within the noise' if hidden else 'the verdict is wrong')
        print(f'          {said}; {closed_of(typed.gap)}; to repeat: --seed {options.seed}')
        _say_where(options, outcome)
        print(f'pictures: ./run diagnose {outcome.recording}/flight_*.csv '
              f'--vehicle {outcome.nominal} --report diagnosis.html')
    if options.json:
        write_json(options.json, {
            'diagnosis': found, 'effects': outcome.effects, 'found': outcome.found,
            'closed': found['gap']['closed'], 'seed': options.seed,
            'recording': outcome.recording, 'seconds': outcome.seconds})


def _say_where(options, outcome, **more):
    """Say where things are, and what it took."""
    for name, value in {**more, 'bag': f'{outcome.recording}/bag',
                        'flights': f'{outcome.recording}/flight_*.csv',
                        'logs': f'{outcome.folder}/log'}.items():
        print(f'{name:>8}: {value}')
    print(f'    took: {outcome.seconds:.1f} s, {outcome.samples} samples recorded, '
          f'{outcome.dropped} dropped')
