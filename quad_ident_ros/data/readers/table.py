# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of text, plain or gzip: flight records as CSV."""

from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.readers.base import Content, content_of, Reader
from quad_ident_ros.data.record import unit
from quad_ident_ros.errors import InputError

ROLES = {'px': 'pose', 'vx': 'velocity', 'wx': 'rate', 'ax': 'specific_force', 'cmd1': 'commands',
         'rotor1': 'rotors', 'vbat': 'battery'}


def read(path, mapping=None, vehicle=None):
    """Return the flight record of a CSV file."""
    if mapping is not None:
        raise InputError(f'{path}: a mapping is for bags and logs; the columns of a CSV file have '
                         'the names of the flight record, see docs/records.md')
    return [read_csv(path)]


def contents(path):
    """Return the one stream of a CSV file."""
    record = read_csv(path)
    fields = [name if unit(name) is None else f'{name} ({unit(name)})'
              for name in record.columns]
    stamps = ((record.t - record.t[0]) * 1e9).round().astype('int64')
    roles = [role for column, role in ROLES.items() if record.has(column)]
    found: list[Content] = [content_of('rows', 'CSV', stamps, 0, fields, roles)]
    return found


READER = Reader('csv', 'a table of text (CSV)', lambda path, start: False, read, contents)
"""Told last, by what no other kind is."""
