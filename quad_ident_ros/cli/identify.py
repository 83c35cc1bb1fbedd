# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident identify`: fit the four models to recorded flights."""

import argparse

from quad_ident_ros.cli.options import add_selection, flights_from, selection_of
from quad_ident_ros.data.commands import with_inputs
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.identify import identify, Settings, with_budget
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.result import as_data
from quad_ident_ros.identify.vp import COMPLEX_PENALTY
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.picture import save_responses
from quad_ident_ros.report.screen import console, progress_bar
from quad_ident_ros.report.table import identification_table, legend, notes
from quad_ident_ros.vehicle_files.load import load_any_vehicle


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'identify', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Fit K/((s+a)(s+b)) to roll, pitch, yaw and altitude of flight records. '
                    'Several\nrecords, for instance one per axis, make one identification.',
        epilog='A bag of our recorder states its trim and that it starts at rest; for a CSV file '
               'give both:\n  quad_ident identify flight_1.csv --trim hover --initial-state rest\n'
               'The level at which a CSV file rests is estimated; that of a bag is known.')
    parser.add_argument('flights', nargs='+', metavar='FLIGHT',
                        help='.csv, .csv.gz, the folder of a bag, or an .mcap or .db3 file')
    parser.add_argument('--method', choices=('all', *METHODS), default='all')
    parser.add_argument('--seed', type=int, default=0, help='seed of the searches (default 0)')
    parser.add_argument('--evaluations', type=int, metavar='N',
                        help='evaluations of the objective per search, the same for each method '
                             '(default: the 20 generations of the paper)')
    parser.add_argument('--trim', choices=('record', 'hover', 'zero'), default='record',
                        help='inputs that count as zero: what the record says or its first '
                             "sample (default), the vehicle's weight on U1, or none")
    parser.add_argument('--vehicle',
                        help='vehicle name or file, for --trim hover (default paper_quadrotor) '
                             'and for flights that have rotor commands cmd1..N and no u1..u4')
    parser.add_argument('--initial-state', choices=('auto', 'rest', 'free'), default='auto',
                        help='free estimates the state at the first sample; auto (default) takes '
                             'rest where the record says so')
    parser.add_argument('--poles', choices=tuple(COMPLEX_PENALTY), default='auto',
                        help='complex pairs: real never, auto (default) if they reduce the error '
                             'by more than noise does, any if they are better at all')
    parser.add_argument('--search', choices=('per_output', 'joint'), default='per_output',
                        help="joint is the paper's literal 12-dimensional search")
    parser.add_argument('--box', choices=('scaled', 'literal'), default='scaled')
    for name, unit in (('pole', ', 1/s'), ('gain', '')):
        parser.add_argument(f'--{name}-bounds', nargs=2, type=float, metavar=('LOW', 'HIGH'),
                            help=f'bounds of the {name}s{unit} (default: from the data)')
    parser.add_argument('--json', metavar='FILE', help='write the results as data; - prints them')
    parser.add_argument('--picture', metavar='FILE',
                        help='draw measured and fitted responses (.png, .svg, .pdf)')
    add_selection(parser)
    parser.set_defaults(run=run)


def run(options):
    """Read the flights, identify, and show the result."""
    if options.seed < 0:
        raise InputError(f'--seed: expected a whole number of at least 0, got {options.seed}')
    if options.evaluations is not None and options.evaluations < 1:
        raise InputError(f'--evaluations: expected at least 1, got {options.evaluations}')
    trim = {'record': None, 'zero': (0.0, 0.0, 0.0, 0.0)}.get(options.trim)
    if options.trim == 'hover':
        trim = tuple(load_any_vehicle(options.vehicle or 'paper_quadrotor').hover_input)
    settings = Settings(
        methods=tuple(METHODS) if options.method == 'all' else (options.method,),
        seed=options.seed, search=options.search, box=options.box, poles=options.poles,
        pole_bounds=options.pole_bounds, gain_bounds=options.gain_bounds,
        initial_state=options.initial_state, trim=trim)
    settings = with_budget(settings, options.evaluations)
    selection = selection_of(options)
    records = [record for path in options.flights
               for record in flights_from(path, selection=selection)]
    if options.vehicle:
        vehicle = load_any_vehicle(options.vehicle)
        records = [with_inputs(record, vehicle) for record in records]
    with progress_bar() as bar:
        task = bar.add_task('fitting', total=len(settings.methods))

        def on_progress(method, output, share):
            bar.update(task, description=f'fitting {METHODS[method].label} {output}',
                       completed=settings.methods.index(method) + (share if not output else 0))

        result = identify(records, settings, on_progress=on_progress)
    if options.json != '-':
        show(result)
    if options.picture:
        save_responses(result, options.picture, 'Measured and fitted responses')
    if options.json:
        write_json(options.json, as_data(result))


def show(result):
    """Print the table of an identification and its remarks."""
    screen = console()
    screen.print(identification_table(result))
    screen.print(legend(result), markup=False, highlight=False, soft_wrap=True)
    for line in notes(result):
        screen.print(f'  note: {line}', markup=False, highlight=False, soft_wrap=True)
