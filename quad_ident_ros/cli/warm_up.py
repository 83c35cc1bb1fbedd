# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident warm-up`: compile the inner loops, so that the first real start need not."""

from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.search import SwarmSettings


def add(commands):
    """Add the command to the parser."""
    parser = commands.add_parser('warm-up', help='compile the inner loops once, after install')
    parser.set_defaults(run=run)


def run(options):
    """Fly and identify the default experiment with the smallest effort."""
    experiment = load_experiment('small_angle')
    records = [fly(experiment, run).record for run in experiment.runs]
    for search in ('per_output', 'joint'):
        identify(records, Settings(swarm=SwarmSettings(population=4, generations=1),
                                   search=search))
