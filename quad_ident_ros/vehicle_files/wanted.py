# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a simulator's file is to say of a vehicle, and which of its effects are in that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
import math
from typing import Literal

import numpy as np

from quad_ident_ros.effects.registry import FORMS, Values
from quad_ident_ros.model.vehicle import Vehicle

Key = Literal['mass', 'centre', 'inertia', 'thrust', 'torque', 'speed_max', 'rise', 'fall',
              'rotor_drag']
Keys = tuple[Key, ...]
LAGS: Keys = ('rise', 'fall')


@dataclass(frozen=True)
class Wanted:
    """
    Numbers that a file may have, with the effects in them.

    mass kg; centre (3,) m, of mass, from that of the file; inertia (3, 3) kg m^2 about the centre
    of mass; thrust N/(rad/s)^2; torque N m/(rad/s)^2; speed_max rad/s; rise, fall s, time
    constants; rotor_drag kg/rad, force per speed of a rotor and air velocity; stds: relative
    standard errors of thrust and torque, standard errors of mass and of the moments of inertia,
    by key; sources: what each comes from.
    """

    mass: float
    centre: np.ndarray
    inertia: np.ndarray
    thrust: float
    torque: float
    speed_max: float
    rise: float
    fall: float
    rotor_drag: float
    stds: dict[str, tuple[float, ...]]
    sources: dict[str, str]


@dataclass(frozen=True)
class Way:
    """How a form goes into numbers: which, and what is lost, '' where nothing is."""

    keys: Keys
    lost: str = ''


_MEAN = 'its mean factor on the thrust coefficient, the same at all times'
_AT_HOVER = 'its factor at hover on the thrust coefficient, the same at all speeds'
_PLANE = 'the mean of x and y, scaled by rotor speed; along z nothing'
WAYS: dict[tuple[str, str], Way] = {
    ('motor_lag', 'first_order'): Way(LAGS),
    ('motor_lag', 'rise_fall'): Way(LAGS),
    ('motor_lag', 'second_order'): Way(LAGS, 'its mean lag as a time constant'),
    ('rotor_drag', 'by_speed'): Way(('rotor_drag',)),
    ('rotor_drag', 'axes'): Way(('rotor_drag',), _PLANE),
    ('rotor_drag', 'axes_by_speed'): Way(('rotor_drag',), _PLANE),
    ('battery_sag', 'voltage'): Way(('thrust',), _MEAN),
    ('battery_sag', 'time'): Way(('thrust',), _MEAN),
    ('battery_sag', 'voltage_power'): Way(('thrust',), _MEAN),
    ('battery_sag', 'time_and_load'): Way(('thrust',), _MEAN),
    ('thrust_scale', 'factor'): Way(('thrust',), 'a factor on the thrust coefficient, which is '
                                    'the same motion'),
    ('thrust_scale', 'exponent'): Way(('thrust',), _AT_HOVER),
    ('thrust_scale', 'offset'): Way(('thrust',), _AT_HOVER),
    ('mass_offset', 'at_centre'): Way(('mass',), 'a part of the mass, which is the same motion'),
    ('inertia_mismatch', 'factors'): Way(('inertia',), 'a part of the inertia, which is the same '
                                         'motion'),
    ('inertia_mismatch', 'moments'): Way(('inertia',), 'the inertia over the factors, which '
                                         'differs in the gyroscopic moment'),
    ('com_offset', 'fixed'): Way(('centre',), 'the place of the centre of mass, which is the same '
                                 'motion'),
}
"""Of effects that a file of numbers can have; what is exact has nothing lost."""

NEEDS: dict[str, str] = {
    'actuation_delay': 'the format has no delay of commands; delay them in what sends them',
    'body_drag': 'the format has no drag with the square of the velocity of the air',
    'wind': 'a wind is of the world, not of the vehicle; state it there',
    'inflow': 'the format has no loss of thrust with the velocity of the air',
    'ground_effect': 'the format has no thrust that hangs on the height',
    'rotor_fault': 'one weak rotor needs a constant of its own, which is not written yet',
    'rotor_gyro': 'it comes from the inertia of rotor bodies, which is not changed',
    'blade_flapping': 'the format has no moment of the hubs across the velocity of the air',
    'attitude_misalignment': 'it is one of the sensors: turn that of the attitude or the IMU',
    'gyro_bias': 'it is one of the sensors: set it as the bias of the IMU',
    'motor_lag': 'the format has no limit to the rate of the rotor speed'}
"""Why an effect without a way is not carried."""


def wanted_of(vehicle: Vehicle, sag: float | None) -> Wanted:
    """
    Return what a file is to say of a vehicle with its effects.

    Args: sag: mean share of the thrust that battery_sag leaves, None where it is not known.
    """
    effects = vehicle.effects
    scale = effects.get('thrust_scale', {})
    factor = math.prod(scale.get(key, 1.0) for key in ('factor', 'hover_factor', 'at_hover'))
    if sag is not None:
        factor *= sag
    mismatch = effects.get('inertia_mismatch', {})
    moments = np.array(vehicle.inertia) * [
        mismatch.get(f'factor_{axis}', 1.0) / mismatch.get(moment, 1.0)
        for axis, moment in zip('xyz', ('arms_y', 'arms_x', 'torque'), strict=True)]
    rise, fall = _lags(effects)
    drag = effects.get('rotor_drag', {})
    per_speed = drag.get('coefficient', 0.0) + sum(
        0.5 * drag.get(key, 0.0) for key in ('x', 'y', 'x_by_speed', 'y_by_speed'))
    shift = effects.get('com_offset', {})
    return Wanted(
        mass=vehicle.mass + effects.get('mass_offset', {}).get('mass', 0.0),
        centre=np.array([shift.get(axis, 0.0) for axis in 'xyz']),
        inertia=replace(vehicle, inertia=tuple(moments)).inertia_matrix,
        thrust=factor * vehicle.thrust_coefficient, torque=vehicle.torque_coefficient,
        speed_max=vehicle.speed_max, rise=rise, fall=fall,
        rotor_drag=per_speed / (len(vehicle.rotors) * vehicle.hover_speed),
        stds=_stds(vehicle, moments), sources=_sources(vehicle, sag))


def forms_of(effects: Values) -> list[tuple[str, str, dict[str, float]]]:
    """Return (effect, form, its values) of all forms that act."""
    found = []
    for effect, form in FORMS:
        values = effects.get(effect, {})
        inside = {parameter.name: values[parameter.name] for parameter in form.parameters
                  if parameter.name in values}
        if inside:
            found.append((effect, form.name, inside))
    return found


def _lags(effects: Values) -> tuple[float, float]:
    """Return the time constants up and down, s, of the first form of a lag that acts."""
    lag = effects.get('motor_lag', {})
    if 'time_constant' in lag:
        return lag['time_constant'], lag['time_constant']
    if 'rise' in lag or 'fall' in lag:
        return lag.get('rise', 0.0), lag.get('fall', 0.0)
    return lag.get('mean_lag', 0.0), lag.get('mean_lag', 0.0)


def _stds(vehicle: Vehicle, moments: np.ndarray) -> dict[str, tuple[float, ...]]:
    """Return the standard errors of what constants with one become."""
    known = vehicle.uncertainty
    found: dict[str, tuple[float, ...]] = {}
    for key, name in (('thrust', 'thrust_coefficient'), ('torque', 'torque_coefficient')):
        std = known.get(name)
        if isinstance(std, float):
            found[key] = (std / getattr(vehicle, name),)
    for key in ('mass', 'speed_max'):
        std = known.get(key)
        if isinstance(std, float):
            found[key] = (std,)
    std = known.get('inertia')
    if isinstance(std, tuple):
        found['inertia'] = tuple((each or 0.0) * moment / value for each, moment, value in
                                 zip(std, moments, vehicle.inertia, strict=True))
    return found


def _sources(vehicle: Vehicle, sag: float | None) -> dict[str, str]:
    """Return the constant and the effects that each number comes from."""
    names: dict[str, list[str]] = {
        'mass': ['mass'], 'centre': [], 'inertia': ['inertia'], 'thrust': ['thrust_coefficient'],
        'torque': ['torque_coefficient'], 'speed_max': ['speed_max'], 'rise': [], 'fall': [],
        'rotor_drag': []}
    for effect, form, _ in forms_of(vehicle.effects):
        way = WAYS.get((effect, form))
        if way is not None and (effect != 'battery_sag' or sag is not None):
            for key in way.keys:
                if effect not in names[key]:
                    names[key].append(effect)
    names['centre'] = names['centre'] or names['mass']
    usual = {'rise': 'motor_lag', 'fall': 'motor_lag',
             'rotor_drag': 'rotor_drag'}
    return {key: ', '.join(found) or f'no {usual[key]}' for key, found in names.items()}


@dataclass(frozen=True)
class Fate:
    """What becomes of an effect or a constant: its name, its form or '', and why."""

    name: str
    form: str
    reason: str


@dataclass(frozen=True)
class Fates:
    """All effects, and the constants that changed, by what becomes of them."""

    carried: tuple[Fate, ...]
    nearest: tuple[Fate, ...]
    not_carried: tuple[Fate, ...]


def fates_of(vehicle: Vehicle, base_effects: Values, lacking: Mapping[str, str],
             one_lag: bool, sag: float | None) -> Fates:
    """
    Return what becomes of each form of each effect of a vehicle: one of three.

    Args: base_effects: what the file has by itself; lacking: {key of Wanted, or an effect: why
    this file cannot have it}; one_lag: whether it has one time constant for up and down.
    """
    carried: list[Fate] = []
    nearest: list[Fate] = []
    not_carried: list[Fate] = []
    lags = [form for effect, form, _ in forms_of(vehicle.effects)
            if effect == 'motor_lag' and (effect, form) in WAYS]
    for effect, form, values in forms_of(vehicle.effects):
        way = WAYS.get((effect, form))
        reason = next((lacking[key] for key in (effect, *(way.keys if way else ()))
                       if key in lacking), '')
        if way is None and _alike(values, base_effects.get(effect, {})):
            carried.append(Fate(effect, form, 'the file has it already'))
        elif way is None:
            not_carried.append(Fate(effect, form, reason or NEEDS[effect]))
        elif reason:
            not_carried.append(Fate(effect, form, reason))
        elif effect == 'battery_sag' and sag is None:
            not_carried.append(Fate(effect, form, 'its mean hangs on the flight; name one by '
                                    '--flight'))
        elif effect == 'motor_lag' and form != _first_lag(lags):
            not_carried.append(Fate(effect, form, f'the file has one lag, that of the form '
                                    f'{_first_lag(lags)}'))
        else:
            lost = way.lost
            if one_lag and form == 'rise_fall' and values.get('rise') != values.get('fall'):
                lost = 'the mean of both as the one time constant that the file has'
            (nearest if lost else carried).append(Fate(effect, form, lost or 'as it is'))
    return Fates(tuple(carried), tuple(nearest), tuple(not_carried))


def _first_lag(lags: list[str]) -> str:
    """Return the form of the lag that _lags takes."""
    return next(form for form in ('first_order', 'rise_fall', 'second_order') if form in lags)


def _alike(values: Mapping[str, float], others: Mapping[str, float]) -> bool:
    """Whether all values are those of others."""
    return all(key in others and math.isclose(value, others[key], rel_tol=1e-9)
               for key, value in values.items())
