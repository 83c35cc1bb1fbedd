# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A vehicle back into a simulator's file: what changes, and what the file cannot have."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
import math
from typing import Any

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import Values
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import highest_voltage
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files import out_mjcf, out_sdf, out_urdf
from quad_ident_ros.vehicle_files.edit_xml import Change, differs, Edited, SAME
from quad_ident_ros.vehicle_files.kinds import kind_of, KINDS
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.reading import Draft, finished
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.wanted import Fate, Fates, fates_of, NEEDS, wanted_of, WAYS

PLACES = 1e-6       # m between places of rotors that are told apart: files round them


@dataclass(frozen=True)
class Target:
    """A simulator to write for: the kind of its files, their endings, and what writes them."""

    kind: str
    endings: tuple[str, ...]
    write: Callable[[Edited, Base], dict[str, str]]
    one_lag: bool = False


TARGETS = {'gazebo': Target('sdf', ('.sdf', '.world', '.xml'), out_sdf.write),
           'mujoco': Target('mjcf', ('.xml', '.mjcf'), out_mjcf.write, one_lag=True),
           'urdf': Target('urdf', ('.urdf', '.xml'), out_urdf.write)}


@dataclass(frozen=True)
class Export:
    """What comes of an export: the text of the file, its changes, remarks on them, and fates."""

    text: str
    changes: tuple[Change, ...]
    remarks: tuple[str, ...]
    fates: Fates


def export(vehicle: Vehicle, to: str, source: Source, sag: float | None = None) -> Export:
    """
    Return a base file with the numbers of a vehicle, and what becomes of each effect.

    Args: to: of TARGETS; source: the base file; sag: mean share of the thrust that battery_sag
    leaves, None where it is not known. Raises InputError in one line.
    """
    target, kind = TARGETS[to], kind_of(source.text)
    expected = next(each for each in KINDS if each.name == target.kind)
    if kind is not expected:
        what = kind.title if kind else 'of no kind that is known'
        raise InputError(f'{source.path}: this is {what}; --to {to} takes {expected.title} as '
                         '--base')
    draft = kind.read(source)
    reading = finished(draft, kind.title)
    given = reading.vehicle
    rotors = draft.data.get('rotors')
    if rotors is not None and len(rotors) != len(vehicle.rotors):
        raise InputError(f'{source.path}: it has {len(rotors)} rotors, the vehicle has '
                         f'{len(vehicle.rotors)}; give the file that it was read from')
    effects = given.effects if given else draft.effects(vehicle)
    wanted = wanted_of(vehicle, sag)
    base = Base(source, draft.data['mass'], _matrix(draft.data['inertia']),
                draft.data.get('thrust_coefficient'), draft.data.get('torque_coefficient'),
                draft.data.get('speed_max'), effects, wanted)
    edited = Edited(source.text)
    lacking = target.write(edited, base)
    fates = fates_of(vehicle, effects, lacking, target.one_lag, sag)
    more = (*_constants(vehicle, draft, lacking), *_remaining(vehicle, effects, lacking))
    return Export(edited.result(), tuple(edited.changes), tuple(edited.remarks),
                  replace(fates, not_carried=(*fates.not_carried, *more)))


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
            raise InputError('--flight: battery_sag hangs on the voltage, which these flights do '
                             'not have all; give flights with vbat')
        time = record.t - record.t[0]
        left = 1.0 - (sag.get('per_second', 0.0) + sag.get('drain', 0.0)) * time
        if by_voltage and full is not None:
            voltage = record.columns['vbat']
            left = left - sag.get('per_volt', 0.0) * (full - voltage)
            left = left * np.maximum(voltage / full, 0.0) ** sag.get('exponent', 0.0)
        shares.append(np.maximum(left, 0.0))
    mean = float(np.mean(np.concatenate(shares)))
    if not mean > 0.0:
        raise InputError('--flight: battery_sag leaves no thrust in these flights; give shorter '
                         'ones')
    return mean


def _matrix(inertia: list[Any]) -> np.ndarray:
    """Return the inertia (3, 3) of a mapping, moments or rows."""
    values = np.array(inertia, float)
    return np.diag(values) if values.ndim == 1 else values


def _constants(vehicle: Vehicle, draft: Draft, lacking: dict[str, str]) -> list[Fate]:
    """Return the constants that are others than those of the file, and that it cannot have."""
    data, found = draft.data, []
    for key, name in (('mass', 'mass'), ('inertia', 'inertia'), ('thrust', 'thrust_coefficient'),
                      ('torque', 'torque_coefficient'), ('speed_max', 'speed_max')):
        value = getattr(vehicle, name)
        old = data.get(name, math.inf if key == 'speed_max' else None)
        if key == 'inertia':
            matrix = vehicle.inertia_matrix
            changed = bool(np.max(np.abs(matrix - _matrix(data[name])))
                           > SAME * np.max(np.abs(matrix)))
        else:
            changed = value != old and differs(old, value)
        if key in lacking and changed:
            found.append(Fate(name, '', lacking[key]))
    for name, reason in (('gravity', 'it is of the world; set it there'),
                         ('speed_min', 'the file has no lowest speed of a rotor'),
                         ('rotor_inertia', NEEDS['rotor_gyro']),
                         ('rotor_radius', 'only what flies near the ground hangs on it')):
        if differs(data.get(name, 0.0), getattr(vehicle, name)):
            found.append(Fate(name, '', reason))
    for name in ('linear_drag', 'rotational_drag'):
        if any(getattr(vehicle, name)):
            found.append(Fate(name, '', 'the format has no such drag'))
    if 'rotors' in data and any(
            math.dist(rotor['position'], other.position) > PLACES
            or rotor.get('spin', other.spin) != other.spin
            for rotor, other in zip(data['rotors'], vehicle.rotors, strict=True)):
        found.append(Fate('rotors', '', 'places and spins of rotors are not changed; give the '
                          'file that the vehicle was read from'))
    return found


def _remaining(vehicle: Vehicle, effects: Values, lacking: dict[str, str]) -> list[Fate]:
    """Return the effects that a file has by itself, the vehicle has not, and that stay in it."""
    found = []
    for effect in effects:
        keys = {key for (name, _), way in WAYS.items() if name == effect for key in way.keys}
        reason = next((lacking[key] for key in keys if key in lacking), '')
        if effect not in vehicle.effects and (reason or not keys):
            found.append(Fate(effect, '', 'the vehicle has none, that of the file stays: '
                              + (reason or NEEDS[effect])))
    return found
