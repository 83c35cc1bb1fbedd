# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the records of a recorder go: one topic for each of its windows."""

from dataclasses import dataclass
import re

from std_msgs.msg import Float64MultiArray

from quad_ident_ros import schema
from quad_ident_ros.data.buffer import Limits, RecordBuffer
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.qos import latched

RECORD = 'record'
KEPT_RECORDS = 16    # records that a late identifier still gets
NEWS = 10.0          # s between two lines of log on windows that slide
TOPIC = re.compile(r'[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*')


@dataclass(frozen=True)
class Window:
    """A further window: the topic of its records, its length (s) and its overlap (a share)."""

    topic: str
    seconds: float
    overlap: float


def windows_of(entries):
    """
    Return the Windows of the parameter windows, each TOPIC=SECONDS or TOPIC=SECONDS,OVERLAP.

    Raises InputError where one is invalid or two have the same topic.
    """
    found = []
    for entry in entries:
        where = f'parameter windows: {entry!r}'
        topic, _, numbers = entry.partition('=')
        words = numbers.split(',')
        try:
            seconds, overlap = float(words[0]), float(words[1]) if len(words) > 1 else 0.0
        except ValueError:
            raise InputError(f'{where}: expected TOPIC=SECONDS or TOPIC=SECONDS,OVERLAP, for '
                             'example record_long=30,0.5') from None
        if len(words) > 2 or not TOPIC.fullmatch(topic):
            raise InputError(f'{where}: expected TOPIC=SECONDS,OVERLAP with the name of a topic '
                             'in letters, digits and _')
        schema.number(f'{where}: seconds', seconds, 0.01, 1e6)
        schema.number(f'{where}: overlap', overlap, 0.0, 0.999)
        found.append(Window(topic, seconds, overlap))
    topics = [RECORD, *(window.topic for window in found)]
    for topic in topics:
        if topics.count(topic) > 1:
            raise InputError(f'parameter windows: two windows have the topic {topic}; '
                             f'{RECORD} is that of window_seconds and window_samples')
    return tuple(found)


class Outlet:
    """
    A window of the joined rows, and the topic on which its records go out.

    Args: node; topic; columns as of RecordBuffer; limits Limits of the window.
    """

    def __init__(self, node, topic, columns, limits):
        self.buffer = RecordBuffer(columns, limits)
        self.count = 0
        self._logger, self._name = node.get_logger(), topic
        self._publisher = node.create_publisher(Float64MultiArray, topic, latched(KEPT_RECORDS))

    def publish(self, records, more):
        """Publish records with more of what there is to say of them in their info."""
        for record in records:
            self.count += 1
            info = {**record.info, **more}
            self._publisher.publish(record_message(
                type(record)(record.t, record.columns, info)))
            text = (f'{self._name} {self.count}: {len(record)} samples'
                    f'{" of " + info["name"] if "name" in info else ""}, '
                    f'{record.info["dropped"]} missing')
            if self.buffer.limits.overlap:
                self._logger.info(text, throttle_duration_sec=NEWS)
            else:
                self._logger.info(text)


def outlets_of(node, columns, parameters):
    """
    Return the Outlets of a recorder's parameters, that of `record` first.

    Raises InputError where a remapping gives two of them one topic.
    """
    most = parameters['window_samples']
    windows = windows_of(parameters['windows'])
    names = [node.resolve_topic_name(name)
             for name in (RECORD, *(window.topic for window in windows))]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f'parameter windows: two windows of this node have the topic {name} '
                             'by a remapping (-r); give each a name of its own')
    return (Outlet(node, RECORD, columns,
                   Limits(most, parameters['window_seconds'], parameters['overlap'])),
            *(Outlet(node, window.topic, columns, Limits(most, window.seconds, window.overlap))
              for window in windows))
