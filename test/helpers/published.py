# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes publish as JSON, made without ROS by what makes it there."""

from dataclasses import replace
from functools import lru_cache
import json

import numpy as np

from quad_ident_ros.data.joiner import Counts
from quad_ident_ros.diagnose.result import (
    Ceiling,
    Diagnosis,
    Gap,
    GapGivenAttitude,
    Ranked,
    ShareClosed,
    Value,
)
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.result import as_data
from quad_ident_ros.model.vehicle import load_vehicle

UNITS = {'position': 'm', 'velocity': 'm/s', 'attitude': 'rad', 'rate': 'rad/s'}
TOPICS = ('attitude', 'altitude', 'pose', 'twist', 'input')


def account(received, **changes):
    """Return the account of a recorder that got so many messages on each topic."""
    return {**vars(Counts(received=dict.fromkeys(TOPICS, received), joined=received)),
            'records': 0, 'buffered': received, 'run': '', 'recording': None, 'disk_error': None,
            **changes}


@lru_cache
def identification():
    """Return parameters_json of a fit by least squares to a flight without noise."""
    experiment = load_experiment('hover_single_axis')
    result = identify([fly(experiment, run).record for run in experiment.runs],
                      Settings(methods=('ls',)))
    return json.loads(json.dumps(as_data(result)))


def diagnosis(**changes):
    """Return a Diagnosis that names rotor drag, with changes of its fields."""
    gap = {name: dict.fromkeys(UNITS, value) for name, value in (
        ('before', 0.115), ('before_own', 0.115), ('after', 0.0331), ('noise', 0.0375))}
    interval = {stage: {name: (0.9 * value, 1.1 * value) for name, value in gap[stage].items()}
                for stage in ('before', 'after')}
    closed = ShareClosed(gap['after'], 1.0, 0.01, 'velocity')
    return replace(Diagnosis(
        vehicle=load_vehicle('hummingbird'), verdict=('rotor_drag',), minor=(),
        ranking=(Ranked('rotor_drag', 0.99, 'by_speed', 1.0, 1.0, 1.0, 60.0, 0,
                        {'coefficient': Value(0.2, 0.0015, 'kg/s')}, gap['after'],
                        gap['before']),),
        where=(), gap=Gap(0.5, UNITS, **gap, before_interval=interval['before'],
                          after_interval=interval['after'], closed=1.0,
                          horizons={}, without={'rotor_drag': gap['before']}),
        gap_given_attitude=GapGivenAttitude(0.5, **gap, closed=1.0),
        ceiling=Ceiling(closed, closed, {'force': 0.0, 'moment': 0.0}, ()), tolerance={},
        unknown=(), form_unknown=(), undetermined=(), sure=(), one_finding=(), not_shown=(),
        fly_next=None, nuisances=None, flights=('figure8', 'circle'), held_out='circle',
        flight_checks=(), findings=(), z=np.empty(0), pictures=None, covariance=None), **changes)


def published(found, end_ns=12_340_000_000):
    """Return what the diagnoser publishes of a Diagnosis of flights that end at a stamp."""
    return json.loads(json.dumps({
        **found.as_data(), 'time': '2026-01-01T00:00:00+00:00', 'span_ns': [0, end_ns],
        'dropped_samples': 0}))
