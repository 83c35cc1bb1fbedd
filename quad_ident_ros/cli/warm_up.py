# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident warm-up`: compile the inner loops, so that the first real start need not."""

from quad_ident_ros.warm_up import warm_up, warm_up_diagnosis


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser('warm-up', help=summary)
    parser.set_defaults(run=run)


def run(options):
    """Compile what is not compiled yet."""
    warm_up()
    warm_up_diagnosis()
