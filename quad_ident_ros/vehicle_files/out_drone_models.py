# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into parameters of drone-models, which crazyflow flies."""

from __future__ import annotations

from collections.abc import Sequence
import math

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.drone_models import Drone, drone_of, TO_SPEED
from quad_ident_ros.vehicle_files.edits import differs, Edits, shown
from quad_ident_ros.vehicle_files.new_drone_models import new
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import inertia_for
from quad_ident_ros.vehicle_files.target import Target
from quad_ident_ros.vehicle_files.toml_places import after_header
from quad_ident_ros.vehicle_files.wanted import SQUARE
from quad_ident_ros.vehicle_files.ways import LAGS

polyval = np.polynomial.polynomial.polyval
ROTORS = 4
OTHER_MODELS = ('thrust2torque', 'rotor_dyn_coef_simple', 'thrust_dyn_coef')
"""Keys that say again, for simpler models of drone-models, what the others say."""


def write(base: Base) -> Edits:
    """Return the Edits that give a table of drone-models what is wanted; InputError."""
    wanted = base.wanted
    drone = drone_of(base.source)
    edited = _EditedDrone(drone)
    inertia = inertia_for(base, edited, f'{base.source.path}, {drone.place("J")}')
    edited.key('mass', [wanted.mass], 'kg', wanted.sources['mass'])
    edited.key('J', inertia.ravel(), 'kg m2', wanted.sources['inertia'],
               size=float(np.max(np.abs(inertia))))
    _write_places(edited, base, drone)
    curve = _write_curves(edited, base, drone)
    _write_lags(edited, base, drone, curve)
    drag = -drone.matrix('drag_matrix', 3, 3) if 'drag_matrix' in drone.table else np.zeros((3, 3))
    np.fill_diagonal(drag, wanted.linear_drag)
    edited.key('drag_matrix', -drag.ravel(), 'N/(m/s)', wanted.sources['linear_drag'])
    edited.lack(['rotors'], 'the rotors of drone-models lie in the plane of the centre of mass')
    others = [key for key in OTHER_MODELS if key in drone.table]
    if others and edited.changes:
        edited.remarks.append(f'{", ".join(others)} stay as they are: they are of other models '
                              'than first_principles')
    return edited


class _EditedDrone(Edits):
    """The text of a TOML file, with the numbers of one of its tables."""

    def __init__(self, drone: Drone) -> None:
        super().__init__(drone.source.text)
        self.drone = drone

    def key(self, key: str, new: Sequence[float] | np.ndarray, unit: str, source: str,
            size: float = 0.0) -> None:
        """Have a key hold other numbers; one that is missing stands for zeros."""
        found = self.drone.places.get(key)
        stated = np.ravel(self.drone.table.get(key, np.zeros(len(new)))).astype(float)
        if key in self.drone.table and (found is None or len(found.numbers) != len(new)):
            raise InputError(f'{self.drone.source.path}: {key} of {self.drone.name} is written in '
                             f'another way than {key} = ... on a line of its own; write it so')
        place = self.drone.place(key) if found else f'{self.drone.name}: {key}'
        moved = self.enter(place, list(stated), new, unit, source, size)
        if found is None and any(moved):
            begin = after_header(self.text, self.drone.header)
            self.replace(begin, begin, f'{key} = {_written(new)}\n')
        for value, changed, (first, last) in zip(new, moved, found.numbers if found else (),
                                                 strict=found is not None):
            if changed:
                self.replace(first, last, shown([value]))


def _write_places(edited: _EditedDrone, base: Base, drone: Drone) -> None:
    """
    Have the rows of roll and pitch of the mixing matrix hold the places of the rotors.

    The arm L, which both have in common, stays: else a factor on one would change the other.
    """
    mixing = drone.matrix('mixing_matrix', 3, ROTORS)
    mixing[:2] *= base.wanted.arms[[1, 0], None]
    edited.key('mixing_matrix', mixing.ravel(), '1', base.wanted.sources['moments'])


def _write_curves(edited: _EditedDrone, base: Base, drone: Drone) -> np.ndarray:
    """Have the curves over the speed hold thrust and torque; return that of the thrust (3,)."""
    wanted, thrust = base.wanted, drone.numbers('rpm2thrust', 3)
    constant, torque = base.constant('thrust_coefficient'), base.constant('torque_coefficient')
    exponent = base.effects.get('thrust_scale', {}).get('exponent', SQUARE)
    speed = math.sqrt(base.mass * base.constant('gravity') / (ROTORS * constant))
    lift = wanted.thrust * wanted.hover ** 2 * (speed / wanted.hover) ** wanted.exponent
    curve = thrust
    if differs(exponent, wanted.exponent):
        # A quadratic that has the level and the slope of the power at hover.
        share = wanted.mass * base.constant('gravity') / ROTORS
        rpm = wanted.hover / TO_SPEED * (share / (wanted.thrust * wanted.hover ** 2)) ** (
            1.0 / wanted.exponent)
        curve = np.array([0.0, (2.0 - wanted.exponent) * share / rpm,
                          (wanted.exponent - 1.0) * share / rpm ** 2])
    elif differs(constant * speed ** 2, lift):
        curve = thrust * lift / (constant * speed ** 2)
    edited.key('rpm2thrust', curve, 'N per power of rpm', wanted.sources['thrust'])
    if differs(torque, wanted.torque):
        edited.key('rpm2torque', drone.numbers('rpm2torque', 3) * wanted.torque / torque,
                   'N m per power of rpm', wanted.sources['torque'])
    _write_limits(edited, base, drone, curve)
    return curve


def _write_limits(edited: _EditedDrone, base: Base, drone: Drone, curve: np.ndarray) -> None:
    """Have the limits, which are thrusts, stand for the speeds that they are to be."""
    for key, speed in (('thrust_min', base.constant('speed_min')),
                       ('thrust_max', base.wanted.speed_max)):
        limited = key in drone.table
        if key == 'thrust_max' and limited == math.isinf(speed):
            edited.lack(['speed_max'], 'the file needs a limit; the one that it has stays'
                        if limited else 'the file has no thrust_max')
        elif limited:
            lift = float(polyval(speed / TO_SPEED, curve))
            if lift > 0.0:
                edited.key(key, [lift], 'N', f'{key.replace("thrust", "speed")}, with the curve '
                           'as above')


def _write_lags(edited: _EditedDrone, base: Base, drone: Drone, curve: np.ndarray) -> None:
    """Have the rates of the motors hold the lags at hover, which mass and thrust move."""
    wanted, key = base.wanted, 'rotor_dyn_coef'
    lags = np.array([wanted.rise, wanted.fall])
    hover = drone.rpm(curve, wanted.mass * base.constant('gravity') / ROTORS)
    stated = drone.numbers(key, 4) if key in drone.table else np.zeros(4)
    there = stated[[0, 2]] + 2.0 * stated[[1, 3]] * hover
    now = 1.0 / there if key in drone.table else np.zeros(2)
    if not any(differs(*pair) for pair in zip(now, lags, strict=True)):
        return
    if not lags.all():
        edited.lack(LAGS, f'a lag of 0 has no rate; take {key} out')
        return
    rates = np.array([1.0 / wanted.rise, 0.0, 1.0 / wanted.fall, 0.0])
    if key in drone.table:
        rates = stated * np.repeat(1.0 / (there * lags), 2)
    edited.key(key, rates, '1/s and 1/(s rpm)', wanted.sources['rise'])


def _written(values: Sequence[float] | np.ndarray) -> str:
    """Return numbers as the value of a key: one, a list, or a matrix of three rows."""
    numbers = [shown([value]) for value in values]
    if len(numbers) == 1:
        return numbers[0]
    rows = [numbers] if len(numbers) != 9 else [numbers[k:k + 3] for k in (0, 3, 6)]
    lists = [f'[{", ".join(row)}]' for row in rows]
    return lists[0] if len(lists) == 1 else f'[{", ".join(lists)}]'


TARGET = Target('drone_models', ('.toml',), frozenset((
    'mass', 'inertia', 'moments', 'thrust', 'exponent', 'torque', 'speed_max', *LAGS,
    'linear_drag')), write, new)
