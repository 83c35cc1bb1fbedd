# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What was read of a vehicle in a simulator's file, from where, and what is missing."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
import math
from typing import Any

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.effects.registry import mapping, Values, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.quantities import UNITS
from quad_ident_ros.model.vehicle import Vehicle, vehicle_from_mapping
from quad_ident_ros.vehicle_files.bodies import Body, check_body, principal_tilt

TORQUE = 'torque_coefficient'
NEEDED = ('mass', 'inertia', 'gravity', 'thrust_coefficient', TORQUE, 'rotors')
"""Keys of the vehicle file without which there is no vehicle."""
SPINS = 'spins'
"""Stands for the spins of the rotors where their places are known."""
RATIO = 'torque_over_thrust'
"""Stands for the torque coefficient, where a thrust coefficient is known."""
SETTABLE = {
    'mass': 'kg', 'inertia': '[Ixx, Iyy, Izz] or 3 rows of 3, kg m2', 'gravity': 'm/s2',
    'thrust_coefficient': 'N/(rad/s)^2', 'torque_coefficient': 'N m/(rad/s)^2',
    'rotors': '[{position: [x, y, z], spin: 1}, ...] in m from the centre of mass',
    RATIO: 'm, in the place of torque_coefficient',
    SPINS: '[1, -1, ...], 1 where the reaction torque on the body is about +z',
    'rotor_radius': 'm', 'speed_min': 'rad/s', 'speed_max': 'rad/s'}
"""What may be supplied where a file does not have it, and how it is written."""
FULL_SPEED = 1000.0     # rad/s at full thrust, where a file knows thrusts and no speeds
UNLIMITED = 10.0    # times the thrust at hover that stand for no limit: no flight gets there
NOTICED = 1e-3          # m of the centre of mass from the origin of the file
FEW_PRODUCTS = 1e-6     # of the largest moment of inertia: less is rounding


@dataclass(frozen=True)
class Entry:
    """One thing that was read: key of the vehicle file, value, unit, and its place in the file."""

    key: str
    value: Any
    unit: str
    place: str


@dataclass(frozen=True)
class Reading:
    """
    What came of a file: the vehicle, None where something needed is missing.

    kind: of what kind the file is; read: of Entry; missing: {key: what is missing and how to
    supply it}; assumed: what was taken as given, and why.
    """

    path: str
    kind: str
    vehicle: Vehicle | None
    read: tuple[Entry, ...]
    missing: dict[str, str]
    assumed: tuple[str, ...]


@dataclass
class Draft:
    """
    A vehicle on its way from a file: what the reader of a kind fills in.

    data: as a vehicle file has it, rotors without a spin where it is not known; effects: those of
    the nominal vehicle, which their numbers may hang on.
    """

    where: str
    name: str
    data: dict[str, Any] = field(default_factory=dict)
    read: list[Entry] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    reasons: dict[str, str] = field(default_factory=dict)
    effects: Callable[[Vehicle], Values] = field(default=lambda _: {})

    def take(self, key: str, value: Any, unit: str, place: str) -> None:
        """Enter a value of the vehicle file and where it was read."""
        self.data[key] = value
        self.note(key, value, unit, place)

    def note(self, key: str, value: Any, unit: str, place: str) -> None:
        """Say that something was read that is no key of the vehicle file."""
        self.read.append(Entry(key, value, unit, place))

    def take_gravity(self, value: float, place: str) -> None:
        """Enter the gravity, m/s^2; InputError where it is not a number above 0."""
        if not value > 0.0:
            raise InputError(f'{self.where}: {place}: without gravity no flight is in balance; '
                             'state that of the Earth')
        self.take('gravity', value, 'm/s2', place)

    def take_body(self, body: Body, place: str, inertia_place: str = '') -> None:
        """Enter mass and inertia; rotors and other places count from the centre of mass."""
        inertia_place = inertia_place or place
        if body.mass <= 0.0:
            raise InputError(f'{self.where}: {place}: the vehicle has no mass: no body of it has '
                             'an inertial with a mass; give it one')
        remark = check_body(f'{self.where}: {inertia_place}', body)
        if remark:
            self.assumed.append(f'{inertia_place}: {remark}')
        self.take('mass', float(body.mass), 'kg', place)
        self.take('inertia', [float(value) for value in np.diag(body.inertia)], 'kg m2',
                  inertia_place)
        xy, xz, yz = (float(value) + 0.0 for value in body.inertia[[0, 0, 1], [1, 2, 2]])
        if max(abs(xy), abs(xz), abs(yz)) > FEW_PRODUCTS * np.max(np.diag(body.inertia)):
            xx, yy, zz = self.data['inertia']
            self.data['inertia'] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
            self.note('products of inertia', [xy, xz, yz], 'kg m2', inertia_place)
            self.note('tilt of the principal axes', principal_tilt(body.inertia), 'rad',
                      inertia_place)
        if np.linalg.norm(body.centre) > 0.0:
            self.note('centre of mass', [round(float(value), 9) for value in body.centre], 'm',
                      place)
        if np.linalg.norm(body.centre) > NOTICED:
            self.assumed.append(
                'positions of records are taken as those of the centre of mass, which lies '
                f'{1000 * np.linalg.norm(body.centre):.3g} mm from the origin of {place}')

    def take_rotors(self, positions: Sequence[np.ndarray], spins: Sequence[int | None],
                    place: str) -> None:
        """Enter the rotors: places from the centre of mass, m, and spins, None where unknown."""
        rotors: list[dict[str, Any]] = [
            {'position': [round(float(value), 12) + 0.0 for value in position],
             **({} if spin is None else {'spin': int(spin)})}
            for position, spin in zip(positions, spins, strict=True)]
        self.take('rotors', rotors, 'm', place)


def finished(draft: Draft, kind: str, supplied: Mapping[str, Any] | None = None) -> Reading:
    """
    Return the Reading of a Draft, with what the user supplied where the file has nothing.

    Args: kind: what kind the file is; supplied: {key of SETTABLE: value}. Raises InputError for a
    value that no vehicle can have, with its place in the file.
    """
    data, read = dict(draft.data), list(draft.read)
    for key, value in (supplied or {}).items():
        _supply(draft, data, read, key, value)
    ratio = data.pop(RATIO, None)
    if ratio is not None and 'thrust_coefficient' in data:
        # What --set gives may be text still: YAML reads 1e-5 as such.
        data['torque_coefficient'] = math.prod(
            schema.number(f'--set {key}', value, 0.0, exclusive=True)
            for key, value in (('thrust_coefficient', data['thrust_coefficient']),
                               (RATIO, ratio)))
    missing = {key: _asked(key, draft) for key in NEEDED if key not in data}
    if _without_spins(data.get('rotors')):
        missing[SPINS] = _asked(SPINS, draft)
    if missing:
        return Reading(draft.where, kind, None, tuple(read), missing,
                       tuple(dict.fromkeys((*draft.assumed, *_odd(data.get('rotors'), draft)))))
    try:
        vehicle = vehicle_from_mapping({'name': draft.name, **data}, draft.where)
        theta = vector(draft.effects(vehicle), vehicle, f'{draft.where}: effects')
    except InputError as error:
        raise InputError(f'{error}{_read_from(str(error), draft)}') from None
    vehicle = replace(vehicle, effects=mapping(theta))
    return Reading(draft.where, kind, vehicle, tuple(read), {},
                   tuple(dict.fromkeys((*draft.assumed, *_odd(vehicle.rotors, draft)))))


def _odd(rotors: Any, draft: Draft) -> list[str]:
    """Return what to say of a number of rotors that no usual vehicle has."""
    count = len(rotors) if isinstance(rotors, list | tuple) else 0
    if count % 2 == 0:
        return []
    place = next((entry.place for entry in draft.read if entry.key == 'rotors'), '--set')
    return [f'all {count} rotors of {place} carry the vehicle, an odd number: if one of them is '
            'none, such as a guard or a spare, give it another name or take it out']


def needed_vehicle(reading: Reading) -> Vehicle:
    """Return the vehicle of a Reading; InputError that asks for what the file does not have."""
    if reading.vehicle is None:
        sets = ' '.join(f'--set {key}=...' for key in reading.missing)
        raise InputError(f'{reading.path}: {reading.kind} without {", ".join(reading.missing)}; '
                         f'run `quad_ident vehicle {reading.path} {sets} -o vehicle.yaml` and '
                         'give that file')
    return reading.vehicle


def per_sum_of_speeds(coefficient: float, vehicle: Vehicle) -> float:
    """Return, per air velocity at hover, what a coefficient per rotor speed makes, all rotors."""
    return coefficient * len(vehicle.rotors) * vehicle.hover_speed


def most_speed(vehicle: Vehicle) -> float:
    """Return the highest speed of a rotor, rad/s, one that no flight reaches where none is set."""
    if math.isfinite(vehicle.speed_max):
        return vehicle.speed_max
    return math.sqrt(UNLIMITED) * vehicle.hover_speed


def thrusts_as_commands(draft: Draft, highest: float, ratio: float | None, place: str,
                        lowest: float = 0.0, signal: tuple[float, float] | None = None) -> None:
    """
    Enter the coefficients and `motors` of a simulator whose commands are thrusts, not speeds.

    Args: lowest, highest: thrust of a rotor, N; ratio: torque over thrust, m, or None; signal:
    commands at no and at full thrust, the thrusts themselves where None.
    """
    coefficient = highest / FULL_SPEED ** 2
    draft.take('thrust_coefficient', coefficient, 'N/(rad/s)^2', place)
    if ratio is not None:
        draft.take('torque_coefficient', ratio * coefficient, 'N m/(rad/s)^2', place)
    low, high = signal or (lowest, highest)
    if lowest > 0.0:
        draft.take('speed_min', FULL_SPEED * math.sqrt(lowest / highest), 'rad/s',
                   f'taken for {place}')
    draft.take('speed_max', FULL_SPEED, 'rad/s', f'taken for {place}')
    draft.data['motors'] = {'kind': 'normalised', 'minimum': low, 'maximum': high,
                            'thrust': {'offset': lowest, 'gain': highest - lowest,
                                       'exponent': 1.0}}
    draft.assumed.append(
        f'a command is a thrust here and the file has no speeds: {FULL_SPEED:g} rad/s stand for '
        f'the highest, {highest:.6g} N; `motors` has the map of commands from {low:g} to '
        f'{high:g}; records in rad/s need the coefficients and speed_max of the rotors in the '
        'vehicle file, and no motors in it')


def _supply(draft: Draft, data: dict[str, Any], read: list[Entry], key: str, value: Any) -> None:
    """Enter what the user supplies; InputError where the file has it, or nobody knows it."""
    if key not in SETTABLE:
        raise schema.unknown_key('--set', key, SETTABLE)
    rotors = data.get('rotors')
    has = (rotors is not None and not _without_spins(rotors) if key == SPINS else
           any(entry.key == (TORQUE if key == RATIO else key) for entry in read))
    if has:
        place = next((entry.place for entry in read
                      if entry.key == {SPINS: 'rotors', RATIO: TORQUE}.get(key, key)),
                     draft.where)
        raise InputError(f'--set {key}: the file has it, at {place}; change it there, or in the '
                         'vehicle file that -o writes')
    if key != SPINS:
        data[key] = value
    elif rotors is None:
        raise InputError('--set spins: the file has no rotors; give --set rotors, places and '
                         'spins together')
    elif not isinstance(value, list) or len(value) != len(rotors):
        raise InputError(f'--set spins: expected a list of {len(rotors)}, one a rotor, got '
                         f'{schema.shown(value)}')
    else:
        data['rotors'] = [{**rotor, 'spin': spin}
                          for rotor, spin in zip(rotors, value, strict=True)]
    read.append(Entry(key, value, UNITS.get(key, ''), '--set'))


def _without_spins(rotors: Any) -> bool:
    """Whether the places of the rotors are known and a spin is not."""
    return isinstance(rotors, list) and any(
        isinstance(rotor, dict) and 'spin' not in rotor for rotor in rotors)


def _asked(key: str, draft: Draft) -> str:
    """Return what to say of something that is missing: why, and how to supply it."""
    reason = draft.reasons.get(key, 'the file does not have it')
    other = f', or {RATIO}, m' if key == TORQUE else ''
    return f'{reason}; --set {key}={SETTABLE[key]}{other}'


def _read_from(message: str, draft: Draft) -> str:
    """Return the place in the file of the key that a message is about, or ''."""
    rest = message.removeprefix(f'{draft.where}: ')
    key = rest.partition(':')[0].partition('[')[0]
    place = next((entry.place for entry in draft.read if entry.key == key), '')
    return f'; it was read from {place}' if place and rest != message else ''
