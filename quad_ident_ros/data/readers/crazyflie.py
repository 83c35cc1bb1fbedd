# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Logs on the micro-SD card of a Crazyflie."""

from pathlib import Path

from quad_ident_ros.data import usdlog
from quad_ident_ros.data.crazyflie import contents, read_crazyflie
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.readers.base import Reader
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle


def read(path: Path, mapping: Mapping | None = None, vehicle: Vehicle | None = None
         ) -> list[FlightRecord]:
    """Return the flight record of a log."""
    return [read_crazyflie(path, mapping)]


READER = Reader('crazyflie', 'a Crazyflie log (micro-SD card)',
                lambda path, start: usdlog.recognises(start), read, contents)
