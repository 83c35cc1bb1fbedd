# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the inner loops ahead of the first real work."""

from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.flight.fly import fly_closed_loop, SHORTEST
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.search import SwarmSettings
from quad_ident_ros.model.vehicle import load_vehicle


def warm_up():
    """Fly and identify small flights with the smallest effort, in every way that is compiled."""
    experiment = load_experiment('small_angle')
    records = [fly(experiment, run).record for run in experiment.runs]
    least = SwarmSettings(population=4, generations=1)
    for choice in ({}, {'search': 'joint'}, {'initial_state': 'free'}):
        identify(records, Settings(swarm=least, **choice))
    fly_closed_loop(load_vehicle('paper_quadrotor'), {}, 'hover', duration=SHORTEST)
