# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Blackbox logs of Betaflight (.bbl, .bfl, .txt)."""

from quad_ident_ros.data.betaflight import contents, read_betaflight
from quad_ident_ros.data.blackbox import MAGIC
from quad_ident_ros.data.readers.base import Reader

READER = Reader('betaflight', 'a blackbox log of Betaflight',
                lambda path, start: start.startswith(MAGIC),
                lambda path, mapping, vehicle: read_betaflight(path, mapping), contents,
                package='orangebox', module='orangebox', extra='betaflight')
