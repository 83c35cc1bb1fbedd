# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages that carry tables: flight records and fitted parameters, with labelled dimensions."""

from array import array
import json

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
import numpy as np
from std_msgs.msg import Float64MultiArray, MultiArrayDimension

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.signals import OUTPUTS

PARAMETER_COLUMNS = ('K', 'a', 'b')


def table_message(table, *labels):
    """Return a Float64MultiArray of an array whose dimensions carry the labels."""
    table = np.ascontiguousarray(table, float)
    message = Float64MultiArray()
    stride = table.size
    for label, size in zip(labels, table.shape, strict=True):
        message.layout.dim.append(MultiArrayDimension(label=label, size=size, stride=stride))
        stride //= max(size, 1)
    # array('d') is what the field holds; assigning a NumPy array or list is 50 times slower.
    values = array('d')
    values.frombytes(table.tobytes())
    message.data = values
    return message


def parameter_message(table):
    """Return the message of K, a, b (4, 3) in the order phi, theta, psi, z."""
    return table_message(table, ','.join(OUTPUTS), ','.join(PARAMETER_COLUMNS))


def record_message(record):
    """
    Return the message of a flight record: samples x columns x 1.

    The label of the second dimension names the columns, that of the third is the record's
    provenance as JSON.
    """
    names = ['t', *record.columns]
    table = record.stack(*names)[:, :, None]
    return table_message(table, 'samples', ','.join(names), json.dumps(record.info))


def record_from_message(message):
    """Return the flight record of a message; raises InputError where it holds none."""
    dims = message.layout.dim
    if len(dims) != 3 or dims[0].size * dims[1].size != len(message.data):
        raise InputError('topic record: expected a table samples x columns x 1 as the recorder '
                         'publishes it')
    names = dims[1].label.split(',')
    if len(names) != dims[1].size:
        raise InputError(f'topic record: {dims[1].size} columns but {len(names)} names')
    if len(set(names)) != len(names):
        raise InputError('topic record: a column is named twice')
    table = np.reshape(message.data, (dims[0].size, dims[1].size))
    columns = dict(zip(names, table.T.copy(), strict=True))
    info = _info_from(dims[2].label)
    if 't' not in columns:
        raise InputError('topic record: there is no column t')
    return FlightRecord(columns.pop('t'), columns, info)


def _info_from(label):
    try:
        info = json.loads(label or '{}')
    except (ValueError, RecursionError):
        info = None
    if not isinstance(info, dict):
        raise InputError('topic record: the label of the third dimension is no JSON object')
    for name in ('run_index', 'run_count'):
        if not isinstance(info.get(name, 0), int):
            raise InputError(f'topic record: {name} is no whole number')
    return info


def diagnostics_message(node, level, text, values):
    """Return a DiagnosticArray with one status of a node; values is a dict."""
    status = DiagnosticStatus(level=level, name=node.get_fully_qualified_name().strip('/'),
                              hardware_id='quad_ident_ros', message=text)
    status.values = [KeyValue(key=str(key), value=str(value)) for key, value in values.items()]
    message = DiagnosticArray(status=[status])
    message.header.stamp = node.get_clock().now().to_msg()
    return message


OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
