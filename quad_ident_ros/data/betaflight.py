# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Flight records from the blackbox logs of Betaflight.

Its body axes are forward, left, up, as here; its world is north, west, up. Source: Betaflight's
imu.c and blackbox.c, and the units of its log viewer.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
import re
import struct
from typing import Any

import numpy as np

from quad_ident_ros.data.autopilot import known_names, outputs_stream
from quad_ident_ros.data.blackbox import Log, read_logs
from quad_ident_ros.data.mapping import Actuators, Mapping
from quad_ident_ros.data.motor_order import about_motors, quad
from quad_ident_ros.data.readers.base import Content, content_of
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.data.streams import INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.errors import InputError
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.attitude import product


def _three(name: str) -> tuple[str, ...]:
    return tuple(f'{name}[{k}]' for k in range(3))


GYRO, ACCELEROMETER, ATTITUDE = _three('gyroADC'), _three('accSmooth'), _three('imuQuaternion')
MOTORS = tuple(f'motor[{k}]' for k in range(8))
SPEEDS = tuple(f'eRPM[{k}]' for k in range(8))
ROLES = {'gyroADC[0]': 'rate', 'accSmooth[0]': 'specific_force', 'imuQuaternion[0]': 'attitude',
         'motor[0]': 'commands', 'eRPM[0]': 'rotors', 'vbatLatest': 'battery'}
ORDER = "motors are in Betaflight's order: 1 rear right, 2 front right, 3 rear left, 4 front left"

QUAD_X = quad((-1, -1), (1, -1), (-1, 1), (1, 1))

_KINDS = {2047: 'dshot', 2000: 'pwm'}       # by the highest output of the header
_WANTED = (*GYRO, *ACCELEROMETER, *ATTITUDE, *MOTORS, *SPEEDS, 'vbatLatest')
_HALF = np.sqrt(0.5)
_ENU_FROM_NWU = np.array([_HALF, 0.0, 0.0, _HALF])      # a quarter of a turn about z
_REVISION = re.compile(r'Betaflight ([0-9]{1,4})\.([0-9]{1,4})')


def read_betaflight(path: str | Path, mapping: Mapping | None = None) -> list[FlightRecord]:
    """
    Return the FlightRecords of a blackbox file, one for each of its logs, in ENU and FLU.

    The outputs to the motors are output1..N, as motorOutput counts them. No field is required.
    Args: path; mapping Mapping or None.
    Raises InputError that names file and log.
    """
    path = Path(path)
    mapping = known_names(path, 'a blackbox log', mapping)
    logs = read_logs(path, _WANTED)
    return [_record(path, log, len(logs), mapping.actuators) for log in logs]


def contents(path: str | Path) -> list[Content]:
    """Return the Content of each log in a blackbox file; errors of read_logs."""
    return [content_of(f'log {log.number}', str(log.headers.get('Firmware revision',
                                                                'blackbox'))[:60],
                       _stamps(log), int(_stamps(log).min()), log.fields,
                       [role for field, role in ROLES.items() if field in log.fields])
            for log in read_logs(path, ())]


def _record(path: Path, log: Log, count: int, actuators: Actuators | None) -> FlightRecord:
    where = str(path) if count == 1 else f'{path}, log {log.number}'
    if str(log.headers.get('Firmware type', '')).startswith('Rotorflight'):
        raise InputError(f'{where}: this is a log of Rotorflight, of a helicopter, which is not '
                         'a multirotor; give a log of Betaflight')
    notes = list(log.notes)
    read = [_attitude(log), _rate(log, notes), _specific_force(log, notes), _rotors(log, notes),
            _battery(log, notes)]
    motors = [name for name in MOTORS if name in log.values]
    kind = ''
    if motors:
        read.append(outputs_stream('motor', _stamps(log), _stack(log, motors)))
        notes += [ORDER] if len(motors) == 4 else []
        span = log.headers.get('motorOutput')
        if isinstance(span, list) and len(span) == 2:
            notes.append(f'outputs to the motors are from {span[0]} to {span[1]}'[:100])
            kind = _KINDS.get(span[1], '')
    elif actuators is not None:
        raise InputError(f'{where}: has no field motor[0] for the actuators of the mapping; log '
                         'it, or leave actuators out')
    streams = [stream for stream in read if stream is not None]
    if not any(set(stream.columns) - {'vbat'} for stream in streams):
        raise InputError(f'{where}: has none of the fields gyroADC, accSmooth and motor; log them')
    start, t, columns, left_out = join(where, streams)
    name = path.stem if count == 1 else f'{path.stem}_{log.number}'
    return FlightRecord(t, columns, {'name': name, 'source': where, 'start_ns': start,
                                     'notes': [*notes, *left_out],
                                     'motors': about_motors(QUAD_X if len(motors) == 4 else (),
                                                            "Betaflight's order, quad X", kind),
                                     'hardware': {
                                         key: str(log.headers[name]) for key, name in
                                         (('board', 'Board information'), ('craft', 'Craft name'))
                                         if log.headers.get(name)}})


def _stamps(log: Log) -> np.ndarray:
    return log.values['time'].astype(np.int64) * 1000


def _stack(log: Log, names: Sequence[str]) -> np.ndarray:
    return np.stack([log.values[name] for name in names], axis=-1)


def _stream(log: Log, source: str, columns: Sequence[str], values: np.ndarray,
            between: str = INTERPOLATED) -> Stream:
    return Stream(source, _stamps(log), dict(zip(columns, values.T, strict=True)), between)


def _there(log: Log, names: Iterable[str]) -> bool:
    return all(name in log.values for name in names)


def _number(log: Log, name: str) -> float | None:
    """Return a header as a positive float, or None."""
    value: Any = log.headers.get(name)
    try:
        value = float(value)
    except (OverflowError, TypeError, ValueError):
        return None
    return value if 0.0 < value < 1e12 else None


def _rate(log: Log, notes: list[str]) -> Stream | None:
    if not _there(log, GYRO):
        return None
    raw = log.headers.get('gyro_scale', log.headers.get('gyro.scale'))
    scale = None
    if isinstance(raw, int) and 0 < raw < 2 ** 32:      # the bits of a float
        scale = struct.unpack('<f', struct.pack('<I', raw))[0]
    if scale is None or not 1e-12 < scale < 1e3:
        notes.append('gyroADC: the header has no gyro_scale; the values are taken for deg/s')
        scale = 1.0
    if scale < 1e-6:        # rad/us, of Baseflight; deg/s are 0.06 to 1
        scale = np.degrees(scale * 1e6)
    if _number(log, 'blackbox_high_resolution'):
        scale /= 10.0
    return _stream(log, 'gyroADC', ('wx', 'wy', 'wz'), np.radians(scale * _stack(log, GYRO)))


def _specific_force(log: Log, notes: list[str]) -> Stream | None:
    if not _there(log, ACCELEROMETER):
        return None
    one = _number(log, 'acc_1G')
    if one is None:
        notes.append('accSmooth: the header has no acc_1G, so it is left out')
        return None
    force = _stack(log, ACCELEROMETER) * (GRAVITY / one)
    return _stream(log, 'accSmooth', ('ax', 'ay', 'az'), force)


def _attitude(log: Log) -> Stream | None:
    if not _there(log, ATTITUDE):
        return None
    vector = _stack(log, ATTITUDE) / 32767.0
    real = np.sqrt(np.maximum(1.0 - np.sum(vector ** 2, axis=-1, keepdims=True), 0.0))
    q = np.hstack([real, vector])
    q = product(_ENU_FROM_NWU, q / np.linalg.norm(q, axis=-1, keepdims=True))
    return _stream(log, 'imuQuaternion', QUATERNION, q)


def _rotors(log: Log, notes: list[str]) -> Stream | None:
    names = [name for name in SPEEDS if name in log.values]
    if not names:
        return None
    poles = _number(log, 'motor_poles')
    if poles is None:
        notes.append('eRPM: the header has no motor_poles, so rotor speeds are left out')
        return None
    # Counted in hundreds of electrical turns a minute; two poles make one mechanical turn.
    return _stream(log, 'eRPM', [f'rotor{k + 1}' for k in range(len(names))],
                   _stack(log, names) * (200.0 / poles * np.pi / 30.0))


def _battery(log: Log, notes: list[str]) -> Stream | None:
    if 'vbatLatest' not in log.values:
        return None
    match = _REVISION.match(str(log.headers.get('Firmware revision', '')))
    version = tuple(map(int, match.groups())) if match else (0, 0)
    if version < (3, 1):
        notes.append('vbatLatest: its unit is known only for Betaflight 3.1 and later, so that '
                     'it is left out')
        return None
    return _stream(log, 'vbatLatest', ('vbat',),
                   _stack(log, ['vbatLatest']) / (100.0 if version >= (4, 0) else 10.0), SLOW)
