# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A vehicle back into a simulator's file: what changes, and what the file cannot have."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
import math

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.battery_sag_discharge import ZONE_TIME
from quad_ident_ros.effects.registry import titled, Values
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import highest_voltage
from quad_ident_ros.model.motors import are_thrusts
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.bodies import Body, is_body, nearest_body
from quad_ident_ros.vehicle_files.edits import Change, differs, Edits, SAME
from quad_ident_ros.vehicle_files.kinds import Kind, kind_of, KINDS
from quad_ident_ros.vehicle_files.known import with_errors
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import MOMENTS, PRODUCTS
from quad_ident_ros.vehicle_files.reading import finished, FULL_SPEED
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.speed_unit import counted, unit_of
from quad_ident_ros.vehicle_files.target import Code, Target
from quad_ident_ros.vehicle_files.targets import TARGETS
from quad_ident_ros.vehicle_files.wanted import wanted_of
from quad_ident_ros.vehicle_files.ways import Fate, Fates, fates_of, NEEDS, WAYS, why_not

PLACES = 1e-6       # m between places of rotors that are told apart: files round them


@dataclass(frozen=True)
class Export:
    """
    What comes of an export: the text of the file, its changes, remarks on them, and fates.

    base: what they change, the user's own file or a new one with the constants of the vehicle;
    unit: what 1 rad/s of the vehicle is in the file; code: the Code beside it, or None.
    """

    text: str
    changes: tuple[Change, ...]
    remarks: tuple[str, ...]
    fates: Fates
    base: Source
    unit: float
    code: Code | None


def export(vehicle: Vehicle, to: str, source: Source | None = None, sag: float | None = None,
           name: str = 'the model') -> Export:
    """
    Return a file of a simulator with the numbers of a vehicle, and what becomes of each effect.

    Args: to: of TARGETS; source: the file whose numbers change, None for a new one; sag: mean
    share of the thrust that battery_sag leaves, None where it is not known; name: of the file that
    is written, for the code beside it. Raises InputError in one line.
    """
    target = TARGETS[to]
    if source is None:
        source = Source(f'new {to} file', target.new(_real(vehicle)))
    kind = _kind(target, to, source)
    draft = kind.read(source)
    given = finished(draft, kind.title).vehicle
    rotors = draft.data.get('rotors')
    if rotors is not None and len(rotors) != len(vehicle.rotors):
        raise InputError(f'{source.path}: it has {len(rotors)} rotors, the vehicle has '
                         f'{len(vehicle.rotors)}; give the file that it was read from')
    unit = unit_of(draft, vehicle)
    stated, vehicle = vehicle, counted(vehicle, unit)
    effects = given.effects if given else draft.effects(vehicle)

    def base_of(one: Vehicle) -> Base:
        return Base(source, draft, effects, wanted_of(one, sag, target.holds))

    base = base_of(vehicle)
    edits = target.write(base)
    changes = with_errors(edits.changes, stated, lambda one: target.write(
        base_of(counted(one, unit))).changes)
    fates = fates_of(vehicle.effects, effects, target.holds, edits.lacking, edits.nearest, sag)
    more, near = _constants(vehicle, base, target, edits), _nearest(vehicle, edits, target)
    fates = replace(fates, nearest=(*fates.nearest, *near), not_carried=(
        *fates.not_carried, *more, *_remaining(vehicle, effects, target, edits)))
    if (are_thrusts(stated.motors) and stated.speed_max == FULL_SPEED
            and 'motors' not in draft.data):
        edits.remarks.append(
            'the vehicle file has thrusts for commands, and no speeds of its rotors: '
            f'{FULL_SPEED:g} rad/s stand for the most, and the speeds of this file count likewise')
    code = target.code(vehicle, base, name) if target.code else None
    if code is not None:
        fates = fates.with_code([*code.forms, *((each, '') for each in code.constants)],
                                'by the code beside the file')
    return Export(edits.result(), changes, tuple(edits.remarks), fates, source, unit,
                  code)


def _real(vehicle: Vehicle) -> Vehicle:
    """Return a vehicle with the nearest inertia that a body can have, beyond rounding."""
    body = Body(vehicle.mass, np.zeros(3), vehicle.inertia_matrix)
    if is_body(body):
        return vehicle
    near = nearest_body(body).inertia
    xy, xz, yz = (float(near[at]) for at in PRODUCTS)
    return replace(vehicle, inertia=tuple(float(near[at]) for at in MOMENTS),
                   products=(xy, xz, yz))


def _kind(target: Target, to: str, source: Source) -> Kind:
    """Return the kind of a base file; InputError where no target has it."""
    kind = kind_of(source.text)
    expected = next(each for each in KINDS if each.name == target.kind)
    if kind is not expected:
        what = kind.title if kind else 'a file of an unknown kind'
        raise InputError(f'{source.path}: this is {what}; --to {to} takes {expected.title} as '
                         '--base')
    return kind


def mean_left(vehicle: Vehicle, records: Iterable[FlightRecord]) -> float | None:
    """
    Return the mean share of the thrust that battery_sag leaves in flights, at the power of hover.

    None where the vehicle has no battery_sag. Raises InputError where it hangs on the voltage and
    none is recorded.
    """
    sag = vehicle.effects.get('battery_sag')
    if sag is None:
        return None
    records = list(records)
    full = highest_voltage(records)
    by_voltage = 'per_volt' in sag or 'exponent' in sag
    shares = []
    for record in records:
        if by_voltage and (full is None or not record.has('vbat')):
            raise InputError(f'--flight: {titled("battery_sag")} depends on the voltage, which '
                             'some of these flights do not have; give flights with vbat')
        time = record.t - record.t[0]
        left = 1.0 - sum(sag.get(key, 0.0) for key in ('per_second', 'drain', 'slope')) * time
        left -= sag.get('bend', 0.0) * time ** 2
        left -= sag.get('zone', 0.0) * (1.0 - np.exp(-time / sag.get('zone_time', ZONE_TIME)))
        if by_voltage and full is not None:
            voltage = record.columns['vbat']
            left = left - sag.get('per_volt', 0.0) * (full - voltage)
            left = left * np.maximum(voltage / full, 0.0) ** sag.get('exponent', 0.0)
        shares.append(np.maximum(left, 0.0))
    mean = float(np.mean(np.concatenate(shares)))
    if not mean > 0.0:
        raise InputError(f'--flight: {titled("battery_sag")} leaves no thrust in these flights; '
                         'give shorter ones')
    return mean


def _constants(vehicle: Vehicle, base: Base, target: Target, edits: Edits) -> list[Fate]:
    """Return the constants that are others than those of the file, and that it cannot have."""
    data, lacking, found = base.draft.data, edits.lacking, []
    for key, name in (('mass', 'mass'), ('inertia', 'inertia'), ('thrust', 'thrust_coefficient'),
                      ('torque', 'torque_coefficient'), ('speed_max', 'speed_max')):
        value = getattr(vehicle, name)
        old = data.get(name, math.inf if key == 'speed_max' else None)
        if key == 'inertia':
            matrix = vehicle.inertia_matrix
            changed = bool(np.max(np.abs(matrix - base.inertia)) > SAME * np.max(np.abs(matrix)))
        else:
            changed = value != old and differs(old, value)
        if key in lacking and changed:
            found.append(Fate(name, '', lacking[key]))
    for name, reason in (('gravity', 'it is of the world; set it there'),
                         ('speed_min', 'the lowest speed of a rotor is not changed'),
                         ('rotor_inertia', NEEDS['rotor_gyro']),
                         ('rotor_radius', 'only flight near the ground depends on it')):
        value = getattr(vehicle, name)
        if value and differs(data.get(name, 0.0), value):
            found.append(Fate(name, '', reason))
    given = data.get('linear_drag', (0.0, 0.0, 0.0))
    if target.holds & {'linear_drag', 'rotor_drag'} <= lacking.keys() and any(
            differs(old, new) for old, new in zip(given, vehicle.linear_drag, strict=True)):
        found.append(Fate('linear_drag', '', 'that of the simulator stays' if any(given) else
                          'the format has no such drag'))
    if any(vehicle.rotational_drag):
        found.append(Fate('rotational_drag', '', 'the format has no such drag'))
    if vehicle.residual is not None:
        found.append(Fate('residual', '', 'the format has no force by state and command; fly '
                          'simulates it'))
    if 'rotors' in data and any(
            math.dist(rotor['position'], other.position) > PLACES
            or rotor.get('spin', other.spin) != other.spin
            for rotor, other in zip(data['rotors'], vehicle.rotors, strict=True)):
        found.append(Fate('rotors', '', lacking.get(
            'rotors', 'those of the file stay, with factors on their moments alone; give the file '
            'that the vehicle was read from')))
    return found


def _nearest(vehicle: Vehicle, edits: Edits, target: Target) -> list[Fate]:
    """Return the constants that the file has the nearest of."""
    if not any(vehicle.linear_drag):
        return []
    if 'linear_drag' in target.holds:
        lost = edits.nearest.get('linear_drag')
        return [Fate('linear_drag', '', lost)] if lost else []
    if 'rotor_drag' in target.holds and 'rotor_drag' not in edits.lacking:
        return [Fate('linear_drag', '', 'as a drag of the rotors: the mean of x and y, scaled by '
                     'rotor speed; along z nothing')]
    return []


def _remaining(vehicle: Vehicle, effects: Values, target: Target, edits: Edits) -> list[Fate]:
    """Return the effects that a file has by itself, the vehicle has not, and that stay in it."""
    found = []
    for effect in effects:
        keys = {key for (name, _), ways in WAYS.items() if name == effect
                for way in ways if set(way.keys) <= target.holds for key in way.keys}
        reason = next((edits.lacking[key] for key in keys if key in edits.lacking), '')
        if effect not in vehicle.effects and (reason or not keys):
            found.append(Fate(effect, '', 'the vehicle has none, that of the file stays: '
                              + (reason or why_not(effect))))
    return found
