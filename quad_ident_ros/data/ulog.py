# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records from the logs of PX4 (ULog)."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from pyulog import ULog

from quad_ident_ros.data import frames
from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.foreign import velocity_in_world
from quad_ident_ros.data.mapping import Actuators, KINDS, Mapping
from quad_ident_ros.data.modes import modes_from, PX4
from quad_ident_ros.data.px4_airframe import FIRST_MOTOR, Motors, motors_of, other_kind
from quad_ident_ros.data.px4_clock import RECEIVER, utc_of
from quad_ident_ros.data.px4_motors import commands, LINEAR_SPEED
from quad_ident_ros.data.px4_outputs import motor_outputs
from quad_ident_ros.data.px4_position import estimated
from quad_ident_ros.data.px4_resets import split_at_resets
from quad_ident_ros.data.px4_states import flown
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.data.signal_kind import LINEAR
from quad_ident_ros.data.split import part, SHORTEST
from quad_ident_ros.data.streams import HELD, INTERPOLATED, join, SLOW, Stream
from quad_ident_ros.data.topic_part import BODY_VELOCITY
from quad_ident_ros.data.ulog_parse import parse
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle

TOPICS = ('vehicle_attitude', 'estimator_attitude', 'vehicle_odometry', 'vehicle_local_position',
          'estimator_local_position', 'vehicle_angular_velocity', 'vehicle_acceleration',
          'sensor_combined', 'actuator_outputs', 'actuator_motors', 'esc_status',
          'battery_status')
STATES = ('vehicle_status', 'actuator_armed', 'vehicle_land_detected')

DENSER = 2.0        # times the samples for which a raw measurement is taken, not a corrected one
COARSE = 0.025      # s between samples; lags and delays of motors are of this size
PROFILE = ('set SDLOG_PROFILE to 25 (default set, system identification and high rate) and log '
           'again')

CUT_OFF = ('the log ends within a message: it was not copied completely, or power was lost; '
           'what came after is missing')

_LATEST = 2 ** 63 // 1000 - 1   # us, of a stamp that fits into ns


def read_ulog(path: str | Path, mapping: Mapping | None = None,
              vehicle: Vehicle | None = None) -> list[FlightRecord]:
    """
    Return the FlightRecords of a PX4 log, at least one, in ENU and FLU.

    One for each time armed and not landed, and between resets of the estimator. The time base is
    that of the actuator outputs, which become cmd1..N where the mapping says how (actuators) or
    else the parameters of the log, for a vehicle with these rotors, and stay output1..N as they
    are where neither does; without outputs it is that of the attitude. The estimator's stamps of
    samples are used where the log has them.
    Args: path; mapping Mapping or None; vehicle Vehicle or None.
    Raises InputError that names file and topic.
    """
    path, mapping = Path(path), mapping or Mapping()
    if mapping.topics or mapping.columns or mapping.world != 'ENU' or mapping.body != 'FLU':
        raise InputError(f'{path}: the topics and frames of a PX4 log are known; of a mapping '
                         'only instances and actuators hold for it')
    log = parse(path, (*TOPICS, *STATES, RECEIVER))
    for topic in mapping.instances:
        if topic not in TOPICS:
            raise InputError(f'{path}: instances: {topic!r} is not read; name one of '
                             f'{", ".join(TOPICS)}')
    data = {name: _instance(path, log, name, mapping.instances.get(name))
            for name in (*TOPICS, *STATES, RECEIVER)}
    refuse_others(path, log, data['vehicle_status'])
    notes = [*(['parts of the log are damaged and left out'] if log.file_corruption else []),
             *([CUT_OFF] if log.cut_off else []),
             *([f'{counted(len(log.dropouts), "dropout")} while logging'] if log.dropouts else [])]
    commands: list[str] = []
    logging: list[str] = []
    position = _position(path, data, logging)
    read = [_attitude(path, data, position), *position, _rate(path, data),
            _specific_force(path, data),
            _battery(path, log, data, mapping.instances.get('battery_status'))]
    read += _outputs(path, log, data, mapping.actuators, vehicle, commands,
                     mapping.instances.get('actuator_outputs'))
    streams = [stream for stream in read if stream is not None]
    logging += _slow(streams)
    notes += [*commands, *logging]
    start, t, columns, joined = join(path, streams)
    record = FlightRecord(t, velocity_in_world(path, columns), {
        'name': path.stem, 'source': str(path), 'start_ns': start, 'notes': [*notes, *joined],
        'commands': commands, 'logging': logging, **_linear(commands),
        'utc_ns': utc_of(data[RECEIVER], start), 'hardware': _hardware(log),
        'modes': _modes(path, data['vehicle_status'], start)})
    taken = {stream.source.removeprefix('topic ') for stream in streams
             if {'px', 'body_vx', 'qw'} & stream.columns.keys()}
    return _flights(path, record, data, taken)


def _linear(commands: Sequence[str]) -> dict[str, list[tuple[str, float, float]]]:
    """Return the info LINEAR of a record whose rotor speeds are linear in what a note names."""
    said = next((note for note in commands if LINEAR_SPEED in note), '')
    kind = 'normalised' if 'actuator_motors' in said else 'pwm'
    return {LINEAR: [(kind, 0.0, 1.0)]} if said else {}


def refuse_others(path: Path, log: ULog, status: dict | None) -> None:
    """Raise InputError for the log of a vehicle that is no multirotor; status: vehicle_status."""
    other = other_kind(log.initial_parameters, status)
    if other:
        raise InputError(f'{path}: this is the log of {other} (MAV_TYPE, vehicle_status), which '
                         'is not a multirotor; give the log of a multirotor')


def _modes(path: Path, status: dict | None, start_ns: int) -> list[tuple[float, str]]:
    """Return the changes of the flight mode, as modes_from has them."""
    if status is None or 'nav_state' not in status:
        return []
    stamps = _stamps(path, 'vehicle_status', status)
    return modes_from(stamps, status['nav_state'], PX4, start_ns)


def _hardware(log: object) -> dict[str, str]:
    """Return what a log knows of the vehicle: the kind of its board, and the id of that."""
    about = getattr(log, 'msg_info_dict', {})
    return {name: str(about[key]) for name, key in (('board', 'ver_hw'), ('id', 'sys_uuid'))
            if about.get(key)}


def _flights(path: Path, record: FlightRecord, data: dict, taken: set[str]
             ) -> list[FlightRecord]:
    """Return the parts of a record in the air and between resets of the topics that it is from."""
    states = {name: (_stamps(path, name, data[name]), data[name]) for name in (*STATES, *taken)
              if data[name] is not None and len(data[name]['timestamp'])}
    spans, looked_at = flown(states)
    parts = [record] if spans is None else _in_the_air(path, record, spans, looked_at)
    return split_at_resets(parts, record.info['start_ns'],
                           {name: found for name, found in states.items() if name in taken})


def _in_the_air(path: Path, record: FlightRecord, spans: list[tuple[int | None, int | None]],
                looked_at: str) -> list[FlightRecord]:
    """Return the parts of a record in spans of time (ns)."""
    if not spans:
        raise InputError(f'{path}: there is no flight in this log: {looked_at}')
    start, parts = record.info['start_ns'], []
    for first, last in spans:
        begin = 0 if first is None else np.searchsorted(record.t, (first - start) * 1e-9)
        end = len(record) if last is None else np.searchsorted(record.t, (last - start) * 1e-9)
        if end - begin >= 2:
            parts.append((int(begin), int(end)))
    long = [(begin, end) for begin, end in parts
            if record.t[end - 1] - record.t[begin] + record.period() >= SHORTEST]
    kept = long or parts[:1]
    if not kept:
        raise InputError(f'{path}: there is no flight in this log: while the vehicle was '
                         f'{looked_at} not all streams were logged')
    if kept == [(0, len(record))]:
        return [record]
    made = []
    for number, (begin, end) in enumerate(kept, 1):
        piece = part(record, begin, end)
        note = (f'kept: t = {piece.t[0]:.2f} to {piece.t[-1]:.2f} s of {record.t[-1]:.2f} s, '
                f'{looked_at}')
        if len(parts) > len(kept):
            short = counted(len(parts) - len(kept), 'flight')
            note += f'; left out: {short} shorter than {SHORTEST:g} s'
        info = {**piece.info, 'notes': [*piece.info['notes'], note]}
        if len(kept) > 1:
            info |= {'name': f'{info["name"]}_{number}', 'source': f'{path}, flight {number}'}
        made.append(replace(piece, info=info))
    return made


def _slow(streams: list[Stream]) -> list[str]:
    """Return notes of streams that are logged too slowly to show lags and delays."""
    slow = []
    for stream in streams:
        stamps = np.sort(stream.stamps)
        if stream.between != SLOW and 'rotor1' not in stream.columns and len(stamps) > 2:
            period = float(np.median(np.diff(stamps))) * 1e-9
            if period > COARSE:
                slow.append(f'{stream.source.removeprefix("topic ")} at {1 / period:.0f} Hz')
    if not slow:
        return []
    return [f'{", ".join(slow)}: below {1 / COARSE:.0f} Hz lags and delays are not visible; '
            f'{PROFILE}']


def _instance(path: Path, log: ULog, name: str, number: int | None
              ) -> dict[str, np.ndarray] | None:
    """Return name -> values of one instance of a topic, the first if none is named, or None."""
    found = {data.multi_id: data.data for data in log.data_list if data.name == name}
    if number is None:
        return found[min(found)] if found else None
    if number not in found:
        raise InputError(f'{path}: instances: there is no {name} {number}; the log has: '
                         f'{", ".join(map(str, sorted(found))) or "none"}')
    return found[number]


def _values(path: Path, topic: str, data: dict, names: Sequence[str]) -> np.ndarray:
    """Return the fields of a topic, (N, k)."""
    missing = [name for name in names if name not in data]
    if missing:
        raise InputError(f'{path}, topic {topic}: there is no field {missing[0]}; this is not a '
                         'log of PX4 1.11 or later')
    with np.errstate(invalid='ignore'):   # nan of a kind that signals
        return np.stack([np.asarray(data[name], float) for name in names], axis=-1)


def _stamps(path: Path, topic: str, data: dict) -> np.ndarray:
    """Return the stamps of a topic's samples, ns."""
    name = 'timestamp'
    if 'timestamp_sample' in data and np.all(data['timestamp_sample'] > 0):
        name = 'timestamp_sample'
    stamps = _values(path, topic, data, [name])[:, 0]
    if not (np.isfinite(stamps).all() and (stamps >= 0).all() and (stamps < _LATEST).all()):
        k = int(np.argmin(np.isfinite(stamps) & (stamps >= 0) & (stamps < _LATEST)))
        raise InputError(f'{path}, topic {topic}, message {k + 1}: the stamp {stamps[k]:g} us is '
                         'not a time; the log is damaged')
    return np.asarray(data[name]).astype(np.int64) * 1000


def _indexed(name: str, count: int) -> list[str]:
    return [f'{name}[{k}]' for k in range(count)]


def _stream(path: Path, topic: str, data: dict, names: Sequence[str], values: np.ndarray,
            between: str = INTERPOLATED) -> Stream:
    return Stream(f'topic {topic}', _stamps(path, topic, data),
                  dict(zip(names, values.T, strict=True)), between)


def _attitude(path: Path, data: dict, position: Sequence[Stream]) -> Stream:
    topics = 'vehicle_attitude', 'vehicle_odometry', 'estimator_attitude'
    if any(stream.source == 'topic vehicle_odometry' for stream in position) and _not_north(
            data['vehicle_odometry']):
        topics = 'vehicle_odometry', 'vehicle_attitude', 'estimator_attitude'
    topic = next((name for name in topics if data[name] is not None), None)
    if topic is None:
        raise InputError(f'{path}: has no topic vehicle_attitude, vehicle_odometry or '
                         'estimator_attitude; log it (SDLOG_PROFILE, default set)')
    q = _values(path, topic, data[topic], _indexed('q', 4))
    with np.errstate(all='ignore'):
        norm = np.linalg.norm(q, axis=-1, keepdims=True)
        q = np.where(norm > 1e-3, q / norm, np.nan)
    return _stream(path, topic, data[topic], QUATERNION, frames.attitude(q, 'NED', 'FRD'))


def _not_north(odometry: dict) -> bool:
    """Return whether the attitudes in an odometry are in its own frame, of any heading."""
    frames_frd = {'pose_frame': 2, 'local_frame': 1}    # of PX4 1.14 and later, and before
    own = any(np.any(odometry[name] == frd) for name, frd in frames_frd.items()
              if name in odometry)
    return own and 'q[0]' in odometry and bool(np.isfinite(odometry['q[0]']).all())


def _position(path: Path, data: dict, notes: list[str]) -> list[Stream]:
    """Return the streams of position and velocity of the first topic that has estimates."""
    without = []
    for topic in ('vehicle_local_position', 'vehicle_odometry', 'estimator_local_position'):
        if data[topic] is None:
            continue
        streams, known = _positions(path, topic, data[topic])
        if known.any():
            if not known.all():
                notes.append(f'topic {topic}: {np.sum(~known)} of {len(known)} samples are not '
                             'valid estimates and are left out')
            return streams
        without.append(topic)
    if without:
        notes.append(f'no position and velocity: {", ".join(without)} had no valid estimate, as '
                     'without GPS, camera or motion capture')
    return []


def _positions(path: Path, topic: str, found: dict) -> tuple[list[Stream], np.ndarray]:
    """Return the streams of position and velocity of a topic, and which samples are estimates."""
    new = 'position[0]' in found
    place = _values(path, topic, found, _indexed('position', 3) if new else ('x', 'y', 'z'))
    speed = _values(path, topic, found, _indexed('velocity', 3) if new else ('vx', 'vy', 'vz'))
    known = estimated(found, place, speed)
    if not known.any():
        return [], known
    found = {name: np.asarray(values)[known] for name, values in found.items()}
    place, speed = place[known], speed[known]
    in_body = np.zeros(len(speed), bool)
    if topic == 'vehicle_odometry' and 'velocity_frame' in found:
        in_body = np.asarray(found['velocity_frame']) == 3
    place = frames.world_vector(place, 'NED')
    if not in_body.any():
        return [_stream(path, topic, found, ('px', 'py', 'pz', 'vx', 'vy', 'vz'),
                        np.hstack([place, frames.world_vector(speed, 'NED')]))], known
    streams = [_stream(path, topic, found, ('px', 'py', 'pz'), place)]
    if in_body.all():
        streams.append(_stream(path, topic, found, BODY_VELOCITY,
                               frames.body_vector(speed, 'FRD')))
    return streams, known


def _rate(path: Path, data: dict) -> Stream | None:
    topic, field = _densest(data, {'vehicle_angular_velocity': 'xyz',
                                   'sensor_combined': 'gyro_rad'})
    if data[topic] is not None:
        values = _values(path, topic, data[topic], _indexed(field, 3))
        return _stream(path, topic, data[topic], ('wx', 'wy', 'wz'),
                       frames.body_vector(values, 'FRD'))
    topic = 'vehicle_odometry'
    if data[topic] is not None and 'angular_velocity[0]' in data[topic]:
        values = _values(path, topic, data[topic], _indexed('angular_velocity', 3))
        return _stream(path, topic, data[topic], ('wx', 'wy', 'wz'),
                       frames.body_vector(values, 'FRD'))
    return None


def _specific_force(path: Path, data: dict) -> Stream | None:
    topic, field = _densest(data, {'vehicle_acceleration': 'xyz',
                                   'sensor_combined': 'accelerometer_m_s2'})
    if data[topic] is None:
        return None
    values = _values(path, topic, data[topic], _indexed(field, 3))
    return _stream(path, topic, data[topic], ('ax', 'ay', 'az'),
                   frames.body_vector(values, 'FRD'))


def _densest(data: dict, fields: dict[str, str]) -> tuple[str, str]:
    """
    Return the first topic of fields {topic: field}, or a later one that was logged far more often.

    The corrected measurement comes before the raw one, but default profiles log it at 10 to 50 Hz.
    """
    counts = {topic: 0 if data[topic] is None else len(data[topic].get('timestamp', ()))
              for topic in fields}
    most = max(counts.values())
    return next((topic, fields[topic]) for topic, count in counts.items()
                if DENSER * count >= most)


def _battery(path: Path, log: ULog, data: dict, instance: int | None) -> Stream | None:
    """Return the stream of the battery, of the first that is connected where none is named."""
    topic = 'battery_status'
    if data[topic] is None:
        return None
    every = [one.data for one in sorted(log.data_list, key=lambda one: one.multi_id)
             if one.name == topic] if instance is None else [data[topic]]
    voltages = [_values(path, topic, one, ['voltage_v']) for one in every]
    k = next((k for k, values in enumerate(voltages) if (values > 0.0).any()), 0)
    if np.isfinite(voltages[k]).sum() < 2:
        return None   # a short log of a slow topic
    return _stream(path, topic, every[k], ('vbat',), voltages[k], SLOW)


def _outputs(path: Path, log: ULog, data: dict, actuators: Actuators | None,
             vehicle: Vehicle | None, notes: list[str], instance: int | None) -> list[Stream]:
    """
    Return the streams of commands and of measured rotor speeds; what was done is noted.

    Args: instance: of actuator_outputs, as a mapping names it, or None.
    """
    if actuators is not None:
        choices: tuple[str, ...] = ('actuator_outputs', 'actuator_motors')
        choices = choices[1:] if actuators.kind == 'normalised' else choices
    elif vehicle is not None and vehicle.motors is not None and vehicle.motors.kind == 'pwm':
        choices = ('actuator_outputs', 'actuator_motors')
    else:
        choices = ('actuator_motors', 'actuator_outputs')
    topic = next((name for name in choices if data[name] is not None), None)
    if topic is None:
        if actuators is not None:
            raise InputError(f'{path}: has no topic {" or ".join(choices)} for outputs of kind '
                             f'{actuators.kind}; log it, or name another of '
                             f'{", ".join(KINDS)}')
        return []
    field = {'actuator_outputs': 'output', 'actuator_motors': 'control'}[topic]
    motors, bank, found = motors_of(log.initial_parameters), '', data[topic]
    if topic == 'actuator_outputs':
        found, bank = _of_motors(log, found, instance, motors, notes)
    count = sum(name.startswith(f'{field}[') for name in found)
    values = _values(path, topic, found, _indexed(field, max(count, 1)))
    stamps = _stamps(path, topic, found)
    speeds = _measured(path, data['esc_status'], motors)
    simulated = 'SITL' in str(log.msg_info_dict.get('ver_hw', ''))
    columns, measured = commands(path, topic, (stamps, values), speeds, actuators, vehicle, motors,
                                 log.initial_parameters, simulated, notes, bank)
    streams = [Stream(f'topic {topic}', stamps, columns, HELD)]
    if measured and speeds is not None:
        streams.append(Stream('topic esc_status', speeds[0], measured, INTERPOLATED))
    return streams


def _of_motors(log: ULog, found: dict, instance: int | None, motors: Motors | None,
               notes: list[str]) -> tuple[dict, str]:
    """Return the fields of the actuator_outputs that motors are on, and their bank."""
    every = {data.multi_id: data.data for data in log.data_list if data.name == 'actuator_outputs'}
    asked = every if instance is None else {instance: found}
    number, bank = motor_outputs(asked, log.initial_parameters,
                                 len(motors.rotors) if motors else None)
    if len(asked) > 1:
        notes.append(f'of {len(asked)} instances of actuator_outputs that of the motors is taken: '
                     f'{number}{f" ({bank}_FUNC*)" if bank else ""}; a mapping may name another: '
                     'instances: {actuator_outputs: NUMBER}')
    return asked[number], bank


def _measured(path: Path, data: dict | None, motors: Motors | None
              ) -> tuple[np.ndarray, np.ndarray] | None:
    """Return (stamps, rotor speeds (n, m) rad/s in the order of the motors) or None."""
    if data is None or 'esc[0].esc_rpm' not in data:
        return None
    count = sum(name.endswith('].esc_rpm') for name in data)
    if motors is not None:
        count = min(count, len(motors.rotors))
    elif 'esc_count' in data and len(data['esc_count']):
        count = min(count, max(int(np.max(data['esc_count'])), 1))
    places = list(range(count))
    for k in range(sum(name.endswith('].esc_rpm') for name in data)):
        function = data.get(f'esc[{k}].actuator_function')
        motor = int(function[-1]) - FIRST_MOTOR if function is not None and len(function) else -1
        if 0 <= motor < count:
            places[motor] = k
    rpm = _values(path, 'esc_status', data, [f'esc[{k}].esc_rpm' for k in places])
    if not (np.abs(rpm) > 0).any(axis=0).all() or len(rpm) < 2:
        return None     # of controllers that report no speed
    return _stamps(path, 'esc_status', data), np.abs(rpm) * (2 * np.pi / 60)
