# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a simulator's file is to say of a vehicle with its effects."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
import math

import numpy as np

from quad_ident_ros.data.thrust_level import FACTORS
from quad_ident_ros.effects.registry import Values
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.ways import forms_of, Key, way_of
from quad_ident_ros.vehicle_files.weak_rotors import losses_of

SQUARE = 2.0    # of the rotor speed: the nominal thrust


@dataclass(frozen=True)
class Wanted:
    """
    Numbers that a file may have, with the effects in them.

    mass kg; centre (3,) m, of mass, from that of the file; inertia (3, 3) kg m^2 about the centre
    of mass; arms (3,): factors on the places of the rotors from the centre of mass of the file;
    thrust N/(rad/s)^2, at hover, rad/s, and exponent: of the rotor speed that the thrust goes
    with; torque N m/(rad/s)^2, turning: the factor in it on that of the vehicle; losses,
    torque_losses (n,): shares of the thrust and of the torque that each rotor has lost; speed_max
    rad/s; rise, fall s, time constants; rotor_drag kg/rad, force per speed of a rotor and air
    velocity across its axis; linear_drag (3,) N/(m/s); body_drag (3,) kg/m; inflow: kg/rad, thrust
    of a rotor lost per its speed and air velocity along its axis, and kg/m, won per square of that
    across it; flapping kg m/rad, moment per speed of a rotor and air velocity; wind (3,) m/s;
    delay of the commands, s.
    sources: what each comes from, by key.
    """

    mass: float
    centre: np.ndarray
    inertia: np.ndarray
    arms: np.ndarray
    thrust: float
    hover: float
    exponent: float
    losses: np.ndarray
    torque: float
    turning: float
    torque_losses: np.ndarray
    speed_max: float
    rise: float
    fall: float
    rotor_drag: float
    linear_drag: np.ndarray
    body_drag: np.ndarray
    inflow: tuple[float, float]
    flapping: float
    wind: np.ndarray
    delay: float
    sources: dict[str, str]

    @property
    def lag(self) -> float:
        """Return the mean of both time constants, s."""
        return 0.5 * (self.rise + self.fall)


def wanted_of(vehicle: Vehicle, sag: float | None, holds: Collection[Key]) -> Wanted:
    """
    Return what a file is to say of a vehicle with its effects.

    Args: sag: mean share of the thrust that battery_sag leaves, None where it is not known;
    holds: what files of the kind have.
    """
    effects = vehicle.effects
    scale = effects.get('thrust_scale', {})
    factor = math.prod(scale.get(key, 1.0) for key in FACTORS)
    if sag is not None:
        factor *= sag
    # About hover the curve with an offset goes with this power.
    exponent = scale.get('exponent', SQUARE / (1.0 + scale.get('offset', 0.0)))
    mismatch = effects.get('inertia_mismatch', {})
    # Factors on the rotors' moments are in places and torque: an inertia over them would answer
    # all other moments by them, too.
    roll, pitch, turning = (
        mismatch.get(moment, 1.0) * mismatch.get(f'moment_{axis}', 1.0)
        for axis, moment in zip('xyz', ('arms_y', 'arms_x', 'torque'), strict=True))
    moments = np.array(vehicle.inertia) * [
        mismatch.get(f'factor_{axis}', 1.0) * mismatch.get(f'inertia_{axis}', 1.0)
        * mismatch.get(2 * axis, 1.0) for axis in 'xyz']
    roots = np.sqrt(moments)
    products = np.array(vehicle.products) + [
        mismatch.get(axes, 0.0) * roots[one] * roots[other]
        for axes, one, other in (('xy', 0, 1), ('xz', 0, 2), ('yz', 1, 2))]
    rise, fall = _lags(effects)
    speeds = len(vehicle.rotors) * vehicle.hover_speed
    linear, by_speed = _drags(vehicle, holds)
    body, inflow = effects.get('body_drag', {}), effects.get('inflow', {})
    shift, wind = effects.get('com_offset', {}), effects.get('wind', {})
    flaps = effects.get('blade_flapping', {})
    losses, torque_losses = losses_of(effects, len(vehicle.rotors))
    return Wanted(
        mass=vehicle.mass + effects.get('mass_offset', {}).get('mass', 0.0),
        centre=np.array([shift.get(axis, 0.0) for axis in 'xyz']),
        inertia=replace(vehicle, inertia=tuple(moments), products=tuple(products)).inertia_matrix,
        arms=np.array([pitch, roll, 1.0]),
        thrust=factor * vehicle.thrust_coefficient, hover=vehicle.hover_speed,
        exponent=exponent, losses=losses, torque=turning * vehicle.torque_coefficient,
        turning=turning, torque_losses=torque_losses, speed_max=vehicle.speed_max, rise=rise,
        fall=fall,
        rotor_drag=float(by_speed[:2].mean()) / speeds, linear_drag=linear,
        body_drag=np.array([body.get(axis, 0.0) + body.get(kind, 0.0) for axis, kind in
                            zip('xyz', ('horizontal', 'horizontal', 'vertical'), strict=True)]),
        inflow=(inflow.get('axial', 0.0) / speeds,
                inflow.get('translational', 0.0) / len(vehicle.rotors)),
        flapping=(flaps.get('coefficient', 0.0) + flaps.get('hub_coefficient', 0.0)) / speeds,
        wind=np.array([wind.get(axis, 0.0) for axis in 'xyz']),
        delay=effects.get('actuation_delay', {}).get('delay', 0.0),
        sources=_sources(vehicle, sag, holds))


def _drags(vehicle: Vehicle, holds: Collection[Key]) -> tuple[np.ndarray, np.ndarray]:
    """Return drags (3,) N/(m/s) at any rotor speeds, and scaled by them, at hover."""
    drag = vehicle.effects.get('rotor_drag', {})
    linear = np.array(vehicle.linear_drag) + [drag.get(axis, 0.0) for axis in 'xyz']
    by_speed = np.array([drag.get(f'{axis}_by_speed', 0.0) for axis in 'xyz'])
    by_speed[:2] += drag.get('coefficient', 0.0)
    # What a file does not have goes into the other, as it is at hover.
    if 'linear_drag' not in holds:
        return np.zeros(3), linear + by_speed
    if 'rotor_drag' not in holds:
        return linear + by_speed, np.zeros(3)
    return linear, by_speed


def _lags(effects: Values) -> tuple[float, float]:
    """Return the time constants up and down, s, of the first form of a lag that acts."""
    lag = effects.get('motor_lag', {})
    if 'time_constant' in lag:
        return lag['time_constant'], lag['time_constant']
    if 'rise' in lag or 'fall' in lag:
        return lag.get('rise', 0.0), lag.get('fall', 0.0)
    return lag.get('mean_lag', 0.0), lag.get('mean_lag', 0.0)


def _sources(vehicle: Vehicle, sag: float | None, holds: Collection[Key]) -> dict[str, str]:
    """Return the constant and the effects that each number comes from."""
    names: dict[Key, list[str]] = {
        'mass': ['mass'], 'centre': [], 'inertia': ['inertia'], 'moments': ['rotors'],
        'thrust': ['thrust_coefficient'], 'torque': ['torque_coefficient'],
        'speed_max': ['speed_max'], 'rise': [], 'fall': [],
        'rotor_drag': [], 'exponent': [], 'losses': [], 'torque_losses': [],
        'linear_drag': ['linear_drag'], 'body_drag': [], 'inflow': [], 'flapping': [], 'wind': [],
        'delay': []}
    if any(vehicle.linear_drag) and 'linear_drag' not in holds:
        names['rotor_drag'].append('linear_drag')
    for effect, form, _ in forms_of(vehicle.effects):
        way = way_of(effect, form, holds)
        if way is not None and (effect != 'battery_sag' or sag is not None):
            for key in (*way.keys, *(('torque',) if 'moments' in way.keys else ())):
                if effect not in names[key]:
                    names[key].append(effect)
    names['centre'] = names['centre'] or names['mass']
    usual = {'rise': 'motor_lag', 'fall': 'motor_lag', 'rotor_drag': 'rotor_drag',
             'exponent': 'thrust_scale', 'losses': 'rotor_fault', 'torque_losses': 'rotor_fault',
             'body_drag': 'body_drag', 'inflow': 'inflow', 'flapping': 'blade_flapping',
             'wind': 'wind', 'delay': 'actuation_delay'}
    return {key: ', '.join(found) or f'no {usual[key]}' for key, found in names.items()}
