# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into dictionaries of rotorpy."""

import math

import numpy as np

from quad_ident_ros.vehicle_files.edit_literals import EditedTable
from quad_ident_ros.vehicle_files.new_rotorpy import new
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import ENTRIES, inertia_for
from quad_ident_ros.vehicle_files.out_places import lack_part
from quad_ident_ros.vehicle_files.rotorpy import table_of
from quad_ident_ros.vehicle_files.target import Target
from quad_ident_ros.vehicle_files.ways import BODY, LAGS

FIXED = 'rotor_pos is not written as a list or a dictionary of places'


def write(base: Base) -> EditedTable:
    """Return the Edits that give a dictionary of rotorpy what is wanted; InputError."""
    wanted = base.wanted
    edited = EditedTable(base.source, table_of(base.source))
    inertia = inertia_for(base, edited,
                          f'{base.source.path}, line {edited.table.lines["Ixx"]}: Ixx')
    edited.entry('mass', wanted.mass, 'kg', wanted.sources['mass'])
    size = float(np.max(np.abs(inertia)))
    for name, at in ENTRIES.items():
        edited.entry(f'I{name[1:]}', float(inertia[at]), 'kg m2',
                     wanted.sources['inertia'], size)
    moves = [(wanted.sources[key], moved) for key, moved in (
        ('centre', wanted.centre.any()), ('moments', base.shifts.any())) if moved]
    if moves and not edited.vectors(
            'rotor_pos', [np.array(rotor['position']) + shift - wanted.centre for rotor, shift in
                          zip(base.constant('rotors'), base.shifts, strict=True)], 'm',
            ', '.join(source for source, _ in moves)):
        edited.lack(['centre'], FIXED)
        lack_part(edited, wanted, 'arms', FIXED)
    for name, key, value, unit in (
            ('k_eta', 'thrust', wanted.thrust, 'N/(rad/s)^2'),
            ('k_m', 'torque', wanted.torque, 'N m/(rad/s)^2')):
        edited.entry(name, value, unit, wanted.sources[key])
    _write_motors(edited, base)
    for name, key, value, unit in (
            ('k_d', 'rotor_drag', wanted.rotor_drag, 'kg/rad'),
            ('k_z', 'inflow', wanted.inflow[0], 'kg/rad'),
            ('k_h', 'inflow', wanted.inflow[1], 'kg/m'),
            ('k_flap', 'flapping', wanted.flapping, 'kg m/rad'),
            *((f'c_D{axis}', 'body_drag', float(value), 'kg/m')
              for axis, value in zip('xyz', wanted.body_drag, strict=True))):
        over = ' over the hover speeds' if unit.endswith('/rad') else ''
        edited.entry(name, value, unit, wanted.sources[key] + over)
    return edited


def _write_motors(edited: EditedTable, base: Base) -> None:
    """Have the dictionary hold the lag and the highest speed."""
    wanted = base.wanted
    if wanted.lag > 0.0:
        edited.entry('tau_m', wanted.lag, 's', wanted.sources['rise'])
    else:
        edited.lack(LAGS, 'rotorpy divides by tau_m, which needs to be above 0')
    if wanted.rise != wanted.fall:
        edited.one_lag()
    if math.isinf(wanted.speed_max):
        edited.lack(['speed_max'], 'rotorpy needs a limit; that of the file stays')
    else:
        edited.entry('rotor_speed_max', wanted.speed_max, 'rad/s', wanted.sources['speed_max'])


TARGET = Target('rotorpy', ('.py',), frozenset((
    *BODY, *LAGS, 'moments', 'thrust', 'torque', 'speed_max', 'rotor_drag', 'body_drag', 'inflow',
    'flapping')), write, new)
