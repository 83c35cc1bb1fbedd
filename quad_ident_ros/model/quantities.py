# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of a vehicle by name: its constants, and the parameters of its effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TYPE_CHECKING

from quad_ident_ros.effects.registry import EFFECTS

if TYPE_CHECKING:
    from quad_ident_ros.model.vehicle import Vehicle

UNITS = {'mass': 'kg', 'inertia': 'kg m^2', 'gravity': 'm/s^2',
         'thrust_coefficient': 'N/(rad/s)^2', 'torque_coefficient': 'N m/(rad/s)^2',
         'rotor_inertia': 'kg m^2', 'rotor_radius': 'm', 'linear_drag': 'N/(m/s)',
         'rotational_drag': 'N m/(rad/s)^2', 'speed_min': 'rad/s', 'speed_max': 'rad/s'}
"""Unit of each constant of the vehicle file, by key."""
PLACE = 'm'         # unit of a rotor's position
AXES = 'xyz'
TRIPLES = ('inertia', 'linear_drag', 'rotational_drag')


def units(rotor_count: int) -> dict[str, str]:
    """
    Return {name: unit} of all numbers of a vehicle with so many rotors.

    mass, inertia_x, rotors[0].position_x, rotor_drag.coefficient and alike.
    """
    names = [name for key in UNITS for name in _names(key, key in TRIPLES)]
    names += [name for k in range(rotor_count) for name in _names(f'rotors[{k}].position', True)]
    for effect in EFFECTS.values():
        names += [f'{effect.name}.{each.name}' for each in effect.parameters_for(rotor_count)]
    return {name: unit_of(name) for name in names}


def unit_of(name: str) -> str:
    """Return the unit of a number by its name."""
    effect, parameter = _effect(name)
    if effect:
        return next(each.unit for each in EFFECTS[effect].parameters if each.name == parameter)
    return UNITS.get(_constant(name)[0], PLACE)


def stated(vehicle: Vehicle) -> dict[str, float]:
    """Return {name: standard deviation} of the constants whose vehicle file states one."""
    found = {}
    for key, std in vehicle.uncertainty.items():
        each = std if isinstance(std, tuple) else (std,)
        for name, one in zip(_names(key, isinstance(std, tuple)), each, strict=True):
            if one is not None:
                found[name] = float(one)
    return found


def value_of(vehicle: Vehicle, name: str) -> float:
    """Return a number of a vehicle; of an effect that it has not, the value of none."""
    effect, parameter = _effect(name)
    if effect:
        null = next(each.null for each in EFFECTS[effect].parameters if each.name == parameter)
        return float(vehicle.effects.get(effect, {}).get(parameter, null))
    key, axis = _constant(name)
    if key.startswith('rotors['):
        return float(vehicle.rotors[_rotor(key)].position[axis])
    value = getattr(vehicle, key)
    return float(value[axis] if key in TRIPLES else value)


def with_values(vehicle: Vehicle, values: Mapping[str, float]) -> Vehicle:
    """Return a vehicle with other values of some of its numbers, by name, unchecked."""
    effects = {name: dict(each) for name, each in vehicle.effects.items()}
    constants: dict[str, Any] = {}
    rotors = list(vehicle.rotors)
    for name, value in values.items():
        effect, parameter = _effect(name)
        if effect:
            effects.setdefault(effect, {})[parameter] = float(value)
            continue
        key, axis = _constant(name)
        if key.startswith('rotors['):
            k = _rotor(key)
            rotors[k] = replace(rotors[k], position=_changed(rotors[k].position, axis, value))
        elif key in TRIPLES:
            constants[key] = _changed(constants.get(key, getattr(vehicle, key)), axis, value)
        else:
            constants[key] = float(value)
    return replace(vehicle, **constants, rotors=tuple(rotors), effects=effects)


def _names(key: str, several: bool) -> list[str]:
    return [f'{key}_{axis}' for axis in AXES] if several else [key]


def _effect(name: str) -> tuple[str, str]:
    """Return effect and parameter of a name, empty for that of a constant."""
    effect, _, parameter = name.partition('.')
    return (effect, parameter) if effect in EFFECTS else ('', '')


def _constant(name: str) -> tuple[str, int]:
    """Return the key of the vehicle file and the axis, 0 where it has none."""
    return (name, 0) if name in UNITS else (name[:-2], AXES.index(name[-1]))


def _rotor(key: str) -> int:
    return int(key[len('rotors['):key.index(']')])


def _changed(values: tuple[float, ...], axis: int, value: float) -> tuple[float, ...]:
    return (*values[:axis], float(value), *values[axis + 1:])
