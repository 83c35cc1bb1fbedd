# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Flight records from the micro-SD logs of a Crazyflie.

Its frames are ENU and FLU, but for the pitch angle, whose sign is the other one. Source: log
variables and coordinate system in Bitcraze's documentation.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TypeAlias

import numpy as np

from quad_ident_ros.data.autopilot import known_names, outputs_stream, unit_quaternions
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.motor_order import about_motors, quad
from quad_ident_ros.data.readers.base import Content, content_of
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.data.streams import HELD, INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.data.usdlog import Event, read_events
from quad_ident_ros.errors import InputError
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.attitude import quaternion_from_euler, rotate

POSITION, VELOCITY = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
RATE, FORCE = ('wx', 'wy', 'wz'), ('ax', 'ay', 'az')
ROTORS = ('rotor1', 'rotor2', 'rotor3', 'rotor4')
OUTPUTS = ('output1', 'output2', 'output3', 'output4')
ORDER = ('motors are in the order of the Crazyflie: 1 front right, 2 rear right, 3 rear left, '
         '4 front left')
MOTORS = about_motors(quad((1, -1), (-1, -1), (-1, 1), (1, 1)), 'the order of the Crazyflie',
                      'duty16')


Make: TypeAlias = Callable[[np.ndarray], np.ndarray]
Choices: TypeAlias = tuple[tuple[tuple[str, ...], Make], ...]


def _of(group: str, *names: str) -> tuple[str, ...]:
    return tuple(f'{group}.{name}' for name in names)


def _scaled(factor: float | np.ndarray) -> Make:
    return lambda values: values * factor


def _euler(degrees: np.ndarray) -> np.ndarray:
    return quaternion_from_euler(np.radians(degrees * np.array([1.0, -1.0, 1.0])))


def _turned(values: np.ndarray) -> np.ndarray:
    """Return velocities in the world from those in the body and the quaternion beside them."""
    return rotate(unit_quaternions(values[:, 3:]), values[:, :3])


def _unpacked(values: np.ndarray) -> np.ndarray:
    """
    Return the quaternions (N, 4), scalar first, that are packed into one number each.

    The two highest bits name the largest of x, y, z, w, which is above zero; each of the others
    has ten bits, a sign and its share of sqrt(1/2). Source: Bitcraze's firmware, quatcompress.h.
    """
    packed = np.asarray(values)[:, 0]
    known = np.isfinite(packed) & (packed >= 0) & (packed < 2 ** 32)
    packed = np.where(known, packed, 0).astype(np.uint64)
    largest = (packed >> np.uint64(30)).astype(int)
    xyzw = np.zeros((len(packed), 4))
    for k in (3, 2, 1, 0):
        other = largest != k
        size = (packed & np.uint64(511)) / 511 * np.sqrt(0.5)
        sign = np.where(packed & np.uint64(512), -1.0, 1.0)
        xyzw[other, k] = (sign * size)[other]
        packed = np.where(other, packed >> np.uint64(10), packed)
    rest = 1.0 - np.sum(xyzw ** 2, axis=1)
    xyzw[np.arange(len(packed)), largest] = np.sqrt(np.maximum(rest, 0.0))
    return np.where(known[:, None], unit_quaternions(xyzw[:, [3, 0, 1, 2]]), np.nan)


_Q = ('q0', 'q1', 'q2', 'q3')
SOURCES: tuple[tuple[str, tuple[str, ...], str, Choices], ...] = (
    ('position', POSITION, INTERPOLATED, (
        (_of('stateEstimate', 'x', 'y', 'z'), _scaled(1.0)),
        (_of('kalman', 'stateX', 'stateY', 'stateZ'), _scaled(1.0)),
        (_of('stateEstimateZ', 'x', 'y', 'z'), _scaled(1e-3)),
        (_of('locSrv', 'x', 'y', 'z'), _scaled(1.0)))),
    ('velocity', VELOCITY, INTERPOLATED, (
        (_of('stateEstimate', 'vx', 'vy', 'vz'), _scaled(1.0)),
        (_of('kalman', 'statePX', 'statePY', 'statePZ', *_Q), _turned),
        (_of('stateEstimateZ', 'vx', 'vy', 'vz'), _scaled(1e-3)))),
    ('attitude', QUATERNION, INTERPOLATED, (
        (_of('stateEstimate', 'qw', 'qx', 'qy', 'qz'), unit_quaternions),
        (_of('kalman', *_Q), unit_quaternions),
        (_of('stateEstimateZ', 'quat'), _unpacked),
        (_of('stateEstimate', 'roll', 'pitch', 'yaw'), _euler),
        (_of('stabilizer', 'roll', 'pitch', 'yaw'), _euler),
        (_of('locSrv', 'qw', 'qx', 'qy', 'qz'), unit_quaternions))),
    ('rate', RATE, INTERPOLATED, (
        (_of('gyro', *'xyz'), _scaled(np.pi / 180.0)),
        (_of('stateEstimateZ', 'rateRoll', 'ratePitch', 'rateYaw'),
         _scaled(np.array([1e-3, -1e-3, 1e-3]))))),
    ('specific_force', FORCE, INTERPOLATED, ((_of('acc', *'xyz'), _scaled(GRAVITY)),)),
    ('rotors', ROTORS, INTERPOLATED, ((_of('rpm', 'm1', 'm2', 'm3', 'm4'),
                                       _scaled(np.pi / 30.0)),)),
    ('battery', ('vbat',), SLOW, ((_of('pm', 'vbat'), _scaled(1.0)),
                                  (_of('pm', 'vbatMV'), _scaled(1e-3)))),
    ('commands', OUTPUTS, HELD, (
        (_of('motor', 'm1', 'm2', 'm3', 'm4'), _scaled(1.0)),
        (_of('pwm', 'm1_pwm', 'm2_pwm', 'm3_pwm', 'm4_pwm'), _scaled(1.0)))),
)
"""Role, columns, how they are held, and by preference (variables, what makes columns of them)."""


def read_crazyflie(path: str | Path, mapping: Mapping | None = None) -> FlightRecord:
    """
    Return the FlightRecord of a micro-SD log.

    The time base is that of the motors' commands, output1..4, 0 to 65535; without them it is that
    of the first stream there is. No stream is required.
    Args: path; mapping Mapping or None.
    Raises InputError that names file and event or byte.
    """
    path = Path(path)
    mapping = known_names(path, 'a Crazyflie log', mapping)
    events, notes = read_events(path)
    streams: list[Stream] = []
    used: set[str] = set()
    for _, columns, between, choices in SOURCES:
        found = next(_there(events, choices), None)
        if found is None:
            continue
        event, names, make = found
        if columns == ('vbat',) and len(event.stamps) < 2:
            continue
        used.update(names)
        with np.errstate(all='ignore'):     # values of damaged rows
            values = np.stack([event.values[name].astype(float) for name in names], axis=-1)
            values = np.reshape(make(values), (len(values), -1))
        source = f'event {event.name}'
        if columns is OUTPUTS:
            streams.append(outputs_stream(source, event.stamps, values))
        else:
            streams.append(Stream(source, event.stamps, dict(zip(columns, values.T, strict=True)),
                                  between))
    has = {name for stream in streams for name in stream.columns}
    if not has - {'vbat'}:
        raise InputError(f'{path}: none of the variables in this Crazyflie log is known (there '
                         f'are: {_listed(_names(events))}); log acc, gyro, motor and '
                         'stateEstimate')
    if mapping.actuators is not None and 'output1' not in has:
        raise InputError(f'{path}: has no motor.m1 to motor.m4 for the actuators of the mapping; '
                         'log them, or leave actuators out')
    start, t, joined, left_out = join(path, streams)
    unread = [name for name in _names(events) if name not in used]
    said = [*notes, *([f'variables that are not read: {_listed(unread)}'] if unread else []),
            *([ORDER] if has & {'output1', 'rotor1'} else []), *left_out]
    return FlightRecord(t, joined, {'name': path.stem, 'source': str(path), 'start_ns': start,
                                    'notes': said, 'motors': MOTORS})


def contents(path: str | Path) -> list[Content]:
    """Return the Content of each kind of event in a micro-SD log; errors of read_events."""
    events, _ = read_events(path)
    origin = min(int(event.stamps.min()) for event in events if len(event.stamps))
    return [content_of(event.name, 'event', event.stamps, origin,
                       [f'{name} ({letter})' for name, letter in event.types.items()],
                       _roles(event))
            for event in events]


def _roles(event: Event) -> list[str]:
    """Return the roles that an event has the variables for; position and attitude are a pose."""
    roles = list(dict.fromkeys(role for role, _, _, choices in SOURCES
                               if next(_there([event], choices), None)))
    if 'position' in roles and 'attitude' in roles:
        return ['pose', *(role for role in roles if role not in ('position', 'attitude'))]
    return roles


def _there(events: Iterable[Event], choices: Choices
           ) -> Iterator[tuple[Event, tuple[str, ...], Make]]:
    """Yield (event, names, make) of the choices whose variables an event with samples has."""
    for names, make in choices:
        for event in sorted(events, key=lambda event: -len(event.stamps)):
            if len(event.stamps) and all(name in event.values for name in names):
                yield event, names, make


def _names(events: Iterable[Event]) -> list[str]:
    return list(dict.fromkeys(name for event in events for name in event.values))


def _listed(names: Sequence[str], most: int = 8) -> str:
    more = f' and {len(names) - most} more' if len(names) > most else ''
    return ', '.join(name[:40] for name in names[:most]) + more if names else 'none'
