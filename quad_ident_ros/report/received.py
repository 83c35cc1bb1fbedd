# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis that came as data, as over ROS 2, typed again so that it can be shown."""

from dataclasses import replace

import numpy as np

from quad_ident_ros.diagnose.result import (
    Ceiling,
    Channel,
    Diagnosis,
    FlightCheck,
    Gap,
    GapGivenAttitude,
    Minor,
    Ranked,
    ShareClosed,
    Unexplained,
    Value,
)
from quad_ident_ros.model.covariance import covariance_from
from quad_ident_ros.model.vehicle import Vehicle


def diagnosis_from(data: dict, vehicle: Vehicle | None) -> Diagnosis:
    """
    Return the Diagnosis of a nominal vehicle that Diagnosis.as_data made data of.

    Without the parameter vector and what pictures are drawn from, which do not travel. vehicle:
    None where only the words and the gap are wanted; the covariance is then left out.
    """
    ranking = (Ranked(**row) for row in data['ranking'])
    return Diagnosis(
        vehicle=vehicle, verdict=tuple(data['verdict']),
        minor=tuple(Minor(**row) for row in data['minor']),
        ranking=tuple(replace(row, parameters={name: Value(**one) for name, one in
                                               row.parameters.items()}) for row in ranking),
        where=tuple(Channel(**row) for row in data['where']), gap=Gap(**data['gap']),
        gap_given_attitude=GapGivenAttitude(**data['gap_given_attitude']),
        ceiling=_ceiling_from(data['ceiling']), tolerance=data['tolerance'],
        unknown=tuple(Unexplained(**row) for row in data['unknown'] or ()),
        form_unknown=tuple(data['form_unknown'] or ()),
        undetermined=tuple(data['undetermined'] or ()), sure=tuple(data['sure'] or ()),
        one_finding=tuple(data['one_finding']), not_shown=tuple(data['not_shown']),
        fly_next=data['fly_next'], nuisances=data['nuisances'], flights=tuple(data['flights']),
        held_out=data['held_out'],
        flight_checks=tuple(FlightCheck(**row) for row in data['flight_checks']),
        findings=tuple(data['findings']), z=np.empty(0), pictures=None,
        covariance=vehicle and data['covariance'] and covariance_from(
            'covariance', data['covariance'], len(vehicle.rotors)))


def _ceiling_from(data: dict) -> Ceiling:
    """Return the Ceiling that asdict made data of."""
    return Ceiling(ShareClosed(**data['open_loop']), ShareClosed(**data['given_attitude']),
                   data['gain'], tuple(data['shown']))
