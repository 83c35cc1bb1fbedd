# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The command `quad_ident`."""

import argparse
import importlib
import re
import sys

from quad_ident_ros import __version__
from quad_ident_ros.cli.node import NODES
from quad_ident_ros.errors import InputError
from quad_ident_ros.schema import suggestion, unknown_key

COMMANDS = {
    'demo': 'simulate, record and identify, or diagnose, on ROS 2, in three processes',
    'simulate': 'fly an experiment in simulation and write flight records',
    'fly': 'fly a trajectory under control, with effects that you choose',
    'identify': 'fit K/((s+a)(s+b)) to recorded flights',
    'fit': 'estimate mass, inertia, drag, motor lag, ... from flights',
    'diagnose': 'say where the sim-to-real gap lies, what causes it, how far it shrinks',
    'fleet': 'diagnose the flights of many vehicles, on all cores or a cluster',
    'vehicle': "read a vehicle from a simulator's file (MJCF, SDF, URDF, rotorpy, ...)",
    'export': "write a vehicle into a simulator's own file (SDF, MJCF, rotorpy, ...)",
    'info': 'say what is in a file or flight record, and what is wrong with it',
    'convert': 'write a flight record in another format',
    'paper': "reproduce the paper's tables and figures, and check its claims",
    'withheld': 'check the diagnosis on flights whose effects are withheld from it',
    'watch': 'follow a vehicle on ROS 2 live in the terminal',
    'node': 'run a ROS 2 node (the same as `ros2 run quad_ident_ros NAME`)',
    'warm-up': 'compile the inner loops once, after install'}
"""What each command does; it is in the module of its name, whose import takes a second."""

EPILOG = """\
examples:
  quad_ident demo                                  simulate, record and identify on ROS 2
  quad_ident demo --gap                            diagnose a vehicle with a hidden effect
  quad_ident simulate hover_single_axis -o flights make flight records without ROS
  quad_ident fly circle --vehicle iris -o a.csv    make a closed-loop flight with known truth
  quad_ident identify flights/*.csv --trim hover --initial-state rest
  quad_ident fit flight.csv --vehicle v.yaml --free inertia,thrust_coefficient,motor_lag
  quad_ident diagnose a.csv b.csv --vehicle v.yaml where the vehicle differs from its model
  quad_ident fleet flights/ --vehicle v.yaml        the flights of many vehicles, on all cores
  quad_ident vehicle x500/model.sdf -o v.yaml      the vehicle that a simulator flies
  quad_ident export v.yaml --to gazebo --base model.sdf -o like_real.sdf
  quad_ident info flight.csv                       what is in a flight, and what is wrong
  quad_ident convert flight.csv flight.mcap        the same flight as a bag
  quad_ident watch --namespace uav1                follow a vehicle live on ROS 2
  quad_ident paper                                 reproduce the paper and check its claims
  quad_ident node identifier --ros-args -p method:=pso_cs
"""


def parser(wanted):
    """
    Return the parser of the command line, and {command: its parser}.

    Those of the commands in `wanted` have their options.
    """
    top = _Parser(
        prog='quad_ident', epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Identify a quadrotor online by PSO, CS, PSO-CS, LS and VP; say where, why '
                    'and how far it differs from its simulation.')
    top.add_argument('--version', action='version', version=__version__)
    commands = top.add_subparsers(dest='command', metavar='COMMAND')
    for name, summary in COMMANDS.items():
        if name in wanted:
            module = name.replace('-', '_')
            importlib.import_module(f'quad_ident_ros.cli.{module}').add(commands, summary)
        else:
            commands.add_parser(name, help=summary)
    return top, commands.choices


class _Parser(argparse.ArgumentParser):
    """Suggests, for a wrong value of several, which of them may be meant, and names numbers."""

    def __init__(self, *args, **more):
        """Take numbers by functions that say what they expect."""
        super().__init__(*args, **more)
        self.register('type', int, _whole)
        self.register('type', float, _number)

    def error(self, message):
        """End with a message in one line."""
        wrong = re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)$", message)
        if wrong:
            hint = suggestion(wrong[1], re.findall(r"[^\s',]+", wrong[2]))
            message += f'; {hint}' if hint else ''
        super().error(message)


def _whole(text):
    """Return a whole number; argparse speaks of an "invalid int value"."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f'expected a whole number, got {text!r}') from None


def _number(text):
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f'expected a number, got {text!r}') from None


def _refuse(command, unknown):
    """End with the arguments that a command's parser does not know, and what may be meant."""
    known = set(re.findall(r'^  (?:-\w[^,\n]*, )?(--[a-z][a-z-]+)', command.format_help(), re.M))
    hint = suggestion(unknown[0].partition('=')[0], known) or 'try --help'
    command.error(f'unrecognized arguments: {" ".join(unknown)}; {hint}')


def main(args=None):
    """Run a command and return the exit code: 0, or 2 with one line on standard error."""
    words = sys.argv[1:] if args is None else args
    top, parsers = parser(words[:1])
    if words and words[0] in NODES:
        top.error(f'{words[0]} is a node, not a command; did you mean: node {words[0]}')
    if words and words[0] not in COMMANDS and not words[0].startswith('-'):
        top.error(str(unknown_key('COMMAND', words[0], COMMANDS)))
    options, unknown = top.parse_known_args(words)
    options.words = tuple(words)
    if unknown:
        _refuse(parsers.get(options.command, top), unknown)
    if options.command is None:
        top.print_help()
        return 0
    # A screen that knows no plus-minus sign gets a question mark, not an end of the program.
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, 'reconfigure'):
            stream.reconfigure(errors='replace')
    from quad_ident_ros.cli.outputs import check_outputs
    from quad_ident_ros.memory import hand_back_large
    hand_back_large()
    try:
        check_outputs(options)
        return options.run(options) or 0
    except InputError as error:
        print(f'quad_ident {options.command}: error: {error}', file=sys.stderr)
        return 2
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            # Whoever read our output has enough of it; say nothing when Python closes it.
            sys.stdout = None
            return 141
        print(f'quad_ident {options.command}: error: {error.filename or "output"}: '
              f'{error.strerror}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f'quad_ident {options.command}: interrupted', file=sys.stderr)
        return 130
