# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Dictionaries of parameters of rotorpy, in a Python file."""

from typing import Any

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.effects.registry import Values
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.bodies import Body, symmetric
from quad_ident_ros.vehicle_files.literals import Table, tables_of
from quad_ident_ros.vehicle_files.reading import Draft, per_sum_of_speeds
from quad_ident_ros.vehicle_files.source import MOST, one_of, Source

KEYS = ('mass', 'Ixx', 'k_eta', 'rotor_pos')
USUAL = 'quad_params'
GRAVITY = 9.81      # m/s^2, in the code of rotorpy
_MOMENTS = ('Ixx', 'Iyy', 'Izz', 'Ixy', 'Ixz', 'Iyz')
_UNITS = {'tau_m': 's', 'k_d': 'kg/rad', 'k_z': 'kg/rad', 'k_h': 'kg/m', 'k_flap': 'kg m/rad',
          'c_Dx': 'kg/m', 'c_Dy': 'kg/m', 'c_Dz': 'kg/m'}
_NOISE = 'motor_noise_std'


def recognises(text: str) -> bool:
    """Whether a text is a Python file with a dictionary of rotorpy."""
    return 'k_eta' in text and 'rotor_pos' in text


def read(source: Source) -> Draft:
    """Return the Draft of a dictionary of rotorpy; raises InputError."""
    table = table_of(source)
    name = source.stem.removesuffix('_params') if table.name == USUAL else table.name
    draft = Draft(source.path, name)

    def place(key: str) -> str:
        return f'line {table.lines[key]}'

    def number(key: str, least: float = -np.inf, usual: float | None = None) -> float:
        if key not in table.values and usual is not None:
            return usual
        if key not in table.values:
            raise InputError(f'{source.path}, line {min(table.lines.values())}: {table.name} has '
                             f'no {key}, which rotorpy needs; add it')
        return schema.number(f'{source.path}, {place(key)}: {key}', _plain(table.values[key]),
                             least, MOST)

    draft.take_body(Body(number('mass', 0.0), np.zeros(3), symmetric(
        *(number(key, usual=None if key in _MOMENTS[:3] else 0.0) for key in _MOMENTS))),
        place('mass'), place('Ixx'))
    draft.data['gravity'] = GRAVITY
    draft.assumed.append(f'gravity {GRAVITY:g} m/s2: that of rotorpy, whose dictionary has none')
    draft.take('thrust_coefficient', number('k_eta', 0.0), 'N/(rad/s)^2', place('k_eta'))
    draft.take('torque_coefficient', number('k_m', 0.0), 'N m/(rad/s)^2', place('k_m'))
    for ours, theirs, unit in (('rotor_radius', 'rotor_radius', 'm'),
                               ('speed_min', 'rotor_speed_min', 'rad/s'),
                               ('speed_max', 'rotor_speed_max', 'rad/s')):
        if theirs in table.values:
            draft.take(ours, number(theirs, 0.0), unit, place(theirs))
    _take_rotors(draft, source, table)
    drags = {key: number(key, usual=0.0) for key in _UNITS}
    for key, value in drags.items():
        if key in table.values:
            draft.note(key, value, _UNITS[key], place(key))
    draft.effects = lambda vehicle: _effects(drags, vehicle)
    draft.assumed.append('the aerodynamics are on (`aero=True`, as usual in rotorpy)')
    if number(_NOISE, usual=0.0) > 0.0:
        draft.assumed.append(f'{_NOISE} ({place(_NOISE)}) is left out: noise of the rotor speeds '
                             'is not an effect')
    return draft


def table_of(source: Source) -> Table:
    """Return the dictionary of rotorpy of a file, or the one that is wanted; InputError."""
    return one_of(source, {table.name: table
                           for table in tables_of(source.path, source.text, KEYS)},
                  f'dictionary with {", ".join(KEYS)}')


def _take_rotors(draft: Draft, source: Source, table: Table) -> None:
    """Enter places and spins of the rotors."""
    lines = {key: table.lines.get(key, 0) for key in ('rotor_pos', 'rotor_directions')}
    places, spins = table.values['rotor_pos'], table.values.get('rotor_directions')
    places = list(places.values()) if isinstance(places, dict) else _plain(places)
    where = f'{source.path}, line {lines["rotor_pos"]}: rotor_pos'
    if not isinstance(places, list) or not places:
        raise InputError(f'{where}: expected the places of the rotors, {{"r1": [x, y, z], ...}}')
    positions = [np.array(schema.numbers(f'{where}[{k}]', _plain(one), 3))
                 for k, one in enumerate(places)]
    count = _plain(table.values.get('num_rotors', len(positions)))
    if count != len(positions):
        raise InputError(f'{source.path}, line {table.lines["num_rotors"]}: num_rotors is '
                         f'{schema.shown(count)}, and rotor_pos has {len(positions)} places; '
                         'correct one of them')
    if spins is None:
        raise InputError(f'{source.path}, line {lines["rotor_pos"]}: {table.name} has no '
                         'rotor_directions, the signs of the torques; add it')
    where = f'{source.path}, line {lines["rotor_directions"]}: rotor_directions'
    signs = schema.numbers(where, _plain(spins), len(positions))
    draft.take_rotors(positions, [schema.choice(where, sign, (1, -1)) for sign in signs],
                      f'lines {lines["rotor_pos"]}, {lines["rotor_directions"]}')


def _effects(drags: dict[str, float], vehicle: Vehicle) -> Values:
    """Return the effects that rotorpy has: its laws are those of the usual forms."""
    x, y, z = (drags[f'c_D{axis}'] for axis in 'xyz')
    return {
        'motor_lag': {'time_constant': drags['tau_m']},
        'rotor_drag': {'coefficient': per_sum_of_speeds(drags['k_d'], vehicle)},
        'body_drag': {'horizontal': x, 'vertical': z} if x == y else {'x': x, 'y': y, 'z': z},
        'inflow': {'axial': per_sum_of_speeds(drags['k_z'], vehicle),
                   'translational': drags['k_h'] * len(vehicle.rotors)},
        'blade_flapping': {'coefficient': per_sum_of_speeds(drags['k_flap'], vehicle)}}


def _plain(value: Any) -> Any:
    """Return arrays of NumPy as lists, and its numbers as such."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
