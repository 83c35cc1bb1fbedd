# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The mapping file: which topics and outputs of other people's records mean what."""

from collections.abc import Mapping as Pairs
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
import re
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros import resources, schema
from quad_ident_ros.data.frames import BODIES, WORLDS
from quad_ident_ros.data.record import KNOWN, unit
from quad_ident_ros.errors import InputError
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model import motors
from quad_ident_ros.model.attitude import quaternion_from_euler
from quad_ident_ros.model.motors import KINDS, Motors, TO_SPEED
from quad_ident_ros.model.vehicle import Vehicle

ROLES = ('pose', 'position', 'attitude', 'velocity', 'rate', 'specific_force', 'commands',
         'rotors', 'battery')
"""What a topic can be read for."""

CURVES = ('linear', 'thrust')

ATTITUDE = 'q'
"""Stands for all four columns of a quaternion."""

UNITS = {
    's': {'s': 1.0, 'ms': 1e-3, 'us': 1e-6, 'ns': 1e-9, 'min': 60.0, 'h': 3600.0},
    'm': {'m': 1.0, 'mm': 1e-3, 'cm': 1e-2, 'ft': 0.3048, 'in': 0.0254},
    'm/s': {'m/s': 1.0, 'mm/s': 1e-3, 'cm/s': 1e-2, 'km/h': 1 / 3.6, 'ft/s': 0.3048,
            'mph': 0.44704, 'kn': 1852 / 3600},
    'rad': {'rad': 1.0, 'deg': np.pi / 180, 'mrad': 1e-3},
    'rad/s': {'rad/s': 1.0, 'deg/s': np.pi / 180, 'mrad/s': 1e-3, 'rpm': np.pi / 30,
              'krpm': 1000 * np.pi / 30, 'Hz': 2 * np.pi},
    'm/s^2': {'m/s^2': 1.0, 'cm/s^2': 1e-2, 'mm/s^2': 1e-3, 'g': GRAVITY,
              'mg': 1e-3 * GRAVITY, 'g/2048': GRAVITY / 2048},
    'V': {'V': 1.0, 'mV': 1e-3},
}
"""Units that a column of a table or a topic may have, by the unit of the flight record."""

COUNTED = re.compile(r'(?=.*[1-9])(\d{1,5}(?:\.\d{1,6})?) Hz')
"""Unit of a time that is a count, as the frames of a camera: their rate."""

UNIT_OF_ROLE = {'pose': 'm', 'position': 'm', 'attitude': 'rad', 'velocity': 'm/s',
                'rate': 'rad/s', 'specific_force': 'm/s^2', 'rotors': 'rad/s', 'battery': 'V'}
"""Role of a topic -> its unit in the flight record. That of an attitude makes it three angles."""

_OUTPUT = re.compile(r'output[1-9][0-9]*')


@dataclass(frozen=True)
class Actuators:
    """
    How actuator outputs become rotor speeds.

    order: for each rotor of the vehicle file the number of its output, from 1; empty: as they
    come. kind: one of KINDS. minimum, maximum: outputs at the lowest and at the full speed; None
    for those of the vehicle's motors of this kind, or else of the kind. speeds: these two in
    rad/s, or None for those of the vehicle. curve: linear, the speed is linear in the output;
    thrust, its square is.
    """

    order: tuple[int, ...] = ()
    kind: str = 'speed'
    minimum: float | None = None
    maximum: float | None = None
    speeds: tuple[float, ...] | None = None
    curve: str = 'linear'


@dataclass(frozen=True)
class Source:
    """
    A topic to read for a role.

    topic: its name; field: the path of the value in its messages, '' for where its type has it;
    frame: of a velocity, body or world, '' for what its type says; child: the child_frame_id of
    the transform to read of several; unit: one of UNITS, '' for that of the flight record.
    """

    topic: str
    field: str = ''
    frame: str = ''
    child: str = ''
    unit: str = ''


@dataclass(frozen=True)
class Column:
    """
    Columns of a table to read for one of the flight record: names, four of them for q.

    unit: one of UNITS, with a minus before it for the other sign, '' for that of the flight
    record; frame: of a velocity, world or body.
    """

    names: tuple[str, ...]
    unit: str = ''
    frame: str = 'world'


@dataclass(frozen=True)
class Mapping:
    """
    The content of a mapping file.

    topics: role -> Source; world and body: the frames of the record, ENU or NED, FLU or FRD;
    instances: ULog topic -> the instance (multi_id) to read; actuators: Actuators or None;
    columns: column of the flight record, or q for all four of the quaternion -> Column of a
    table; quaternion: order of those of q, wxyz or xyzw; separator of a table, '' if not given.
    """

    topics: Pairs[str, Source] = field(default_factory=dict)
    world: str = 'ENU'
    body: str = 'FLU'
    instances: Pairs[str, int] = field(default_factory=dict)
    actuators: Actuators | None = None
    columns: Pairs[str, Column] = field(default_factory=dict)
    quaternion: str = 'wxyz'
    separator: str = ''


def load_mapping(path: str | Path) -> Mapping:
    """Return the Mapping of a file; raises InputError that names file and key."""
    return mapping_from(resources.read_yaml(path), str(path))


def mapping_from(data: Any, where: str) -> Mapping:
    """Return the Mapping that the content of a mapping file describes; raises InputError."""
    schema.check_keys(where, data, ('topics', 'world', 'body', 'instances', 'actuators',
                                    'columns', 'quaternion', 'separator'))
    topics = data.get('topics', {})
    schema.check_keys(f'{where}: topics', topics, ROLES)
    instances = data.get('instances', {})
    if not isinstance(instances, dict):
        raise InputError(f'{where}: instances: expected `topic: number` lines, got '
                         f'{schema.shown(instances)}')
    return Mapping(
        {role: _source(f'{where}: topics: {role}', role, entry)
         for role, entry in topics.items()},
        schema.choice(f'{where}: world', data.get('world', 'ENU'), WORLDS),
        schema.choice(f'{where}: body', data.get('body', 'FLU'), BODIES),
        {str(topic): schema.integer(f'{where}: instances: {schema.shown(topic)}', number, 0)
         for topic, number in instances.items()},
        actuators_from(f'{where}: actuators', data['actuators']) if 'actuators' in data else None,
        _columns(f'{where}: columns', data.get('columns', {})),
        schema.choice(f'{where}: quaternion', data.get('quaternion', 'wxyz'), ('wxyz', 'xyzw')),
        schema.choice(f'{where}: separator', data.get('separator', ''),
                      ('', ',', ';', '\t', '|', ' ')))


def actuators_from(where: str, data: Any) -> Actuators:
    """Return the Actuators that the section `actuators` of a mapping says; raises InputError."""
    schema.check_keys(where, data, ('order', 'kind', 'minimum', 'maximum', 'speeds', 'curve'),
                      ('kind',))
    kind = schema.choice(f'{where}: kind', data['kind'], tuple(KINDS))
    if KINDS[kind] is None:
        for key in ('minimum', 'maximum', 'speeds', 'curve'):
            if key in data:
                raise InputError(f'{where}: {key}: outputs of kind {kind} are rotor speeds '
                                 'already; leave it out')
    minimum, maximum = (schema.number(f'{where}: {key}', data[key]) if key in data else None
                        for key in ('minimum', 'maximum'))
    if minimum is not None and maximum is not None and maximum <= minimum:
        raise InputError(f'{where}: maximum: {maximum:g} is not above the minimum, {minimum:g}')
    order = data.get('order', [])
    if not isinstance(order, list) or len(order) > 64 or ('order' in data and not order):
        raise InputError(f'{where}: order: expected a list such as [1, 3, 2, 4], got '
                         f'{schema.shown(order)}')
    order = tuple(schema.integer(f'{where}: order[{k}]', number, 1)
                  for k, number in enumerate(order))
    if len(set(order)) != len(order):
        raise InputError(f'{where}: order: {list(order)} names an output twice')
    speeds = None
    if 'speeds' in data:
        speeds = schema.numbers(f'{where}: speeds', data['speeds'], 2, minimum=0.0)
        if speeds[1] <= speeds[0]:
            raise InputError(f'{where}: speeds: expected [low, high], got {list(speeds)}')
    curve = schema.choice(f'{where}: curve', data.get('curve', 'linear'), CURVES)
    return Actuators(order, kind, minimum, maximum, speeds, curve)


def actuators_to_mapping(actuators: Actuators) -> dict[str, object]:
    """Return the section `actuators` of a mapping that says Actuators."""
    said = {'kind': actuators.kind, 'order': list(actuators.order), 'minimum': actuators.minimum,
            'maximum': actuators.maximum, 'speeds': actuators.speeds and list(actuators.speeds)}
    if actuators.kind not in TO_SPEED:
        said['curve'] = actuators.curve
    return {key: value for key, value in said.items() if value not in (None, [])}


def factor_of(name: str, said: str) -> float:
    """
    Return what values in a unit of UNITS are multiplied by for a column of the record.

    A unit with a minus before it is that of values with the other sign; that of a time may be a
    rate, of values that count at it.
    """
    rate = COUNTED.fullmatch(said) if name == 't' else None
    if rate:
        return 1.0 / float(rate[1])
    known = UNITS.get(unit_of(name), {})
    return known.get(said.removeprefix('-'), 1.0) * (-1.0 if said.startswith('-') else 1.0)


def in_record_unit(role: str, values: Sequence[float], said: str) -> Sequence[float]:
    """
    Return the numbers of a role from those in a unit of UNITS; '' is the record's.

    Roll, pitch and yaw become the quaternion, scalar first, that turns by them. Speeds of rotors
    stay as they are: data.topic_part reads them by their kind.
    """
    if not said or role == 'rotors':
        return values
    scaled = [UNITS[UNIT_OF_ROLE[role]][said] * value for value in values]
    if role == 'attitude':
        return quaternion_from_euler(np.array(scaled)).tolist()
    return [*scaled[:3], *values[3:]]       # behind the position of a pose comes its quaternion


def unit_of(name: str) -> str:
    """Return the unit of a column of the flight record, '' for those that have none."""
    return '' if name == ATTITUDE or _OUTPUT.fullmatch(name) else unit(name) or ''


def rotor_speeds(where: str, outputs: ArrayLike, actuators: Actuators, vehicle: Vehicle | None
                 ) -> np.ndarray:
    """
    Return rotor speeds in rad/s, (N, n), in the order of the vehicle file.

    Below the minimum, and where an output is nan as PX4 writes for one that is off, a rotor
    stands still; over the maximum it turns no faster. A speed that is nan stays so.
    Args: outputs (N, m); actuators Actuators; vehicle a Vehicle or None, for the speeds.
    Raises InputError where the order names an output that is not there, or no speeds are known.
    """
    chosen = chosen_outputs(where, outputs, actuators, vehicle)
    if actuators.kind in TO_SPEED:
        return chosen * TO_SPEED[actuators.kind]
    found = motors_of(where, actuators, vehicle)
    if not found.whole:
        assert vehicle is not None      # else the actuators have speeds
        raise InputError(f'{where}: actuators: the rotor speed at the maximum is not known; give '
                         f'speeds: [low, high] in rad/s, or {vehicle.name} a speed_max (rad/s)')
    return motors.rotor_speeds(found, chosen, _thrust_coefficient(vehicle))


def chosen_outputs(where: str, outputs: ArrayLike, actuators: Actuators, vehicle: Vehicle | None
                   ) -> np.ndarray:
    """Return the outputs (N, n) of the rotors by the order of Actuators; as rotor_speeds."""
    outputs = np.asarray(outputs, float)
    count = outputs.shape[1]
    order = actuators.order or tuple(range(1, (len(vehicle.rotors) if vehicle else count) + 1))
    if max(order) > count:
        raise InputError(f'{where}: actuators: order: there is no output {max(order)}, the record '
                         f'has {count}; name outputs from 1 to {count}')
    if vehicle is not None and len(order) != len(vehicle.rotors):
        raise InputError(f'{where}: actuators: order: {len(order)} outputs for the '
                         f'{len(vehicle.rotors)} rotors of {vehicle.name}; name one for each')
    return outputs[:, [number - 1 for number in order]]


def motors_of(where: str, actuators: Actuators, vehicle: Vehicle | None) -> Motors:
    """
    Return the model.motors.Motors that Actuators stand for.

    Without speeds of their own the map is that of the vehicle's motors, or goes from its lowest
    to its highest speed; where neither is known their gain is not. Raises InputError without a
    vehicle, and where its map is of another kind of output and nothing says how that goes in.
    """
    if actuators.kind in TO_SPEED:
        return Motors(actuators.kind)
    minimum, maximum = _limits(where, actuators, vehicle)
    speeds = actuators.speeds
    if speeds is None:
        if vehicle is None:
            raise InputError(f'{where}: actuators: the rotor speeds at minimum and maximum are '
                             'not known; give speeds: [low, high] in rad/s, or a vehicle with '
                             'them')
        if vehicle.motors is not None and vehicle.motors.gives:
            told = replace(vehicle.motors, kind=actuators.kind, minimum=minimum, maximum=maximum)
            return motors.completed(told, vehicle.thrust_coefficient, vehicle.speed_min,
                                    vehicle.speed_max)
        if not np.isfinite(vehicle.speed_max):
            return Motors(actuators.kind, minimum, maximum,
                          gives='speed' if actuators.curve == 'linear' else 'thrust')
        speeds = vehicle.speed_min, vehicle.speed_max
    low, high = speeds
    if actuators.curve == 'linear':
        return Motors(actuators.kind, minimum, maximum, gives='speed', offset=low,
                      gain=high - low)
    k = _thrust_coefficient(vehicle)
    return Motors(actuators.kind, minimum, maximum, gives='thrust', offset=k * low ** 2,
                  gain=k * (high ** 2 - low ** 2))


def _limits(where: str, actuators: Actuators, vehicle: Vehicle | None) -> tuple[float, float]:
    """Return the outputs at the lowest and at the full speed; InputError."""
    said = {key: getattr(actuators, key) for key in ('minimum', 'maximum')}
    told = None if vehicle is None else vehicle.motors
    ends = KINDS[actuators.kind]
    assert ends is not None     # outputs that are speeds have no map
    usual = dict(zip(said, ends, strict=True))
    if told is not None and told.kind == actuators.kind:
        usual = {key: getattr(told, key) for key in said}
    elif (vehicle is not None and told is not None and told.gives and actuators.speeds is None
          and None in said.values()):
        raise InputError(f'{where}: actuators: kind: {actuators.kind}, and the map of the motors '
                         f'of {vehicle.name} is of {told.kind}; give minimum and maximum, the '
                         'outputs at its ends, or speeds: [low, high] in rad/s')
    limits = {key: usual[key] if value is None else value for key, value in said.items()}
    if limits['maximum'] <= limits['minimum']:
        raise InputError(f'{where}: actuators: maximum: {limits["maximum"]:g} is not above the '
                         f'minimum, {limits["minimum"]:g}')
    return limits['minimum'], limits['maximum']


def _thrust_coefficient(vehicle: Vehicle | None) -> float:
    """Return that of a vehicle; without one it plays no part."""
    return 1.0 if vehicle is None else vehicle.thrust_coefficient


def _source(where: str, role: str, entry: Any) -> Source:
    known = ('topic', 'field', *{'velocity': ('frame',), 'pose': ('child',)}.get(role, ()),
             *(('unit',) if role in UNIT_OF_ROLE else ()))
    schema.check_keys(where, entry, known, ('topic',))
    texts = {key: entry.get(key, '') for key in ('topic', 'field', 'child')}
    for key, value in texts.items():
        if not isinstance(value, str) or not value.isprintable() or (key in entry and not value):
            raise InputError(f'{where}: {key}: expected a name, got {schema.shown(value)}')
    frame = (schema.choice(f'{where}: frame', entry['frame'], ('body', 'world'))
             if 'frame' in entry else '')
    units = ('rad/s', 'rpm') if role == 'rotors' else tuple(
        UNITS.get(UNIT_OF_ROLE.get(role, ''), ()))
    said = schema.choice(f'{where}: unit', entry['unit'], units) if 'unit' in entry else ''
    return Source(texts['topic'], texts['field'], frame, texts['child'].strip('/'), said)


def _columns(where: str, data: object) -> dict[str, Column]:
    if not isinstance(data, dict):
        raise InputError(f'{where}: expected `column of the record: column of the file` lines, '
                         f'got {schema.shown(data)}')
    found = {}
    for name, entry in data.items():
        if name != ATTITUDE and not (isinstance(name, str) and (unit(name) is not None
                                                                or _OUTPUT.fullmatch(name))):
            raise schema.unknown_key(where, name, [*KNOWN, ATTITUDE, 'cmd1', 'rotor1', 'output1'])
        found[name] = _column(f'{where}: {name}', name, entry)
    if found and 't' not in found:
        raise InputError(f"{where}: 't' is missing; name the column with the time")
    return found


def _column(where: str, name: str, entry: object) -> Column:
    if not isinstance(entry, dict):
        entry = {'column': entry}
    velocity = name in ('vx', 'vy', 'vz')
    schema.check_keys(where, entry, ('column', 'unit', *(('frame',) if velocity else ())),
                      ('column',))
    names = entry['column']
    names = tuple(names) if isinstance(names, list) else (names,)
    count = 4 if name == ATTITUDE else 1
    if len(names) != count or not all(isinstance(one, str) and one.strip() for one in names):
        raise InputError(f'{where}: expected {"a list of 4 names" if count == 4 else "the name"} '
                         f'of {"columns" if count == 4 else "a column"} of the file, got '
                         f'{schema.shown(entry["column"])}')
    said = ''
    if 'unit' in entry:
        units = tuple(UNITS.get(unit_of(name), {})) or ('1',)
        turned = tuple(f'-{one}' for one in units) if name != 't' else ()
        said = str(entry['unit'])
        if not (name == 't' and COUNTED.fullmatch(said)):
            said = schema.choice(f'{where}: unit', said, (*units, *turned))
    frame = schema.choice(f'{where}: frame', entry.get('frame', 'world'), ('world', 'body'))
    return Column(tuple(one.strip() for one in names), said, frame)
