# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident withheld`: the check on flights whose effects are withheld, in a checkout."""

import importlib.util
import os
from pathlib import Path
import subprocess
import sys

from quad_ident_ros.errors import InputError

ROOT = Path(__file__).resolve().parents[2]


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    # No argument begins with this: all of them go on to the check as they are.
    parser = commands.add_parser(
        'withheld', add_help=False, prefix_chars='\0',
        help=summary)
    parser.add_argument('arguments', nargs='*')
    parser.set_defaults(run=run)


def run(options):
    """Start the check of the checkout, in a process of its own."""
    if not (ROOT / 'withheld' / '__main__.py').is_file():
        raise InputError('the check is not installed with the package: get the source of '
                         'quad_ident_ros and start it there as `./run withheld`')
    module, arguments = 'withheld', options.arguments
    if arguments[:1] == ['fleet']:      # a check of its own, which needs no other package
        module, arguments = 'withheld.fleet', arguments[1:]
    asks = {'-h', '--help'} & set(arguments) or module == 'withheld.fleet'
    if not asks and importlib.util.find_spec('rotorpy') is None:
        raise InputError('the check flies with rotorpy, which is not here: start it as '
                         '`./run withheld`, which installs it beside .venv')
    search = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get('PYTHONPATH')])])
    return subprocess.run([sys.executable, '-m', module, *arguments],
                          env={**os.environ, 'PYTHONPATH': search}).returncode
