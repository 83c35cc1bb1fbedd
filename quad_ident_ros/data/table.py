# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A flight record as one Float64MultiArray: labels, sizes and values, without ROS."""

import csv
import io
import json
from typing import Any

import numpy as np

from quad_ident_ros.data.info import unusable_entry
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.schema import shown


def record_table(record: FlightRecord) -> tuple[np.ndarray, tuple[str, str, str]]:
    """
    Return the table (samples, columns, 1) of a flight record and its three labels.

    The label of the second dimension names the columns, as a line of CSV; that of the third is
    the record's provenance as JSON.
    """
    names = ['t', *record.columns]
    line = io.StringIO()
    csv.writer(line, lineterminator='').writerow(names)
    return (record.stack(*names)[:, :, None],
            ('samples', line.getvalue(), json.dumps(record.info)))


def record_from_table(message: Message, where: str = 'topic record') -> FlightRecord:
    """
    Return the flight record of a Float64MultiArray; InputError where it holds none.

    Args: message: an object with the fields of the type; where: what messages call it.
    """
    dims = message.layout.dim
    if len(dims) != 3 or dims[0].size * dims[1].size != len(message.data):
        raise InputError(f'{where}: expected a table samples x columns x 1 as the recorder '
                         'publishes it')
    try:
        names = next(csv.reader([dims[1].label], strict=True), [])
    except csv.Error:
        names = dims[1].label.split(',')
    if len(names) != dims[1].size:
        raise InputError(f'{where}: {dims[1].size} columns but {len(names)} names')
    if len(set(names)) != len(names):
        raise InputError(f'{where}: a column is named twice')
    table = np.reshape(message.data, (dims[0].size, dims[1].size))
    columns = dict(zip(names, table.T.copy(), strict=True))
    info = _info_from(where, dims[2].label)
    if 't' not in columns:
        raise InputError(f'{where}: there is no column t')
    return FlightRecord(columns.pop('t'), columns, info)


def _info_from(where: str, label: str) -> dict[str, Any]:
    try:
        info = json.loads(label or '{}')
    except (ValueError, RecursionError):
        info = None
    if not isinstance(info, dict):
        raise InputError(f'{where}: the label of the third dimension is not a JSON object')
    if name := unusable_entry(info):
        raise InputError(f'{where}: the info {name} of the record is not what it should be: '
                         f'{shown(info[name])}; record or convert the flight again')
    return info
