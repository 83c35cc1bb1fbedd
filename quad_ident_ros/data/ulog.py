# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records from the logs of PX4 (ULog)."""

import contextlib
import io
from pathlib import Path

import numpy as np
from pyulog import ULog

from quad_ident_ros.data import frames
from quad_ident_ros.data.mapping import KINDS, Mapping, rotor_speeds
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.data.streams import HELD, INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.errors import InputError

TOPICS = ('vehicle_attitude', 'vehicle_local_position', 'vehicle_angular_velocity',
          'vehicle_acceleration', 'sensor_combined', 'actuator_outputs', 'actuator_motors',
          'battery_status')

_MOST_BYTES = 0xffff   # of one message, whose length is 16 bits
_LATEST = 2 ** 63 // 1000 - 1   # us, of a stamp that fits into ns


def read_ulog(path, mapping=None, vehicle=None):
    """
    Return the FlightRecord of a PX4 log, in ENU and FLU.

    The time base is that of the actuator outputs, which become cmd1..N where the mapping says how
    (actuators), and stay output1..N as they are where it does not; without outputs it is that of
    the attitude. The estimator's stamps of samples are used where the log has them.
    Args: path; mapping Mapping or None; vehicle Vehicle or None.
    Raises InputError that names file and topic.
    """
    path, mapping = Path(path), mapping or Mapping()
    if mapping.topics or mapping.world != 'ENU' or mapping.body != 'FLU':
        raise InputError(f'{path}: the topics and frames of a PX4 log are known; of a mapping '
                         'only instances and actuators hold for it')
    log = _parse(path)
    for topic in mapping.instances:
        if topic not in TOPICS:
            raise InputError(f'{path}: instances: {topic!r} is not read; name one of '
                             f'{", ".join(TOPICS)}')
    data = {name: _instance(path, log, name, mapping.instances.get(name)) for name in TOPICS}
    streams = [_attitude(path, data), _position(path, data), _rate(path, data),
               _specific_force(path, data), _battery(path, data),
               _outputs(path, data, mapping.actuators, vehicle)]
    streams = [stream for stream in streams if stream is not None]
    start, t, columns, notes = join(path, streams)
    notes = [*(['parts of the log are damaged and left out'] if log.file_corruption else []),
             *([f'{len(log.dropouts)} dropouts while logging'] if log.dropouts else []), *notes]
    return FlightRecord(t, columns, {'name': path.stem, 'source': str(path), 'start_ns': start,
                                     'notes': notes})


class _Content(io.BytesIO):
    """
    Bytes that may be read a few times over, and no more.

    Where a log is damaged the parser looks for the next message by going back, at times for ever.
    """

    def __init__(self, data):
        super().__init__(data)
        self._left = 8 * len(data) + 100_000

    def read(self, size=-1):
        """Return the next bytes; _Damaged where they have been read too often."""
        data = super().read(size)
        self._left -= max(len(data), 16)
        if self._left < 0:
            raise _Damaged('it is damaged beyond what can be skipped')
        return data


class _Damaged(Exception):
    """The parser does not get on."""


class _Log(ULog):
    """A ULog that does not expand formats too large for any message."""

    class _MessageAddLogged(ULog._MessageAddLogged):
        def _parse_format(self, formats):
            if _size(self.message_name, formats, 0) > _MOST_BYTES:
                raise ValueError(f'format {self.message_name} is too large')
            super()._parse_format(formats)


def _size(name, formats, depth):
    """Return the bytes of a message of a format, of many more where it nests without end."""
    if depth > 8:
        return _MOST_BYTES + 1
    total = 0
    for kind, count, _ in formats[name].fields:
        one = (ULog.get_field_size(kind) if kind in ULog._UNPACK_TYPES
               else _size(kind, formats, depth + 1))
        total += one * max(count, 1)
        if total > _MOST_BYTES:
            break
    return total


def _parse(path):
    try:
        with open(path, 'rb') as file:
            content = _Content(file.read())
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    try:
        # It prints what it finds damaged; that is kept in file_corruption.
        with contextlib.redirect_stdout(io.StringIO()):
            return _Log(content, list(TOPICS))
    except Exception as error:  # a damaged log makes the parser raise anything
        reason = ' '.join(str(error).split())[:200] or type(error).__name__
        raise InputError(f'{path}: this log cannot be read ({reason}); download it from '
                         'the vehicle again') from None


def _instance(path, log, name, number):
    """Return name -> values of one instance of a topic, the first if none is named, or None."""
    found = {data.multi_id: data.data for data in log.data_list if data.name == name}
    if number is None:
        return found[min(found)] if found else None
    if number not in found:
        raise InputError(f'{path}: instances: there is no {name} {number}; the log has: '
                         f'{", ".join(map(str, sorted(found))) or "none"}')
    return found[number]


def _values(path, topic, data, names):
    """Return the fields of a topic, (N, k)."""
    missing = [name for name in names if name not in data]
    if missing:
        raise InputError(f'{path}, topic {topic}: there is no field {missing[0]}; this is no log '
                         'of PX4 1.11 or later')
    with np.errstate(invalid='ignore'):   # nan of a kind that signals
        return np.stack([np.asarray(data[name], float) for name in names], axis=-1)


def _stamps(path, topic, data):
    """Return the stamps of a topic's samples, ns."""
    name = 'timestamp'
    if 'timestamp_sample' in data and np.all(data['timestamp_sample'] > 0):
        name = 'timestamp_sample'
    stamps = _values(path, topic, data, [name])[:, 0]
    if not (np.isfinite(stamps).all() and (stamps >= 0).all() and (stamps < _LATEST).all()):
        k = int(np.argmin(np.isfinite(stamps) & (stamps >= 0) & (stamps < _LATEST)))
        raise InputError(f'{path}, topic {topic}, message {k + 1}: the stamp {stamps[k]:g} us is '
                         'no time; the log is damaged')
    return np.asarray(data[name]).astype(np.int64) * 1000


def _indexed(name, count):
    return [f'{name}[{k}]' for k in range(count)]


def _stream(path, topic, data, names, values, between=INTERPOLATED):
    return Stream(f'topic {topic}', _stamps(path, topic, data),
                  dict(zip(names, values.T, strict=True)), between)


def _attitude(path, data):
    topic = 'vehicle_attitude'
    if data[topic] is None:
        raise InputError(f'{path}: has no topic {topic}; log it (SDLOG_PROFILE, default set)')
    q = _values(path, topic, data[topic], _indexed('q', 4))
    with np.errstate(all='ignore'):
        norm = np.linalg.norm(q, axis=-1, keepdims=True)
        q = np.where(norm > 1e-3, q / norm, np.nan)
    return _stream(path, topic, data[topic], QUATERNION, frames.attitude(q, 'NED', 'FRD'))


def _position(path, data):
    topic = 'vehicle_local_position'
    if data[topic] is None:
        return None
    values = _values(path, topic, data[topic], ('x', 'y', 'z', 'vx', 'vy', 'vz'))
    both = [frames.world_vector(values[:, part], 'NED') for part in (slice(3), slice(3, 6))]
    return _stream(path, topic, data[topic], ('px', 'py', 'pz', 'vx', 'vy', 'vz'),
                   np.hstack(both))


def _rate(path, data):
    for topic, field in (('vehicle_angular_velocity', 'xyz'), ('sensor_combined', 'gyro_rad')):
        if data[topic] is not None:
            values = _values(path, topic, data[topic], _indexed(field, 3))
            return _stream(path, topic, data[topic], ('wx', 'wy', 'wz'),
                           frames.body_vector(values, 'FRD'))
    return None


def _specific_force(path, data):
    for topic, field in (('vehicle_acceleration', 'xyz'),
                         ('sensor_combined', 'accelerometer_m_s2')):
        if data[topic] is not None:
            values = _values(path, topic, data[topic], _indexed(field, 3))
            return _stream(path, topic, data[topic], ('ax', 'ay', 'az'),
                           frames.body_vector(values, 'FRD'))
    return None


def _battery(path, data):
    topic = 'battery_status'
    if data[topic] is None:
        return None
    voltage = _values(path, topic, data[topic], ['voltage_v'])
    if np.isfinite(voltage).sum() < 2:
        return None   # a short log of a slow topic
    return _stream(path, topic, data[topic], ('vbat',), voltage, SLOW)


def _outputs(path, data, actuators, vehicle):
    """Return the stream of commands, from the topic that fits the kind of the outputs."""
    choices = {'actuator_outputs': 'output', 'actuator_motors': 'control'}
    if actuators is not None and actuators.kind == 'normalised':
        choices = {'actuator_motors': 'control'}
    topic = next((name for name in choices if data[name] is not None), None)
    if topic is None:
        if actuators is not None:
            raise InputError(f'{path}: has no topic {" or ".join(choices)} for outputs of kind '
                             f'{actuators.kind}; log it, or name another of '
                             f'{", ".join(KINDS)}')
        return None
    found, field = data[topic], choices[topic]
    count = sum(name.startswith(f'{field}[') for name in found)
    values = _values(path, topic, found, _indexed(field, max(count, 1)))
    if actuators is not None:
        values, name = rotor_speeds(f'{path}, topic {topic}', values, actuators, vehicle), 'cmd'
    else:
        values = values[:, np.isfinite(values).any(axis=0)]
        values, name = np.where(np.isfinite(values), values, 0.0), 'output'
    return _stream(path, topic, found, [f'{name}{k + 1}' for k in range(values.shape[1])], values,
                   HELD)
