# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident demo`: the whole main job on real ROS 2."""

import sys

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.result import as_data
from quad_ident_ros.report.data import write_json

PICTURE = 'responses.png'


def add(commands):
    """Add the command to the parser."""
    parser = commands.add_parser(
        'demo', help='simulate, record and identify on ROS 2, in three processes',
        description='Start simulator, recorder and identifier as three processes on a ROS domain '
                    'of their own, fly an experiment, and show what was identified. Writes a '
                    'picture, the bag, CSV files and logs.')
    parser.add_argument('--experiment', default='hover_single_axis',
                        help='name of a shipped experiment, or path of a .yaml')
    parser.add_argument('--seed', type=int, default=0,
                        help='seed of noise and searches (default 0)')
    parser.add_argument('--real-time-factor', type=float, default=0.0, metavar='X',
                        help='simulated seconds per second; 0 (default): as fast as it goes')
    parser.add_argument('-o', '--output', default='quad_ident_demo', metavar='FOLDER',
                        help='where everything goes (default: quad_ident_demo)')
    parser.add_argument('--json', metavar='FILE', help='write the results as data; - prints them')
    parser.set_defaults(run=run)


def run(options):
    """Run the demo and show what came of it."""
    from quad_ident_ros.cli.identify import progress_bar, show
    from quad_ident_ros.report.picture import save_responses
    try:
        from quad_ident_ros.nodes.demo import run_demo
    except ImportError as error:
        raise InputError(f'ROS 2 is not there ({error}): source a ROS 2 Jazzy, or start this as '
                         '`./run demo`, which installs it') from None
    with progress_bar() as bar:
        task = bar.add_task('starting simulator, recorder and identifier', total=1.0)
        said = set()

        def on_progress(text, share):
            bar.update(task, description=text, completed=share)
            # Where the bar cannot be drawn, each stage gets a line.
            stage = text.split()[0]
            if bar.disable and stage not in said:
                said.add(stage)
                print(f'{text} ...', file=sys.stderr)

        outcome = run_demo(options, on_progress)
    result = outcome.identification
    picture = f'{options.output}/{PICTURE}'
    save_responses(result, picture, f'{options.experiment}: measured and identified over ROS 2')
    if options.json != '-':
        show(result)
        for name, value in (('picture', picture), ('bag', f'{outcome.recording}/bag'),
                            ('flights', f'{outcome.recording}/flight_*.csv'),
                            ('logs', f'{options.output}/log')):
            print(f'{name:>8}: {value}')
        print(f'    took: {outcome.seconds:.1f} s, {outcome.samples} samples recorded, '
              f'{outcome.dropped} dropped')
    if options.json:
        write_json(options.json, {**as_data(result), 'picture': picture,
                                  'recording': outcome.recording, 'seconds': outcome.seconds})
