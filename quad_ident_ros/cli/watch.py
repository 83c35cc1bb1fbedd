# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident watch`: a live view of a vehicle on ROS 2 in the terminal."""

import argparse
import os
import signal
import sys
import threading

from quad_ident_ros.cli.options import asking_for_ros
from quad_ident_ros.errors import InputError

DESCRIPTION = """\
Follow recorder, identifier and diagnoser of a vehicle in the terminal, over ssh too:

  recorder    messages per second of each topic, samples joined, what was lost
  identifier  K, a, b of each output ± one standard error, and when it last changed
  diagnoser   the verdict, and the gap before and after it beside that of noise
  history     verdicts, changes of the vehicle and answers to your keys

keys: i identify, d diagnose, f flush (the recorder publishes what it has as a record), q quit;
arrows and Page Up/Down scroll the history. It changes nothing until you
press a key."""

EPILOG = """\
It listens on the ROS domain of ROS_DOMAIN_ID. With ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST, which
./run sets where you do not, only to nodes of this machine: for a vehicle in the network, set it to
SUBNET.

example, each line in a terminal of its own:
  quad_ident watch
  quad_ident node recorder
  quad_ident node diagnoser --ros-args -p vehicle:=hummingbird
  quad_ident node simulator --ros-args -p experiment:=closed_loop \\
      -p "effects:=['rotor_drag:coefficient=0.2']"
"""


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser('watch', help=summary, description=DESCRIPTION, epilog=EPILOG,
                                 formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--namespace', default='', metavar='NAME',
                        help='namespace of the nodes, such as uav1 (default: none)')
    parser.set_defaults(run=run)


def run(options):
    """Show the view until q or Ctrl-C; raises InputError where it cannot be shown."""
    if not all(stream.isatty() for stream in (sys.stdin, sys.stdout, sys.stderr)):
        raise InputError('this is not a terminal: start it in one, without a pipe or redirection '
                         '(with ssh: ssh -t HOST ...); `ros2 topic echo` prints the same topics')
    missing = []
    try:
        from quad_ident_ros.nodes.watching import Watching
    except ImportError as error:
        missing.append(asking_for_ros(error))
    try:
        from quad_ident_ros.watch.view import WatchApp
    except ModuleNotFoundError as error:
        if (error.name or '').partition('.')[0] != 'textual':
            raise
        missing.append('the live view needs Textual, which is not installed: '
                       "pip install 'quad_ident_ros[watch]'")
    if missing:
        raise InputError('; '.join(missing))
    # Threads inherit the mask: the signal must reach the one that waits, not those of DDS.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
    with Watching(options.namespace) as source:
        threading.Thread(target=_end_at_hang_up, args=(source,), daemon=True).start()
        WatchApp(source).run()


def _end_at_hang_up(source):
    """
    Wait for the end of the terminal; then end the process, with 0, as after q.

    The kernel sends SIGCONT with SIGHUP, and Textual, which then starts its output again, waits
    forever for the terminal that is gone: nothing of it may be waited for.
    """
    signal.sigwait({signal.SIGHUP})
    try:
        source.close()
    finally:
        os._exit(0)
