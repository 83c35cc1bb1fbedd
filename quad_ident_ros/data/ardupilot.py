# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Flight records from the DataFlash logs of ArduPilot.

Source: ArduPilot's log messages (LogStructure.h), parameters, and motor orders (AP_Motors).
"""

from collections.abc import Sequence
from pathlib import Path
import re
from typing import TypeGuard

import numpy as np

from quad_ident_ros.data import frames
from quad_ident_ros.data.ardupilot_lanes import (
    instance_field,
    instances_of,
    of_primary,
    OLDER,
    Primary,
    primary_of,
    READ_BESIDE,
    timed,
)
from quad_ident_ros.data.autopilot import known_names, outputs_stream, unit_quaternions
from quad_ident_ros.data.dataflash import Messages, read_messages
from quad_ident_ros.data.mapping import Actuators, Mapping
from quad_ident_ros.data.modes import modes_from
from quad_ident_ros.data.motor_layouts import directions
from quad_ident_ros.data.motor_order import about_motors
from quad_ident_ros.data.readers.base import Content, content_of
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.data.split import split
from quad_ident_ros.data.streams import INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.data.thrust_curve import ardupilot_curve
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import quaternion_from_euler

ROLES = {'XKQ': ('attitude',), 'NKQ': ('attitude',), 'ATT': ('attitude',),
         'XKF1': ('position', 'velocity'), 'NKF1': ('position', 'velocity'),
         'POS': ('position',), 'GPS': ('position', 'velocity'),
         'IMU': ('rate', 'specific_force'), 'RATE': ('rate',), 'RCOU': ('commands',),
         'ESC': ('rotors',), 'BAT': ('battery',), 'CURR': ('battery',)}
"""Types of messages that are read, and for what."""

_ABOUT = ('PARM', 'MSG', 'VER', 'TIME', 'MODE')
_TODAY = {older: name for name, names in OLDER.items() for older in names}
_BUILDS = {1: 'Rover', 3: 'ArduPlane', 4: 'AntennaTracker', 7: 'ArduSub', 12: 'Blimp'}
_OTHERS = {'ArduPlane': 'ArduPlane', 'ArduRover': 'Rover', 'APM:Rover': 'Rover', 'Rover': 'Rover',
           'ArduSub': 'ArduSub', 'Blimp': 'Blimp', 'AntennaTracker': 'AntennaTracker',
           'APM:Plane': 'ArduPlane'}
_HELICOPTERS: dict[float | None, str] = {
    6: 'a helicopter', 8: 'a single copter', 9: 'a coaxial copter',
    11: 'a helicopter with two rotors', 13: 'a helicopter with four rotors'}
_PLACES: dict[tuple[float | None, ...], str] = {
    (1, 0): '1 right, 2 left, 3 front, 4 rear',
    (1, 1): '1 front right, 2 rear left, 3 front left, 4 rear right'}
"""Where motors are, by FRAME_CLASS and FRAME_TYPE; quad plus and quad X."""

_LAYOUTS: dict[tuple[float | None, ...], str] = {
    (1, 0): 'quad +', (1, 1): 'quad x', (1, 12): 'quad x of Betaflight', (1, 13): 'quad x of DJI',
    (1, 14): 'quad x, clockwise', (1, 18): 'quad x of Betaflight, turning outwards',
    (2, 0): 'hexa +', (2, 1): 'hexa x',
    (3, 0): 'octo +', (3, 1): 'octo x', (4, 0): 'coaxial octo +', (4, 1): 'coaxial octo x'}

_BOARD = re.compile(r'([\w-]+) ((?:[0-9A-F]{8} ?){3})')     # name, and serial number of its chip
_MOTOR = re.compile(r'SERVO([1-9]|[12][0-9]|3[0-2])_FUNCTION')
_MAP = ('MOT_PWM_MIN', 'MOT_PWM_MAX', 'MOT_SPIN_ARM', 'MOT_SPIN_MIN', 'MOT_SPIN_MAX',
        'MOT_THST_EXPO')
_AXIS, _FLATTENING = 6378137.0, 1 / 298.257223563      # WGS 84


def read_ardupilot(path: str | Path, mapping: Mapping | None = None) -> list[FlightRecord]:
    """
    Return the FlightRecord of a log of ArduCopter, in ENU and FLU, split where its EKF changed.

    The time base is that of the outputs (RCOU), in the order of the motors as SERVOn_FUNCTION
    tells it: output1..N, us of PWM. Of the EKF's lanes the primary one is read, of sensors and
    batteries the first, or that of the mapping's instances. No stream is required.
    Args: path; mapping Mapping or None.
    Raises InputError that names file and message, also for vehicles that are no multirotor.
    """
    path = Path(path)
    mapping = known_names(path, 'an ArduPilot log', mapping, instances=True)
    for name in mapping.instances:
        if name not in ROLES:
            raise InputError(f'{path}: instances: {name!r} is not read; name one of '
                             f'{", ".join(ROLES)}')
    found, damaged = read_messages(path, {*ROLES, *_ABOUT, *READ_BESIDE})
    parameters = _parameters(found)
    _refuse_others(path, found, parameters)
    notes = [f'{damaged} bytes of the log are not messages and are left out'] if damaged else []
    flown = {name: primary_of(name, found) for name in ROLES if name not in mapping.instances}
    data = {name: _instance(path, name, found, mapping.instances.get(name), flown.get(name), notes)
            for name in _by_preference(parameters) if name != 'ESC'}
    states = [_attitude(data), *_motion(data), _rate(data), _specific_force(data), _battery(data)]
    channels = _channels(parameters)
    outputs = _outputs(path, data['RCOU'], channels, mapping.actuators, notes)
    rotors = _rotors(found.get('ESC'), channels, notes)
    streams = [stream for stream in [*states, outputs, *rotors] if stream is not None]
    if not any(set(stream.columns) - {'vbat'} for stream in streams):
        raise InputError(f'{path}: has none of the messages {", ".join(ROLES)}; set LOG_BITMASK '
                         'to log them')
    if outputs is not None or rotors:
        notes += _order_notes(parameters, bool(channels))
    start, t, columns, left_out = join(path, streams)
    record = FlightRecord(t, columns, {'name': path.stem, 'source': str(path), 'start_ns': start,
                                       'notes': [*notes, *left_out],
                                       'motors': _about_motors(parameters, channels),
                                       'hardware': _hardware(found),
                                       'modes': _modes(found.get('MODE'), start)})
    return split(record, [((before - start) * 1e-9, (after - start) * 1e-9, what)
                          for before, after, what in _changes(data, flown)])


def _by_preference(parameters: dict[str, float]) -> list[str]:
    """Return the names of ROLES, those of the EKF first that the vehicle flew by."""
    second = parameters.get('AHRS_EKF_TYPE') == 2
    return sorted(ROLES, key=lambda name: name.startswith('XK')) if second else list(ROLES)


def _changes(data: dict[str, Messages | None],
             flown: dict[str, Primary | None]) -> list[tuple[int, int, str]]:
    """Return the changes of the lanes that are read, as Primary has them."""
    used = [flown.get(name) for names in (('XKQ', 'NKQ'), ('XKF1', 'NKF1'))
            for name in _there(data, *names)[:1]]
    return list(dict.fromkeys(one for primary in used if primary for one in primary.changes()))


def _there(data: dict[str, Messages | None], *names: str) -> list[str]:
    """Return those of names that there are messages of, in the order of data."""
    return [name for name in data if name in names and data[name] is not None]


def _modes(messages: Messages | None, start_ns: int) -> list[tuple[float, str]]:
    """Return the changes of the flight mode of a copter, as modes_from has them."""
    from pymavlink.mavutil import mode_mapping_acm
    if messages is None:
        return []
    numbers = [name for name in ('ModeNum', 'Mode') if name in messages.fields
               and messages.rows[name].dtype.kind in 'iu']
    if not numbers or not timed(messages):
        return []
    names = {number: name.lower().replace('_', ' ') for number, name in mode_mapping_acm.items()}
    stamps = messages.rows['TimeUS'].astype(np.int64) * 1000
    return modes_from(stamps, messages.rows[numbers[0]], names, start_ns)


def contents(path: str | Path) -> list[Content]:
    """Return the Content of each type of message, of each of its instances; errors as above."""
    found, _ = read_messages(path)
    stamps = {name: messages.rows['TimeUS'].astype(np.int64) * 1000
              for name, messages in found.items() if timed(messages) and len(messages)}
    origin = min((int(values.min()) for values in stamps.values()), default=0)
    listed = []
    for name, values in sorted(stamps.items()):
        messages, field = found[name], instance_field(found[name])
        numbers = [None] if field is None else np.unique(messages.rows[field]).tolist()
        for number in numbers:
            some = slice(None) if number is None else messages.rows[field] == number
            listed.append(content_of(name if number is None else f'{name}[{number}]',
                                     messages.letters, values[some], origin, messages.fields,
                                     ROLES.get(_TODAY.get(name, name), ())))
    return listed


def _instance(path: Path, name: str, found: dict[str, Messages], number: int | None,
              primary: Primary | None, notes: list[str]) -> Messages | None:
    """Return the messages of one instance, the primary or first if none is named, or None."""
    there = instances_of(name, found)
    if number is not None and number not in there:
        raise InputError(f'{path}: instances: there is no {name} {number}; the log has: '
                         f'{", ".join(map(str, there)) or "none"}')
    if not there:
        return None
    if not all(map(timed, there.values())):
        raise InputError(f'{path}, message {name}: there is no stamp TimeUS; this is not a log of '
                         'ArduPilot 3.3 or later')
    if primary is None or len(there) == 1:
        return there[min(there) if number is None else number]
    followed = of_primary(there, primary)
    lanes = ', '.join(map(str, dict.fromkeys(primary.numbers.tolist())))
    notes.append(f'{name}: lane {lanes} of {len(there)}, the primary of the EKF' if followed else
                 f'{name}: lane {min(there)}, for the primary of the EKF, {lanes}, is not logged')
    return there[min(there)] if followed is None else followed


def _parameters(found: dict[str, Messages]) -> dict[str, float]:
    """Return the last value of each parameter, name -> float."""
    messages = found.get('PARM')
    if messages is None or not _has(messages, 'Name', 'Value'):
        return {}
    return dict(zip(messages.texts('Name'), messages.values('Value').tolist(), strict=True))


def _has(messages: Messages | None, *fields: str) -> TypeGuard[Messages]:
    """Return whether there are messages with these fields, numerical but for texts."""
    return messages is not None and all(
        field in messages.fields and (messages.rows[field].dtype.kind in 'iuf'
                                      or field in ('Name', 'Message')) for field in fields)


def _hardware(found: dict[str, Messages]) -> dict[str, str]:
    """Return what a log knows of the vehicle: its board and the serial number of that."""
    if not _has(found.get('MSG'), 'Message') or found['MSG'].rows['Message'].dtype.kind != 'S':
        return {}
    told = filter(None, map(_BOARD.fullmatch, found['MSG'].texts('Message')))
    return next(({'board': one[1], 'id': one[2]} for one in told), {})


def _refuse_others(path: Path, found: dict[str, Messages], parameters: dict[str, float]) -> None:
    """Raise InputError for vehicles that are no multirotor, and for logs of old PX4."""
    if 'TIME' in found and 'StartTime' in found['TIME'].fields:
        raise InputError(f'{path}: this is a log of PX4 before 1.5 (sdlog2), which is not read; '
                         'fly with a later version, which logs ULog')
    kind = None
    if _has(found.get('MSG'), 'Message') and found['MSG'].rows['Message'].dtype.kind == 'S':
        kind = next((_OTHERS[word] for text in found['MSG'].texts('Message')
                     for word in _OTHERS if text.startswith(word)), None)
    if kind is None and _has(found.get('VER'), 'BU'):
        kind = next((_BUILDS[build] for build in found['VER'].rows['BU'].tolist()
                     if build in _BUILDS), None)
    if kind == 'ArduPlane' and parameters.get('Q_ENABLE', 0) > 0:
        kind = 'ArduPlane, of a VTOL (Q_ENABLE)'
    if kind is None and parameters.get('FRAME_CLASS') in _HELICOPTERS:
        kind = f'{_HELICOPTERS[parameters["FRAME_CLASS"]]} (FRAME_CLASS)'
    if kind is not None:
        raise InputError(f'{path}: this is a log of {kind}, which is not a multirotor; give a log '
                         'of ArduCopter of a multirotor')


def _stream(messages: Messages, columns: Sequence[str], values: np.ndarray,
            between: str = INTERPOLATED) -> Stream:
    return Stream(f'message {messages.name}', messages.rows['TimeUS'].astype(np.int64) * 1000,
                  dict(zip(columns, np.asarray(values, float).T, strict=True)), between)


def _stack(messages: Messages, fields: Sequence[str]) -> np.ndarray:
    return np.stack([messages.values(field) for field in fields], axis=-1)


def _attitude(data: dict[str, Messages | None]) -> Stream | None:
    fields = ('Q1', 'Q2', 'Q3', 'Q4')
    for name in _there(data, 'XKQ', 'NKQ'):
        messages = data[name]
        if _has(messages, *fields):
            q = unit_quaternions(_stack(messages, fields))
            return _stream(messages, QUATERNION, frames.attitude(q, 'NED', 'FRD'))
    if _has(data['ATT'], 'Roll', 'Pitch', 'Yaw'):
        with np.errstate(all='ignore'):
            q = quaternion_from_euler(np.radians(_stack(data['ATT'], ('Roll', 'Pitch', 'Yaw'))))
        return _stream(data['ATT'], QUATERNION, frames.attitude(q, 'NED', 'FRD'))
    return None


def _motion(data: dict[str, Messages | None]) -> list[Stream]:
    """Return the streams of position and velocity, from the EKF, or else from POS and GPS."""
    position, velocity = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
    for name in _there(data, 'XKF1', 'NKF1'):
        messages = data[name]
        if _has(messages, 'PN', 'PE', 'PD', 'VN', 'VE', 'VD'):
            return [_stream(messages, (*position, *velocity), np.hstack(
                [frames.world_vector(_stack(messages, fields), 'NED')
                 for fields in (('PN', 'PE', 'PD'), ('VN', 'VE', 'VD'))]))]
    streams, gps = [], data['GPS']
    if _has(gps, 'Status'):
        gps = gps.only(gps.values('Status') >= 3)   # a fix in three dimensions
    place = data['POS'] if _has(data['POS'], 'Lat', 'Lng', 'Alt') else gps
    if _has(place, 'Lat', 'Lng', 'Alt') and len(place):
        streams.append(_stream(place, position, _local(_stack(place, ('Lat', 'Lng', 'Alt')))))
    if _has(gps, 'Spd', 'GCrs', 'VZ') and len(gps):
        with np.errstate(all='ignore'):
            speed, course, down = _stack(gps, ('Spd', 'GCrs', 'VZ')).T
            course = np.radians(course)
            values = np.stack([speed * np.sin(course), speed * np.cos(course), -down], axis=-1)
        streams.append(_stream(gps, velocity, values))
    return streams


def _local(place: np.ndarray) -> np.ndarray:
    """Return east, north and up (N, 3) m of latitude, longitude (deg) and height (m)."""
    with np.errstate(all='ignore'):
        latitude, longitude = np.radians(place[:, 0]), np.radians(place[:, 1])
        squared = _FLATTENING * (2 - _FLATTENING)
        bulge = 1 - squared * np.sin(latitude[0]) ** 2
        across = _AXIS / np.sqrt(bulge)
        along = across * (1 - squared) / bulge
        east = np.remainder(longitude - longitude[0] + np.pi, 2 * np.pi) - np.pi
        return np.stack([east * across * np.cos(latitude[0]), (latitude - latitude[0]) * along,
                         place[:, 2] - place[0, 2]], axis=-1)


def _rate(data: dict[str, Messages | None]) -> Stream | None:
    if _has(data['IMU'], 'GyrX', 'GyrY', 'GyrZ'):
        values = _stack(data['IMU'], ('GyrX', 'GyrY', 'GyrZ'))
        return _stream(data['IMU'], ('wx', 'wy', 'wz'), frames.body_vector(values, 'FRD'))
    if _has(data['RATE'], 'R', 'P', 'Y'):
        values = np.radians(_stack(data['RATE'], ('R', 'P', 'Y')))
        return _stream(data['RATE'], ('wx', 'wy', 'wz'), frames.body_vector(values, 'FRD'))
    return None


def _specific_force(data: dict[str, Messages | None]) -> Stream | None:
    if not _has(data['IMU'], 'AccX', 'AccY', 'AccZ'):
        return None
    values = _stack(data['IMU'], ('AccX', 'AccY', 'AccZ'))
    return _stream(data['IMU'], ('ax', 'ay', 'az'), frames.body_vector(values, 'FRD'))


def _battery(data: dict[str, Messages | None]) -> Stream | None:
    for name in ('BAT', 'CURR'):
        messages = data[name]
        if _has(messages, 'Volt') and np.isfinite(messages.values('Volt')).sum() > 1:
            return _stream(messages, ('vbat',), _stack(messages, ('Volt',)), SLOW)
    return None


def _channels(parameters: dict[str, float]) -> dict[int, int]:
    """Return motor -> channel, from 1, of the parameters SERVOn_FUNCTION."""
    motors: dict[float, int] = {**{33 + k: k + 1 for k in range(8)},
                                **{82 + k: k + 9 for k in range(4)}}
    found: dict[int, int] = {}
    for name, function in parameters.items():
        match = _MOTOR.fullmatch(name)
        motor = motors.get(function)
        if match and motor:
            found[motor] = min(found.get(motor, 99), int(match[1]))
    # Motors are counted from 1; none follows a gap.
    return {motor: found[motor] for motor in found if all(k in found for k in range(1, motor))}


def _outputs(path: Path, messages: Messages | None, channels: dict[int, int],
             actuators: Actuators | None, notes: list[str]) -> Stream | None:
    """Return the stream of the motors' outputs, or None."""
    where = f'{path}, message RCOU'
    letters = () if messages is None else [name for name in messages.fields
                                           if re.fullmatch(r'(C|Ch)[1-9][0-9]?', name)
                                           and messages.rows[name].dtype.kind in 'iuf']
    by_channel = {int(re.sub(r'\D', '', name)): name for name in letters}
    if messages is None or not by_channel:
        if actuators is not None:
            raise InputError(f'{path}: has no message RCOU for the actuators of the mapping; log '
                             'it (LOG_BITMASK, RCOUT), or leave actuators out')
        return None
    order = [channels[motor] for motor in sorted(channels)]
    missing = [channel for channel in order if channel not in by_channel]
    if missing:
        raise InputError(f'{where}: a motor is at output {missing[0]} (SERVO{missing[0]}_FUNCTION)'
                         f', which is not logged; it has the outputs {min(by_channel)} to '
                         f'{max(by_channel)}')
    if not order:
        order = [channel for channel, name in sorted(by_channel.items())
                 if messages.rows[name].any()] or [min(by_channel)]
        notes.append('no parameter SERVOn_FUNCTION says which outputs are motors: all outputs '
                     'that are used are kept, as they come')
    values = _stack(messages, [by_channel[channel] for channel in order])
    return outputs_stream('message RCOU', messages.rows['TimeUS'].astype(np.int64) * 1000, values)


def _rotors(messages: Messages | None, channels: dict[int, int], notes: list[str]) -> list[Stream]:
    """Return the streams of measured rotor speeds, one for each motor, or none."""
    field = None if messages is None else instance_field(messages)
    if field is None or not _has(messages, 'RPM') or not timed(messages):
        return []
    count = np.bincount(messages.rows[field].astype(np.uint8), minlength=256)
    there = np.flatnonzero(count > 1).tolist()
    instances = [channels[motor] - 1 for motor in sorted(channels)]
    if not instances or not set(instances) <= set(there):
        if not there or len(instances) not in (0, len(there)):
            notes.append(f'ESC: the log has rotor speeds of {len(there)} ESCs for '
                         f'{len(instances)} motors; they are left out')
            return []
        instances = there
        notes.append('ESC: the ESCs are not numbered as the outputs; rotor speeds are kept in '
                     'the order of the ESCs')
    some = [messages.only(messages.rows[field] == number) for number in instances]
    return [Stream(f'message ESC[{number}]', one.rows['TimeUS'].astype(np.int64) * 1000,
                   {f'rotor{k}': np.abs(one.values('RPM')) * (np.pi / 30.0)})  # less: in reverse
            for k, (number, one) in enumerate(zip(instances, some, strict=True), 1)]


def _about_motors(parameters: dict[str, float], channels: dict[int, int]) -> dict:
    """Return what is known of the motors, for the info of a record."""
    frame = tuple(parameters.get(name) for name in ('FRAME_CLASS', 'FRAME_TYPE'))
    rotors = directions(_LAYOUTS[frame]) if frame in _LAYOUTS else ()
    rotors = rotors if len(rotors) == len(channels) else ()
    return about_motors(rotors, "ArduPilot's order for FRAME_CLASS and FRAME_TYPE", 'pwm',
                        ardupilot_curve(parameters) if channels else None)


def _order_notes(parameters: dict[str, float], known: bool) -> list[str]:
    """Return notes on the order of the motors, and on the map from throttle to PWM."""
    notes, frame = [], tuple(parameters.get(name) for name in ('FRAME_CLASS', 'FRAME_TYPE'))
    if known and frame in _PLACES:
        notes.append(f"motors are in ArduPilot's order: {_PLACES[frame]}")
    elif known and None not in frame:
        named = f' ({_LAYOUTS[frame]})' if frame in _LAYOUTS else ''
        notes.append(f"motors are in ArduPilot's order for FRAME_CLASS {frame[0]:g}, FRAME_TYPE "
                     f'{frame[1]:g}{named}')
    told = [f'{name} {parameters[name]:g}' for name in _MAP if name in parameters]
    return [*notes, *([f'the map of the motors is: {", ".join(told)}'] if told else [])]
