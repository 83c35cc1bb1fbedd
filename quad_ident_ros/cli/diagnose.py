# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident diagnose`: where the sim-to-real gap lies, what causes it, how far it shrinks."""

import argparse
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
import sys
import textwrap

from quad_ident_ros.cli.options import (
    add_selection,
    asking_for_vehicle,
    flights_from,
    selection_of,
    thrust_by_log,
    vehicle_from,
)
from quad_ident_ros.closed_loop.controller import controller_of
from quad_ident_ros.closed_loop.controller import INTERFACE as OF_CONTROLLERS
from quad_ident_ros.data.split import joined
from quad_ident_ros.data.told_apart import Apart
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.priors import load_priors
from quad_ident_ros.diagnose.provenance import Run, run_of
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import UNITS
from quad_ident_ros.model.vehicle import write_vehicle
from quad_ident_ros.report.ceiling import residual_line
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.diagnosis import ALL, show, USUAL, VERDICT
from quad_ident_ros.report.screen import progress_bar
from quad_ident_ros.tolerances import EXAMPLE, rules_from
from quad_ident_ros.user_simulator.program import INTERFACE
from quad_ident_ros.user_simulator.simulator import Simulator


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'diagnose', help=summary,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Compare flights of a real vehicle with its nominal description. The last '
                    'flight named is held\nout: no effect is fitted to it, and the gap is '
                    'measured on it. Contributions are judged on all\nflights.',
        epilog='effects:\n'
               + ''.join(f'  {effect.name}: {effect.title}\n' for effect in EFFECTS.values())
               + '\n'
               'a simulator for --simulator, whose file is run:\n'
               + textwrap.indent(INTERFACE, '  ') + '\n\n'
               'a controller for --controller, whose file is run:\n'
               + textwrap.indent(OF_CONTROLLERS, '  ') + '\n\n'
               '  quad_ident diagnose monday_*.csv.gz --vehicle quad.yaml\n'
               '  quad_ident diagnose a.csv b.csv --hold-out c.csv --vehicle quad.yaml \\\n'
               '      --json diagnosis.json --out-vehicle like_real.yaml\n'
               '  quad_ident diagnose a.csv b.csv c.csv --vehicle quad.yaml \\\n'
               '      --out-vehicle like_real.yaml --residual\n'
               '  quad_ident diagnose log_12.ulg --vehicle auto --segment 2 --from 35 --to 95\n'
               '  quad_ident diagnose a.csv b.csv --vehicle quad.xml --simulator mine.py:Quad\n'
               '  quad_ident diagnose a.csv b.csv --vehicle quad.yaml --controller ours\n\n'
               'docs/diagnosis.md explains every line of the answer, docs/simulators.md has '
               'simulators and controllers.')
    parser.add_argument('flights', nargs='+', metavar='FLIGHT',
                        help='a table (CSV, Parquet), a bag (ROS 1 or 2), or a log of PX4, '
                             'ArduPilot, Crazyflie or Betaflight')
    parser.add_argument('--vehicle', help='required: the nominal vehicle, a name or a file, with '
                        'the effects that your simulator already has; auto: the file beside a '
                        'PX4 log, written from its parameters')
    parser.add_argument('--hold-out', metavar='FLIGHT',
                        help='the flight on which the gap is measured (default: the last '
                        'one named)')
    parser.add_argument('--mapping', metavar='FILE', help='which topics and outputs of other '
                        "people's records mean what (YAML)")
    parser.add_argument('--effects', metavar='A,B', help='only these may be named (default: all)')
    usual = ', '.join(f'{name}={RULES.floors[name]:g} {unit}' for name, unit in UNITS.items())
    parser.add_argument('--tolerance', metavar='GROUP=VALUE[,...]',
                        help='gap beyond the noise that does not matter half a second ahead, for '
                             f'example {EXAMPLE}; never less than {100 * RULES.noise_share:.0f} '
                             f'%% of what the noise makes (default: {usual})')
    parser.add_argument('--priors', metavar='FILE', help='what a fleet of such vehicles has '
                        'taught: how often each effect is present and how large; written by '
                        '`quad_ident fleet --out-priors`')
    parser.add_argument('--simulator', metavar='FILE.py:NAME',
                        help='a class of yours that flies the nominal vehicle: its gap, where it '
                             'lies, and how far it shrinks with the effects named around it; '
                             'see below')
    parser.add_argument('--controller', metavar='FILE.py:NAME',
                        help='a class of yours that controls the vehicle, or `ours`: the tracking '
                             'error and bandwidth with the nominal, the corrected and the real '
                             'vehicle, and what each effect costs; see below')
    parser.add_argument('--json', metavar='FILE', help='write the diagnosis as data; - prints it')
    parser.add_argument('--report', metavar='FILE.html',
                        help='write a page for a browser: the verdict, pictures, all numbers')
    parser.add_argument('--out-vehicle', metavar='FILE',
                        help='write the vehicle file with the effects named, for the simulator')
    parser.add_argument('--residual', action='store_true',
                        help='also write into that file what no effect explains, as a force and a '
                             'moment that depend on state and command, if that helps on the '
                             'held-out flight')
    amount = parser.add_mutually_exclusive_group()
    amount.add_argument('--quiet', '-q', dest='detail', action='store_const', const=VERDICT,
                        default=USUAL, help='print only the verdict, its size and the next step, '
                        'and no progress')
    amount.add_argument('--verbose', '-v', dest='detail', action='store_const', const=ALL,
                        help='also print the gap at 0.1, 0.5 and 1 s, and what was estimated '
                        'for each flight')
    add_selection(parser)
    parser.set_defaults(run=run)


def run(options):
    """Read the flights, diagnose, and show what came of it."""
    rules = RULES if options.tolerance is None else rules_from(options.tolerance.split(','),
                                                               '--tolerance')
    if options.priors is not None:
        rules = replace(rules, priors=load_priors(options.priors))
    if options.residual and not options.out_vehicle:
        raise InputError('--residual: it is written into a vehicle file; name one with '
                         '--out-vehicle FILE.yaml')
    selection = selection_of(options)
    if options.vehicle is None:
        raise InputError(asking_for_vehicle(options.flights[0]))
    vehicle = vehicle_from(options.vehicle, options.flights[0], options.mapping)
    by_log = thrust_by_log(options.vehicle, options.flights[0])
    effects = ([name.strip() for name in options.effects.split(',')]
               if options.effects is not None else None)
    # Read one after the other as they are taken in, and not kept beside what is made of them.
    apart = Apart([*options.flights, *([options.hold_out] if options.hold_out else [])])

    def read(path):
        return apart.named(path, flights_from(path, options.mapping, vehicle, selection, by_log))

    records = (record for path in options.flights for record in read(path))
    held = joined(read(options.hold_out))[-1] if options.hold_out else None
    controller = controller_of(options.controller, vehicle) if options.controller else None
    with (Simulator(options.simulator, vehicle) if options.simulator else nullcontext()
          ) as simulator, progress_bar(options.detail == VERDICT) as bar:
        task = bar.add_task('comparing sets of effects', total=1.0)
        found = diagnose(records, vehicle, hold_out=held, effects=effects, rules=rules,
                         simulator=simulator, controller=controller,
                         on_progress=lambda share: bar.update(task, completed=share))
    if options.json != '-':
        show(found, sys.stdout, options.detail, options.out_vehicle)
    if options.json:
        write_json(options.json, found.as_data())
    if options.report:
        from quad_ident_ros.report import gap_page  # it draws: half a second to import
        gap_page.write(options.report, replace(found, run=_run_of(options)), options.out_vehicle)
    if options.out_vehicle:
        made = found.corrected(vehicle)
        if options.residual and found.residual is not None:
            made = replace(made, residual=found.residual)
        write_vehicle(options.out_vehicle, made)
    if options.residual and options.json != '-':
        print(residual_line(found))


def _run_of(options: argparse.Namespace) -> Run:
    """Return the Run of this command on the files that it has read."""
    given = [options.vehicle] if Path(options.vehicle).is_file() else []
    others = [path for path in (options.hold_out, options.mapping, options.priors) if path]
    return run_of(options.words, [*options.flights, *others, *given])
