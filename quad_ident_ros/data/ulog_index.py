# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is in a ULog, by one pass over the heads of its messages."""

from pathlib import Path
import re

import numpy as np

from quad_ident_ros.data.readers.base import Content, content_of
from quad_ident_ros.data.ulog_walk import FORMAT, Messages, rows_of, START, SUBSCRIPTION, walk
from quad_ident_ros.errors import InputError

ROLES = {
    'vehicle_attitude': ('attitude',), 'estimator_attitude': ('attitude',),
    'vehicle_local_position': ('position', 'velocity'),
    'estimator_local_position': ('position', 'velocity'),
    'vehicle_odometry': ('pose', 'velocity', 'rate'), 'vehicle_angular_velocity': ('rate',),
    'sensor_combined': ('rate', 'specific_force'), 'vehicle_acceleration': ('specific_force',),
    'actuator_motors': ('commands',), 'actuator_outputs': ('commands',),
    'esc_status': ('rotors',), 'battery_status': ('battery',)}

_MOST_STREAMS = 4096    # logs have some 200; a damaged one may define any number
_LATEST = 2 ** 63 // 1000 - 1   # us, of a stamp that fits into ns
_BEFORE = 60 * 10 ** 9   # ns that a message may be older than the log
_FIELD = re.compile(r'([A-Za-z0-9_]+(?:\[\d+\])?) ([A-Za-z0-9_]+)')


def contents(path: str | Path) -> list[Content]:
    """
    Return the Content of each topic of a ULog.

    A log that is damaged is read up to where it is. Raises InputError for no ULog.
    """
    path = Path(path)
    try:
        with open(path, 'rb') as file:
            data = file.read()
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    if len(data) < START or not data.startswith(b'ULog\x01\x12\x35'):
        raise InputError(f'{path}: this is not a complete log of PX4; download it from the '
                         'vehicle again')
    origin = int.from_bytes(data[8:16], 'little')
    messages = walk(data)
    formats, streams = _declared(data, messages)
    origin_ns = min(origin, _LATEST) * 1000
    found = []
    for number, (instance, name) in streams.items():
        times = _stamps(data, messages, number)
        times = times[times <= _LATEST].astype(np.int64) * 1000
        if not len(times):
            continue
        # Messages from before the clock was set, such as parameters, stand at the start.
        lately = times >= origin_ns - _BEFORE
        times = times[lately] if lately.any() else np.full(len(times), origin_ns)
        label = name if instance == 0 else f'{name} {instance}'
        found.append(content_of(label, name, times, origin_ns, formats.get(name, ()),
                                ROLES.get(name, ())))
    return sorted(found, key=lambda content: (not content.roles, content.name))


def _declared(data: bytes, messages: Messages
              ) -> tuple[dict[str, tuple[str, ...]], dict[int, tuple[int, str]]]:
    """Return formats (name -> fields) and streams (number -> instance, name) of a log's bytes."""
    formats: dict[str, tuple[str, ...]] = {}
    streams: dict[int, tuple[int, str]] = {}
    for kind, at, size in messages.others:
        if kind == FORMAT and len(formats) < _MOST_STREAMS:
            name, _, fields = data[at:at + size].decode('ascii', 'replace').partition(':')
            formats[name] = tuple(f'{field}{kind[kind.index("["):] if "[" in kind else ""}'
                                  for kind, field in _FIELD.findall(fields)
                                  if not field.startswith('_padding'))
        elif kind == SUBSCRIPTION and size > 3 and len(streams) < _MOST_STREAMS:
            instance, number = data[at], int.from_bytes(data[at + 1:at + 3], 'little')
            name = data[at + 3:at + size].decode('ascii', 'replace')
            if name.isprintable():
                streams[number] = instance, name
    return formats, streams


def _stamps(data: bytes, messages: Messages, number: int) -> np.ndarray:
    """Return the stamps of a stream, us, uint64."""
    begins = messages.data[(messages.numbers == number) & (messages.sizes >= 10)]
    return rows_of(data, begins + 2, 8).view('<u8')[:, 0]
