# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Results with the time of the data, in messages that PlotJuggler and Foxglove draw."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Vector3Stamped

from quad_ident_ros.identify.result import error_table, parameter_table
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.nodes.qos import latched

KEPT_CHANGES = 10   # changes that a late subscriber still gets


class Vectors:
    """Publishers of Vector3Stamped, latched, by the names of their topics."""

    def __init__(self, node, names):
        self._publishers = {name: node.create_publisher(Vector3Stamped, name, latched())
                            for name in names}

    def publish(self, name, stamp_ns, values):
        """Publish three numbers with a stamp, ns."""
        message = Vector3Stamped()
        _set_stamp(message.header, stamp_ns)
        message.vector.x, message.vector.y, message.vector.z = map(float, values)
        self._publishers[name].publish(message)


class StampedParameters:
    """
    K, a, b of each output and their standard errors, and changes as events.

    The stamp is that of the last sample which was fitted, that of a change when it was.
    """

    def __init__(self, node):
        self._vectors = Vectors(node, [f'outputs/{name}{more}' for name in OUTPUTS
                                       for more in ('', '/standard_errors')])
        self._events = node.create_publisher(DiagnosticArray, 'change', latched(KEPT_CHANGES))
        self._node = node

    def publish(self, result):
        """Publish what an Identification found of the outputs that were excited."""
        best = result.methods[result.best]
        rows = zip(OUTPUTS, parameter_table(best), error_table(best), strict=True)
        for name, values, errors in rows:
            if name not in best.outputs or best.outputs[name].model is None:
                continue
            signal = result.signals[name]
            stamp = self._now() if signal.start_ns is None else (
                signal.start_ns + round(1e9 * (signal.t[-1] - signal.t[0])))
            self._vectors.publish(f'outputs/{name}', stamp, values)
            self._vectors.publish(f'outputs/{name}/standard_errors', stamp, errors)
        for change in result.changes:
            self._events.publish(change_message(change, self._node))

    def _now(self):
        return self._node.get_clock().now().nanoseconds


def change_message(change, node):
    """Return the event of a Change: its stamp, its output, and what moved, before and after."""
    moved = ', '.join(f'{name} {values[0]:.4g} -> {values[1]:.4g}'
                      for name, values in change.moved.items())
    status = DiagnosticStatus(level=DiagnosticStatus.WARN, name=change.output,
                              hardware_id=node.get_fully_qualified_name().strip('/'),
                              message=f'{change.output} changed: {moved}')
    status.values = [KeyValue(key=f'{name}/{when}', value=repr(float(value)))
                     for name, values in change.moved.items()
                     for when, value in zip(('before', 'after'), values, strict=True)]
    message = DiagnosticArray(status=[status])
    _set_stamp(message.header, change.stamp_ns)
    return message


class StampedGap:
    """
    The gap of each group before, after and of noise, and the shares of forces and moments.

    The stamp is that of the last sample that was diagnosed.
    """

    def __init__(self, node, groups):
        self._vectors = Vectors(node, [*(f'gap/{name}' for name in groups), 'where/force',
                                       'where/moment'])

    def publish(self, stamp_ns, gap, shares):
        """Publish a Gap, and {channel: share}."""
        for name in gap.units:
            self._vectors.publish(f'gap/{name}', stamp_ns,
                                  [stage[name] for stage in (gap.before, gap.after, gap.noise)])
        for name, kind in (('force', 'F'), ('moment', 'M')):
            self._vectors.publish(f'where/{name}', stamp_ns,
                                  [shares.get(kind + axis, 0.0) for axis in 'xyz'])


def _set_stamp(header, stamp_ns):
    header.stamp.sec, header.stamp.nanosec = divmod(int(stamp_ns), 1_000_000_000)
