# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 2: of the recorder, and those of others by a mapping or by their types."""

from quad_ident_ros.data.bag_file import told_kind
from quad_ident_ros.data.foreign import read_mapped_bag
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.readers.bags import topics_of
from quad_ident_ros.data.readers.base import Reader
from quad_ident_ros.data.replay import is_recorded, read_bag


def tells(path, start):
    """Return whether a path is a bag of ROS 2."""
    return told_kind(path, start) in ('folder', '.mcap', '.db3')


def read(path, mapping=None, vehicle=None):
    """Return the flight records in a bag."""
    if mapping is None and is_recorded(path):
        return read_bag(path)
    return read_mapped_bag(path, mapping or Mapping())


READER = Reader('rosbag2', 'a bag of ROS 2', tells, read, topics_of,
                suffixes=('.mcap', '.db3'))
