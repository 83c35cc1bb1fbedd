# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 2: of the recorder, and those of others by a mapping or by their types."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from quad_ident_ros.data.bag_file import BagFile, kind_by_content
from quad_ident_ros.data.foreign import read_mapped_bag
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.readers.bags import topics_of
from quad_ident_ros.data.readers.base import Reader
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.replay import in_recording, is_recorded, read_bag
from quad_ident_ros.model.vehicle import Vehicle

NO_END = ('the bag has no end: its recorder was killed or the disk was full; all whole messages '
          'are read')
SKIPPED = 'damaged parts (chunks) of the bag were left out, with all their messages: {}'


def recognises(path: Path, start: bytes) -> bool:
    """Return whether a path is a bag of ROS 2."""
    return kind_by_content(path, start) in ('folder', '.mcap', '.db3')


def read(path: Path, mapping: Mapping | None = None, vehicle: Vehicle | None = None,
         spoilt: bool = False) -> list[FlightRecord]:
    """Return the flight records in a bag; spoilt: see Reader."""
    if mapping is None and is_recorded(path):
        records = read_bag(path)
    else:
        records = read_mapped_bag(path, mapping or Mapping(), spoilt)
    with BagFile(in_recording(path)) as bag:
        notes = [*([NO_END] if bag.recovered else ()),
                 *([SKIPPED.format(bag.skipped)] if bag.skipped else ())]
    return [_noted(record, notes) for record in records] if notes else records


def _noted(record: FlightRecord, notes: Sequence[str]) -> FlightRecord:
    """Return a record that says more."""
    return replace(record, info={**record.info, 'notes': [*record.info.get('notes', ()), *notes]})


READER = Reader('rosbag2', 'a bag of ROS 2', recognises, read, topics_of,
                suffixes=('.mcap', '.db3'), spoilt=partial(read, spoilt=True))
