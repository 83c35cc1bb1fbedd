# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables in Parquet: columns by a mapping or by guess, as those of text."""

from pathlib import Path

from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.parquet import read_parquet
from quad_ident_ros.data.readers.base import Content, Reader
from quad_ident_ros.data.readers.table import contents_of_table, records_from
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle


def read(path: str | Path, mapping: Mapping | None = None,
         vehicle: Vehicle | None = None) -> list[FlightRecord]:
    """Return the flight records of a Parquet file."""
    path = Path(path)
    return records_from(path, read_parquet(path), mapping)


def contents(path: str | Path) -> list[Content]:
    """Return the one stream of a Parquet file."""
    return contents_of_table(read_parquet(Path(path)), 'Parquet')


READER = Reader('parquet', 'a table in Parquet', lambda path, start: start.startswith(b'PAR1'),
                read, contents, package='pyarrow', module='pyarrow', extra='parquet')
