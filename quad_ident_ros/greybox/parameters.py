# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The constants of the vehicle and the parameters of all effects as one vector."""

from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from quad_ident_ros.effects import registry, thrust_scale_curve
from quad_ident_ros.model.motors import spread
from quad_ident_ros.model.quantities import stated
from quad_ident_ros.model.rigid_body import vehicle_vector
from quad_ident_ros.model.vehicle import Vehicle

CONSTANTS = ('mass', 'inertia_x', 'inertia_y', 'inertia_z', 'gravity', 'thrust_coefficient',
             'torque_coefficient', 'rotor_radius', 'linear_drag_x', 'linear_drag_y',
             'linear_drag_z', 'rotational_drag_x', 'rotational_drag_y', 'rotational_drag_z',
             'drag_in_world', 'hover_speeds', 'product_xy', 'product_xz', 'product_yz')
NAMES = CONSTANTS + tuple(f'{effect}.{parameter.name}' for effect, parameter in
                          registry.PARAMETERS)
INDEX = {name: k for k, name in enumerate(NAMES)}
SPLIT = len(CONSTANTS)
FACTORS = {
    'thrust_coefficient': ('thrust_scale.factor', 'thrust_scale.at_hover',
                           'thrust_scale.hover_factor',
                           *(f'thrust_scale.{name}' for name in thrust_scale_curve.SPEED_OF)),
    'torque_coefficient': ('inertia_mismatch.torque',),
    **{f'inertia_{axis}': (f'inertia_mismatch.factor_{axis}',) for axis in 'xyz'}}
"""Parameters of effects that are a factor on a constant, by constant."""
OFFSETS = {'mass': ('mass_offset.mass',)}
"""Parameters of effects that are added to a constant, by constant."""
ARMS = {f'inertia_mismatch.arms_{axis}': axis for axis in 'xy'}
"""Factors on the arms of the rotors, with the body axis along which they are."""
MOMENTS = tuple(f'inertia_mismatch.moment_{axis}' for axis in 'xy')
"""The same about the other axis each, by another form."""
RATIOS = {
    **{f'inertia_mismatch.inertia_{axis}': (f'inertia_{axis}', 'inertia_x') for axis in 'yz'},
    'inertia_mismatch.moment_z': ('torque_coefficient', 'inertia_x')}
"""Parameters of effects that are a factor on one constant over another, by parameter."""


def constants_within(names: Iterable[str]) -> set[str]:
    """Return the constants that are the same physical number as one of these parameters."""
    given = set(names)
    return {constant for constant, parameters in (*FACTORS.items(), *OFFSETS.items())
            if given & set(parameters)}


def uncertain_constants(vehicle: Vehicle, columns: Iterable[int]) -> dict[str, float]:
    """
    Return {constant: stated deviation} of those that an estimate is to know of.

    Where a column is the same physical number, such as an offset of the mass, flights show it.
    """
    estimated = {NAMES[column] for column in columns}
    same = estimated | constants_within(estimated)
    return {name: std for name, std in stated(vehicle).items()
            if name in INDEX and name not in same}


def constants_behind(vehicle: Vehicle, columns: Iterable[int], share: float, drag: float
                     ) -> dict[str, float]:
    """
    Return {name: deviation} of the constants of a file that an estimate takes as exact.

    As the file states it. Where it states none: a share of the constant, another one of drags,
    and none of mass, gravity and thrust coefficient, beside which motion shows all others. The
    arms are the factors on them.
    """
    estimated = {NAMES[column] for column in columns}
    values, known = nominal(vehicle), uncertain_constants(vehicle, columns)
    shares = {**{f'inertia_{axis}': share for axis in 'xyz'}, 'torque_coefficient': share,
              'rotor_radius': share,
              **{f'{kind}_drag_{axis}': drag for kind in ('linear', 'rotational')
                 for axis in 'xyz'}}
    given = {*stated(vehicle), *constants_within(estimated)}
    found = {name: one * abs(values[INDEX[name]]) for name, one in shares.items()
             if name not in given}
    if not estimated & {*ARMS, *MOMENTS}:
        found |= {name: _of_arms(vehicle, axis, share) for name, axis in ARMS.items()}
    return known | {name: float(one) for name, one in found.items() if one > 0.0}


def _of_arms(vehicle: Vehicle, axis: str, share: float) -> float:
    """Return the deviation of the factor on the arms along an axis by those of the places."""
    places = np.array([rotor.position['xyz'.index(axis)] for rotor in vehicle.rotors])
    known = stated(vehicle)
    # A factor leaves a place of zero where it is, however well that is known.
    each = np.array([known.get(f'rotors[{k}].position_{axis}', np.nan if place else 0.0)
                     for k, place in enumerate(places)])
    power = float(places @ places)
    if np.isnan(each).any() or power == 0.0:
        return share
    return float(np.linalg.norm(places * each)) / power


def nominal(vehicle: Vehicle) -> np.ndarray:
    """
    Return the vector (Z,) of the vehicle file, with the effects that it has.

    A parameter with this value adds nothing to the file: it is that of no effect, or of the
    law that the file has.
    """
    return np.concatenate([vehicle_vector(vehicle), registry.vector(vehicle.effects, vehicle)])


def constants_of(z: np.ndarray, vehicle: Vehicle) -> np.ndarray:
    """Return the constants (..., 19) in vectors (..., Z), the hover speeds those of the others."""
    constants = np.array(z[..., :SPLIT])
    mass, gravity, thrust = (constants[..., INDEX[name]] for name in
                             ('mass', 'gravity', 'thrust_coefficient'))
    constants[..., INDEX['hover_speeds']] = np.sqrt(len(vehicle.rotors) * mass * gravity / thrust)
    return constants


@lru_cache(maxsize=8)
def limits(vehicle: Vehicle) -> np.ndarray:
    """Return bounds of what is identified and usual sizes (3, Z), SI, not to be written to."""
    constants = vehicle_vector(vehicle)
    arm = vehicle.arm_length
    weight = vehicle.mass * vehicle.gravity
    size = np.abs(constants)
    # What is zero in the file still has a usual size: forces of the weight at 20 m/s and alike.
    size[8:11] = np.maximum(size[8:11], 0.05 * weight / 20.0)
    size[11:14] = np.maximum(size[11:14], 1e-3 * weight * arm)
    lower, upper = 0.05 * size, 20.0 * size
    lower[8:14] = 0.0
    lower[16:] = -upper[16:]    # products of inertia have either sign
    table = np.array([lower, upper, 0.1 * size])
    whole = np.concatenate([table, registry.bounds(vehicle)], axis=1)
    whole[:2, SPLIT:] = registry.fit_bounds(vehicle)
    whole.flags.writeable = False
    return whole


def prior_sizes(vehicle: Vehicle, width: float) -> np.ndarray:
    """
    Return the standard deviations (Z,), SI, of the prior about the nominal vehicle.

    Usual sizes times `width`. Where the vehicle file says how well it knows a constant, its own
    deviation instead: for the constant, and for what effects have as the same physical number.
    A drag that is well known says nothing of the effects of drag, which are forces beside it.
    """
    sizes, constants = width * limits(vehicle)[2], vehicle_vector(vehicle)
    known = stated(vehicle)
    for name, both in RATIOS.items():
        if set(both) <= set(known):
            sizes[INDEX[name]] = np.hypot(*(known[one] / constants[INDEX[one]] for one in both))
    for name, one in known.items():
        if name not in INDEX:   # of places and limits of speed no column is
            continue
        sizes[INDEX[name]] = one
        for factor in FACTORS.get(name, ()):
            sizes[INDEX[factor]] = one / constants[INDEX[name]]
        for offset in OFFSETS.get(name, ()):
            sizes[INDEX[offset]] = one
    _put_in_map(sizes, vehicle)
    return sizes


def _put_in_map(sizes: np.ndarray, vehicle: Vehicle) -> None:
    """Enter how well the map of the motors is known: the thrust at hover, and its power."""
    if vehicle.motors is None:
        return
    k = vehicle.thrust_coefficient
    level, power = spread(vehicle.motors, k, k * vehicle.hover_speed ** 2)
    if level is not None:
        if vehicle.motors.gives == 'speed':     # of a thrust the coefficient plays no part
            coefficient = vehicle.uncertainty.get('thrust_coefficient', 0.0)
            level = float(np.hypot(level, np.asarray(coefficient) / k))
        for factor in FACTORS['thrust_coefficient']:
            sizes[INDEX[factor]] = level
    if power is not None:
        sizes[INDEX['thrust_scale.exponent']] = power
        # The power of (speed + offset)^2 is 2 / (1 + offset) at hover.
        sizes[INDEX['thrust_scale.offset']] = 0.5 * power
        for name, speed in thrust_scale_curve.SPEED_OF.items():
            column = INDEX[f'thrust_scale.{name}']
            sizes[column] = np.hypot(sizes[column], power * np.log(speed))


def columns_of(effects: Iterable[str], rotor_count: int) -> list[int]:
    """Return the places (list of int) in the vector of effects, in their usual forms."""
    return [INDEX[f'{effect.name}.{parameter.name}']
            for effect in (registry.EFFECTS[name] for name in effects)
            for parameter in effect.parameters_of(effect.forms[0], rotor_count)]
