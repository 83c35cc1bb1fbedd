# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident node`: run a ROS 2 node, for those who have no `ros2` command."""

import argparse
import importlib

from quad_ident_ros.errors import InputError

NODES = ('simulator', 'recorder', 'identifier', 'diagnoser')


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser(
        'node', help=summary,
        description='Run a ROS 2 node. `quad_ident node NAME --help` lists its topics, services '
                    'and parameters.')
    parser.add_argument('name', choices=NODES)
    parser.add_argument('arguments', nargs=argparse.REMAINDER, help='--ros-args ...')
    parser.set_defaults(run=run)


def run(options):
    """Run the node until it is stopped; returns its exit code."""
    try:
        module = importlib.import_module(f'quad_ident_ros.nodes.{options.name}')
    except ImportError as error:
        from quad_ident_ros.cli.options import asking_for_ros  # a second; help needs none of it
        raise InputError(asking_for_ros(error)) from None
    return module.main(options.arguments)
