# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of drone-models, which crazyflow flies: a TOML file with a table for each drone."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.effects.registry import titled, Values
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.bodies import Body
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.source import MOST, one_of, Source
from quad_ident_ros.vehicle_files.toml_places import places_of

KEYS = ('mass', 'L', 'J', 'rpm2thrust', 'rpm2torque', 'mixing_matrix')
TO_SPEED = math.pi / 30.0       # rad/s per rpm
POWERS = 1.0, 3.0       # of the speed that the thrust of a rotor goes with
NEAR = np.linspace(0.7, 1.3, 25)    # of the hover speed: what flights of it use
_TELLING = tuple(re.compile(rf'^\s*{key}\s*=', re.MULTILINE)
                 for key in ('rpm2thrust', 'mixing_matrix'))


def recognises(text: str) -> bool:
    """Whether a text is a TOML file with a drone of drone-models."""
    return all(pattern.search(text) for pattern in _TELLING)


def read(source: Source) -> Draft:
    """Return the Draft of a drone of drone-models; raises InputError."""
    return drone_of(source).draft()


def drone_of(source: Source) -> Drone:
    """Return the Drone of a file, or the one that is wanted; raises InputError."""
    data = _parsed(source)
    tables = {name: (name, table) for name, table in data.items()
              if isinstance(table, dict) and 'rpm2thrust' in table}
    if 'rpm2thrust' in data:
        tables[source.stem] = '', data
    return Drone(source, *one_of(source, tables, 'table with rpm2thrust'))


class Drone:
    """
    A table of a TOML file, its numbers checked, and the places where they stand.

    header: its name in the file, '' where the file is one table.
    """

    def __init__(self, source: Source, header: str, table: dict[str, Any]) -> None:
        self.source, self.header, self.table = source, header, table
        self.name = header or source.stem
        self.places = places_of(source.text, header)
        for key in KEYS:
            if key not in table:
                raise InputError(f'{source.path}: {self.name} has no {key}, which drone-models '
                                 'needs; add it')

    def place(self, *keys: str) -> str:
        """Return the lines of keys."""
        return ', '.join(f'line {self.places[key].line if key in self.places else 0}: {key}'
                         for key in keys)

    def numbers(self, key: str, count: int) -> np.ndarray:
        """Return the numbers of a key, (count,); InputError."""
        return self._bounded(key, np.array(schema.numbers(self._where(key), self.table[key],
                                                          count)))

    def number(self, key: str, positive: bool = True) -> float:
        """Return the number of a key, above 0, or 0 where it need not be positive; InputError."""
        return schema.number(self._where(key), self.table[key], 0.0, MOST, exclusive=positive)

    def spun(self) -> float:
        """Return the inertia of a rotor, kg m^2, 0 where it has no angular momentum."""
        return self.number('prop_inertia', False) if 'prop_inertia' in self.table else 0.0

    def matrix(self, key: str, rows: int, columns: int) -> np.ndarray:
        """Return the numbers of a key with rows, (rows, columns); InputError."""
        values, where = self.table[key], self._where(key)
        if not isinstance(values, list) or len(values) != rows:
            raise InputError(f'{where}: expected {rows} rows of {columns} numbers')
        return self._bounded(key, np.array([schema.numbers(f'{where}[{k}]', row, columns)
                                            for k, row in enumerate(values)]))

    def _bounded(self, key: str, values: np.ndarray) -> np.ndarray:
        if np.max(np.abs(values)) > MOST:
            raise InputError(f'{self._where(key)}: a number of it is beyond {MOST:g}; correct it')
        return values

    def _where(self, key: str) -> str:
        return f'{self.source.path}, {self.place(key)}'

    def draft(self) -> Draft:
        """Return the Draft of the table."""
        draft = Draft(self.source.path, self.name)
        inertia = self.matrix('J', 3, 3)
        if not np.allclose(inertia, inertia.T, rtol=1e-6, atol=0.0):
            raise InputError(f'{self._where("J")}: an inertia matrix is symmetric; correct it')
        draft.take_body(Body(self.number('mass'), np.zeros(3), inertia), self.place('mass'),
                        self.place('J'))
        gravity = 9.81
        if 'gravity_vec' in self.table:
            gravity = float(np.linalg.norm(self.numbers('gravity_vec', 3)))
            draft.take_gravity(gravity, self.place('gravity_vec'))
        else:
            draft.assumed.append(f'gravity {gravity:g} m/s2: that of crazyflow, whose file of a '
                                 'drone has none')
        draft.data['gravity'] = gravity
        arm, mixing = self.number('L'), self.matrix('mixing_matrix', 3, 4)
        # Rows: the signs of the moments about x, y, z of a thrust or torque of each motor.
        draft.take_rotors([np.array([-arm * column[1], arm * column[0], 0.0])
                           for column in mixing.T],
                          [schema.choice(f'{self._where("mixing_matrix")}[2]', float(sign),
                                         (1, -1))
                           for sign in mixing[2]], self.place('L', 'mixing_matrix'))
        self._take_curves(draft)
        self._take_drag(draft)
        if 'prop_radius' in self.table:
            draft.take('rotor_radius', self.number('prop_radius'), 'm', self.place('prop_radius'))
        if self.spun() > 0.0:
            draft.take('rotor_inertia', self.spun(), 'kg m2', self.place('prop_inertia'))
            draft.assumed.append(f'the {titled("rotor_gyro")} acts as in crazyflow; '
                                 'drone-models to 0.1 has its moment about x the other '
                                 'way, which is small where the rotors turn about equally fast')
        return draft

    def _take_curves(self, draft: Draft) -> None:
        """Enter thrust and torque over speed, their limits, and the lag."""
        thrust, torque = self.numbers('rpm2thrust', 3), self.numbers('rpm2torque', 3)
        share = draft.data['mass'] * draft.data['gravity'] / 4.0
        hover = self.rpm(thrust, share)
        speed = hover * TO_SPEED
        draft.take('thrust_coefficient', share / speed ** 2, 'N/(rad/s)^2',
                   self.place('rpm2thrust'))
        # By the slope: of rotors that turn alike the torques cancel, and their changes turn it.
        slope = float(torque[1] + 2.0 * torque[2] * hover)
        draft.take('torque_coefficient', slope / (2.0 * hover * TO_SPEED ** 2), 'N m/(rad/s)^2',
                   self.place('rpm2torque'))
        for ours, theirs in (('speed_min', 'thrust_min'), ('speed_max', 'thrust_max')):
            if theirs in self.table:
                lift = self.number(theirs, positive=ours == 'speed_max')
                draft.take(ours, self.rpm(thrust, lift) * TO_SPEED if lift else 0.0, 'rad/s',
                           self.place(theirs, 'rpm2thrust'))
        # Over the curve itself, not the share of the weight: a square has 2, without rounding.
        exponent = float((thrust[1] * hover + 2.0 * thrust[2] * hover ** 2)
                         / (thrust[0] + thrust[1] * hover + thrust[2] * hover ** 2))
        if not POWERS[0] <= exponent <= POWERS[1]:
            raise InputError(f'{self._where("rpm2thrust")}: about hover thrust goes with the '
                             f'power {exponent:.4g} of the speed; no rotor does')
        off = np.max(np.abs(NEAR ** exponent * share / np.polynomial.polynomial.polyval(
            hover * NEAR, thrust) - 1.0))
        draft.note('exponent of the thrust at hover', exponent, '1', self.place('rpm2thrust'))
        draft.assumed.append(
            f'thrust goes with the power {exponent:.4g} that it is at hover, {speed:.4g} '
            f'rad/s; from 0.7 to 1.3 of that it is off by up to {100 * off:.2g} % (rpm2thrust); '
            'torque goes with the square that has the slope of rpm2torque at hover')
        rise = fall = 0.0
        spun = self.spun()
        if 'rotor_dyn_coef' in self.table:
            rates = self.numbers('rotor_dyn_coef', 4)
            # d(rpm)/dt = a (command - rpm) + b (command^2 - rpm^2), up and down.
            up, down = (float(a + 2.0 * b * hover) for a, b in (rates[:2], rates[2:]))
            if not (up > 0.0 and down > 0.0):
                raise InputError(f'{self._where("rotor_dyn_coef")}: no lag: rates of {up:.4g} and '
                                 f'{down:.4g} 1/s at hover; expected them above 0')
            rise, fall = 1.0 / up, 1.0 / down
            draft.note('lag at hover, up and down', [rise, fall], 's',
                       self.place('rotor_dyn_coef'))
            draft.assumed.append('the lag is what it is for small changes at hover '
                                 '(rotor_dyn_coef)')

        def effects(_: Vehicle) -> Values:
            return {'motor_lag': {'rise': rise, 'fall': fall},
                    'thrust_scale': {'exponent': exponent},
                    'rotor_gyro': {'rotor_inertia': spun}}

        draft.effects = effects

    def _take_drag(self, draft: Draft) -> None:
        """Enter the linear drag."""
        if 'drag_matrix' not in self.table:
            return
        drag = -self.matrix('drag_matrix', 3, 3)
        draft.take('linear_drag', [float(value) + 0.0 for value in np.diag(drag)], 'N/(m/s)',
                   self.place('drag_matrix'))
        across = float(np.max(np.abs(drag - np.diag(np.diag(drag)))))
        if across > 0.0:
            draft.assumed.append(f'entries of drag_matrix off its diagonal, up to {across:.3g}, '
                                 'are left out')

    def rpm(self, thrust: np.ndarray, wanted: float) -> float:
        """Return the speed, rpm, at which a rotor gives a thrust, N; InputError."""
        try:
            with np.errstate(all='ignore'):
                roots = np.polynomial.polynomial.polyroots([thrust[0] - wanted, *thrust[1:]])
        except np.linalg.LinAlgError:       # a last coefficient so small that the roots overflow
            roots = np.zeros(0)
        real = [float(root.real) for root in roots
                if abs(root.imag) < 1e-9 * abs(root) and 0.0 < root.real < MOST]
        if not real or not thrust[1] + 2.0 * thrust[2] * max(real) > 0.0:
            raise InputError(f'{self._where("rpm2thrust")}: no speed gives {wanted:.4g} N; '
                             'correct the curve')
        return max(real)


def _parsed(source: Source) -> dict[str, Any]:
    try:
        import tomllib
    except ModuleNotFoundError:
        raise InputError(f'{source.path}: TOML is read from Python 3.11 on; run it there, and '
                         'give the vehicle file that -o writes') from None
    try:
        return tomllib.loads(source.text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f'{source.path}: is not TOML: {str(error)[:100]}') from None
