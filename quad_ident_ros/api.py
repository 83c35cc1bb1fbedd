# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The public Python API: what scripts and notebooks import; docs/python.md shows it at work."""

from quad_ident_ros.data.load import load as read
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.result import Diagnosis
from quad_ident_ros.effects.registry import titled
from quad_ident_ros.errors import Cancelled, InputError
from quad_ident_ros.flight.fly import fly_closed_loop as simulate
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.fit import Fit, fit, fitted_vehicle
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.result import Identification
from quad_ident_ros.model.vehicle import Vehicle, write_vehicle
from quad_ident_ros.report.verdict import verdict_line
from quad_ident_ros.vehicle_files.load import load_any_vehicle as load_vehicle

__all__ = [
    'Cancelled', 'diagnose', 'Diagnosis', 'fit', 'Fit', 'fitted_vehicle', 'FlightRecord',
    'identify', 'Identification', 'InputError', 'load_vehicle', 'read', 'SENSORS', 'Settings',
    'simulate', 'titled', 'Vehicle', 'verdict_line', 'write_vehicle',
]
