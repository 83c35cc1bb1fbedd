# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An input taken from a recorded flight."""

from pathlib import Path

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.errors import InputError


def recorded(t, file, column, trim=0.0):
    """
    Return a column of a flight record (.csv, .csv.gz), held between its samples, minus trim.

    The record's clock is set to begin at t[0]; after its last sample it keeps the last value.
    Raises InputError for a file or column that cannot be read, which says nothing of what is in a
    file that is no record: an experiment of others may name any.
    """
    for name, value in (('file', file), ('column', column)):
        if not isinstance(value, str):
            raise InputError(f'{name}: expected text, got {schema.shown(value)}')
    if not Path(file).exists():
        raise InputError(f'file: {file}: there is no such file')
    try:
        record = read_csv(file) if Path(file).is_file() else None
    except (InputError, OSError):
        record = None
    if record is None:
        raise InputError(f'file: {schema.shown(file)} is not a flight record that can be read '
                         '(.csv, .csv.gz); quad_ident info FILE says why')
    values = record.stack(column)[:, 0] - schema.number('trim', trim)
    index = np.searchsorted(record.t - record.t[0], t - t[0] + 5e-10, side='right') - 1
    return values[index]
