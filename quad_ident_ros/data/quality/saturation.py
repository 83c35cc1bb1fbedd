# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotor speed commands at the limits of the vehicle."""

import numpy as np

from quad_ident_ros.data.cutting import without
from quad_ident_ros.data.quality import units
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.motors import are_thrusts
from quad_ident_ros.model.vehicle import Vehicle

NEAR = 0.002   # of the range of speeds
STUCK = 0.9    # of the samples of one rotor, which then shows nothing but the limit


def _grave(share: float, of_one: float) -> str:
    return 'error' if of_one > STUCK else 'info' if share < 0.01 else 'warning'


def speeds(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find commands at or beyond speed_min and speed_max."""
    names = record.numbered('cmd')
    if vehicle is None or not names or not np.isfinite(vehicle.speed_max):
        return []
    if units.speeds_in_rpm(record, vehicle):
        return []   # that is to be mended first
    table = record.stack(*names)
    margin = NEAR * (vehicle.speed_max - vehicle.speed_min)
    found = []
    for limit, bad in (('speed_max', table >= vehicle.speed_max - margin),
                       ('speed_min', table <= vehicle.speed_min + margin)):
        rows = np.any(bad, axis=1)
        if rows.any():
            share = rows.mean()
            worst = int(np.argmax(bad.sum(axis=0)))
            beyond = are_thrusts(vehicle.motors) and table.max() > vehicle.speed_max + margin
            found.append(Finding(
                'saturation', _grave(share, bad[:, worst].mean()),
                f'{names[worst]}, t = {record.t[int(np.argmax(rows))]:.3f} s',
                f'{100 * share:.2f} % of the samples have a command at or beyond {limit} = '
                f'{getattr(vehicle, limit):g} rad/s',
                without(record.t, rows, 'fly more gently',
                        units.OF_ROTORS if beyond else 'correct the limit in the vehicle file')))
    return found
