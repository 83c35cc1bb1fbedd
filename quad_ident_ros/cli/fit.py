# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident fit`: chosen physical parameters from flights."""

import argparse
from dataclasses import replace
import textwrap

from quad_ident_ros.cli.options import (
    add_selection,
    flights_from,
    selection_of,
    thrust_by_log,
    vehicle_from,
)
from quad_ident_ros.effects.registry import EFFECTS, titled
from quad_ident_ros.greybox.cautions import cautions
from quad_ident_ros.greybox.free import columns_of_names, EXCITATION
from quad_ident_ros.greybox.taken_in import taken_in
from quad_ident_ros.model.vehicle import write_vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.screen import console, progress_bar


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'fit', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Estimate chosen physical parameters of a vehicle from flight records, by '
                    'prediction error over short\nrollouts, with standard errors, and say what '
                    'the flights cannot determine.',
        epilog='what can be freed, separated by commas:\n'
               f'  constants of the vehicle file: {", ".join(EXCITATION)},\n'
               '  or one component, such as inertia_x\n'
               + _wrapped(EFFECTS)
               + '  or one parameter of an effect, such as motor_lag.time_constant\n\n'
               'mass, inertia, thrust and drag together have no scale: leave out what you can '
               'weigh.\n\nexample:\n  quad_ident fit flight.csv --vehicle v.yaml --free '
               'inertia,thrust_coefficient,motor_lag --out-vehicle v2.yaml')
    parser.add_argument('flights', nargs='+', metavar='FLIGHT',
                        help='a table (CSV, Parquet), a bag (ROS 1 or 2), or a log of PX4, '
                             'ArduPilot, Crazyflie or Betaflight')
    parser.add_argument('--mapping', metavar='FILE', help='which topics and outputs of other '
                        "people's records mean what (YAML)")
    parser.add_argument('--vehicle', required=True, help='vehicle name or file: the start values, '
                        'and the values of everything that is not freed; auto: the file beside a '
                        'PX4 log')
    parser.add_argument('--free', required=True, metavar='NAME,...', help='what to estimate')
    parser.add_argument('--out-vehicle', metavar='FILE',
                        help='write the vehicle file with the estimated constants')
    parser.add_argument('--json', metavar='FILE', help='write the results as data; - prints them')
    add_selection(parser)
    parser.set_defaults(run=run)


def run(options):
    """Read the flights, fit, show the result and write the files asked for."""
    from quad_ident_ros.greybox.fit import as_data, fit, fitted_vehicle
    names = [name.strip() for name in options.free.split(',') if name.strip()]
    vehicle = vehicle_from(options.vehicle, options.flights[0], options.mapping)
    by_log = thrust_by_log(options.vehicle, options.flights[0])
    selection = selection_of(options)
    free = columns_of_names(names, vehicle)   # before the flights are read: a name that is wrong
    with progress_bar() as bar:
        task = bar.add_task('', total=1.0)
        records = []
        for number, path in enumerate(options.flights):
            bar.update(task, description=f'reading {path}',
                       completed=number / len(options.flights))
            records += flights_from(path, options.mapping, vehicle, selection, by_log)
        bar.update(task, description='looking for faults')
        records, quality = zip(*taken_in(records, vehicle), strict=True)
        found = fit(records, vehicle, names, lambda share: bar.update(
            task, description='fitting', completed=share))
    found = replace(found, findings=(*found.findings, *cautions(
        tuple(zip(found.flights, quality, strict=True)), free)))
    if options.json != '-':
        show(found)
    if options.out_vehicle:
        write_vehicle(options.out_vehicle, fitted_vehicle(found))
    if options.json:
        write_json(options.json, as_data(found))


def show(found):
    """Print the table of a fit and what is to be known of it."""
    from quad_ident_ros.report.fit_table import fit_table
    screen = console()
    screen.print(fit_table(found))
    screen.print('± is one standard error.', markup=False, highlight=False)
    for line in found.findings:
        screen.print(f'  note: {line}', markup=False, highlight=False, soft_wrap=True)


def _wrapped(names):
    """Return the titles and names of the effects as lines of the help."""
    return textwrap.fill(f'effects: {", ".join(map(titled, names))},', 95, initial_indent='  ',
                         subsequent_indent='  ') + '\n'
