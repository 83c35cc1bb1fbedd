# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of tables, with labelled dimensions, and of diagnostics; names of types."""

from array import array

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
import numpy as np
from std_msgs.msg import Float64MultiArray, MultiArrayDimension

from quad_ident_ros.data.table import record_table
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
    """Return the message of a flight record, as data.table lays it out."""
    table, labels = record_table(record)
    return table_message(table, *labels)


def type_name(message_class):
    """Return the name of the type of a class of messages, package/msg/Name."""
    return f'{message_class.__module__.partition(".")[0]}/msg/{message_class.__name__}'


def diagnostics_message(node, level, text, values):
    """Return a DiagnosticArray with one status of a node; values is a dict."""
    status = DiagnosticStatus(level=level, name=node.get_fully_qualified_name().strip('/'),
                              hardware_id='quad_ident_ros', message=text)
    status.values = [KeyValue(key=str(key), value=str(value)) for key, value in values.items()]
    message = DiagnosticArray(status=[status])
    message.header.stamp = node.get_clock().now().to_msg()
    return message


OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
