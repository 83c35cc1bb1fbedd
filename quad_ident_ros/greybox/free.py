# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The names of what may be freed in a fit: keys of the vehicle file, effects, their parameters."""

from collections.abc import Iterable
from typing import TypeAlias

from quad_ident_ros import schema
from quad_ident_ros.effects import registry
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.parameters import columns_of, INDEX, SPLIT
from quad_ident_ros.model.vehicle import Vehicle

Names: TypeAlias = dict[str, dict[str, int]]
"""{name that can be given: {full name: place in the parameter vector}}."""

EXCITATION = {'mass': 'any flight', 'inertia': 'fast turns about each axis',
              'thrust_coefficient': 'any flight', 'torque_coefficient': 'turns in yaw',
              'linear_drag': 'flight at different speeds along each axis',
              'rotational_drag': 'very fast turns about each axis'}
"""What a flight must do to show each constant that can be freed; of effects: the registry."""

_KNOWN = (f'known are {", ".join(EXCITATION)}, the names of effects, and single parameters '
          'such as inertia_x and motor_lag.time_constant')

SAME = {'mass': 'mass_offset.mass', 'thrust_coefficient': 'thrust_scale.factor',
        **{f'inertia_{axis}': f'inertia_mismatch.factor_{axis}' for axis in 'xyz'}}
"""Constants that are one physical number with a parameter of an effect."""


def columns_of_names(names: Iterable[str], vehicle: Vehicle) -> dict[str, int]:
    """
    Return {full name: place in the parameter vector} of names to be freed, in their order.

    Raises InputError for a name that is not known, and for two names of one physical number.
    """
    table = _table(vehicle)
    found: dict[str, int] = {}
    for name in names:
        if name not in table:
            raise _unknown(name, table)
        found |= table[name]
    for constant, parameter in SAME.items():
        if constant in found and parameter in found:
            raise InputError(f'--free: {constant} and {registry.titled(parameter)} are the same '
                             'physical number; free one of them')
    if not found:
        raise InputError(f'--free: names nothing; {_KNOWN}')
    return found


def _unknown(name: str, table: Names) -> InputError:
    """Return the InputError for a name that is not known, with the nearest known one."""
    error = schema.unknown_key('--free', name, table)
    if 'did you mean' in str(error):
        return error
    return InputError(f'--free: {schema.shown(name)} cannot be freed; {_KNOWN}')


def excitation_of(name: str) -> str:
    """Return what a flight must do to show a full name."""
    effect, dot, _ = name.partition('.')
    return registry.EFFECTS[effect].excitation if dot else EXCITATION[_key(name)]


def _key(name: str) -> str:
    """Return the key of the vehicle file that a constant belongs to."""
    return name if name in EXCITATION else name[:-2]


def _table(vehicle: Vehicle) -> Names:
    """Return every name that can be given, with the full names and places it stands for."""
    table: Names = {}
    for key in EXCITATION:
        parts = [name for name in (key, *(f'{key}_{axis}' for axis in 'xyz')) if name in INDEX]
        table[key] = {name: INDEX[name] for name in parts}
        table |= {name: {name: INDEX[name]} for name in parts}
    count = len(vehicle.rotors)
    for effect, known in registry.EFFECTS.items():
        places = columns_of([effect], count)
        table[effect] = {f'{effect}.{registry.PARAMETERS[place - SPLIT][1].name}': place
                         for place in places}
        single = {f'{effect}.{parameter.name}': SPLIT + registry.PLACE[effect, parameter.name]
                  for form in known.forms[1:] for parameter in known.parameters_of(form, count)}
        table |= {name: {name: place} for name, place in (table[effect] | single).items()}
    return table
