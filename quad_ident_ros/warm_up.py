# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the inner loops ahead of the first real work."""

from dataclasses import replace

from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.effects.registry import NULL
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.search import SwarmSettings
from quad_ident_ros.model.contribution import contribution
from quad_ident_ros.model.dynamics import course_of, states_of


def warm_up():
    """Fly and identify small flights with the smallest effort, in every way that is compiled."""
    experiment = load_experiment('small_angle')
    records = [fly(experiment, run).record for run in experiment.runs]
    least = SwarmSettings(population=4, generations=1)
    for choice in ({}, {'search': 'joint'}, {'initial_state': 'free'}):
        identify(records, Settings(swarm=least, **choice))


def warm_up_diagnosis():
    """Fly a closed loop and diagnose it, by its commands: measured speeds need less."""
    experiment = load_experiment('closed_loop')
    record = fly(experiment, experiment.runs[0]).record
    record = replace(record, columns={name: values for name, values in record.columns.items()
                                      if name not in record.numbered('rotor')})
    diagnose([record], experiment.vehicle)
    contribution(experiment.vehicle, NULL, course_of(record, experiment.vehicle),
                 states_of(record))
