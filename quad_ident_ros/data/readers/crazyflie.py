# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Logs on the micro-SD card of a Crazyflie."""

from quad_ident_ros.data import usdlog
from quad_ident_ros.data.crazyflie import contents, read_crazyflie
from quad_ident_ros.data.readers.base import Reader


def read(path, mapping=None, vehicle=None):
    """Return the flight record of a log."""
    return [read_crazyflie(path, mapping)]


READER = Reader('crazyflie', 'a Crazyflie log (micro-SD card)',
                lambda path, start: usdlog.recognises(start), read, contents)
