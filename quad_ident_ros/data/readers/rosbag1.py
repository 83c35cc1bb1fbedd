# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 1, by a mapping or by the types of their topics."""

from functools import partial
from pathlib import Path

from quad_ident_ros.data.bag_file import kind_by_content
from quad_ident_ros.data.foreign import read_mapped_bag
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.readers.bags import topics_of
from quad_ident_ros.data.readers.base import Reader
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle


def recognises(path: Path, start: bytes) -> bool:
    """Return whether a path is a bag of ROS 1."""
    return kind_by_content(path, start) == '.bag'


def read(path: Path, mapping: Mapping | None = None, vehicle: Vehicle | None = None,
         spoilt: bool = False) -> list[FlightRecord]:
    """Return the flight records in a bag; spoilt: see Reader."""
    return read_mapped_bag(path, mapping or Mapping(), spoilt)


READER = Reader('rosbag1', 'a bag of ROS 1', recognises, read, topics_of, suffixes=('.bag',),
                spoilt=partial(read, spoilt=True))
