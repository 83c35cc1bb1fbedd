# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 2: of the recorder, and with a mapping those of others."""

from quad_ident_ros.data.foreign import read_mapped_bag
from quad_ident_ros.data.readers.base import Reader
from quad_ident_ros.data.replay import read_bag
from quad_ident_ros.errors import InputError

MAGIC = {b'\x89MCAP0\r\n': '.mcap', b'SQLite format 3\0': '.db3'}   # how they begin


def tells(path, start):
    """Return whether a path is a bag; InputError where its name keeps it from being read."""
    for magic, suffix in MAGIC.items():
        if start.startswith(magic) and path.suffix != suffix:
            raise InputError(f'{path}: this is a bag, and is read under a name that ends in '
                             f'{suffix}; rename it')
    return path.is_dir() or path.suffix in MAGIC.values()


def read(path, mapping=None, vehicle=None):
    """Return the flight records in a bag."""
    return [read_mapped_bag(path, mapping, vehicle)] if mapping else read_bag(path)


def contents(path):
    """Return the topics of a bag."""
    raise NotImplementedError


READER = Reader('rosbag2', 'a bag of ROS 2', tells, read, contents)
