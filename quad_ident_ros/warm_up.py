# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the inner loops ahead of the first real work."""

import numpy as np

from quad_ident_ros.effects.registry import NULL
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.flight.fly import fly_closed_loop, SHORTEST
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.search import SwarmSettings
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.model.contribution import contribution
from quad_ident_ros.model.dynamics import Course, predict


def warm_up():
    """Fly and identify small flights with the smallest effort, in every way that is compiled."""
    experiment = load_experiment('small_angle')
    records = [fly(experiment, run).record for run in experiment.runs]
    least = SwarmSettings(population=4, generations=1)
    for choice in ({}, {'search': 'joint'}, {'initial_state': 'free'}):
        identify(records, Settings(swarm=least, **choice))
    fly_closed_loop(load_vehicle('paper_quadrotor'), {}, 'hover', duration=SHORTEST)
    vehicle = experiment.vehicle
    course = Course(np.arange(3) * 0.01, np.zeros((3, len(vehicle.rotors))), np.zeros(3))
    level = np.tile([0.0] * 6 + [1.0] + [0.0] * 6, (2, 1))
    for starts in (level, level[:1]):
        states = predict(vehicle, NULL, course, starts, [0] * len(starts), 2)
    contribution(vehicle, NULL, course, states[0])
