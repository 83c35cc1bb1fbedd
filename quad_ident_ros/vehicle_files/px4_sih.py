# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of PX4's simulator in hardware (SIH), of an airframe script or a list of them."""

from dataclasses import dataclass
import math
import re

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.effects.registry import Values
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.bodies import Body, symmetric
from quad_ident_ros.vehicle_files.reading import Draft, thrusts_as_commands
from quad_ident_ros.vehicle_files.source import MOST, Source

GRAVITY = 9.80665   # m/s^2, standard
# What PX4 has where nobody sets it.
USUAL = {'SIH_MASS': 1.0, 'SIH_IXX': 0.025, 'SIH_IYY': 0.025, 'SIH_IZZ': 0.03, 'SIH_IXY': 0.0,
         'SIH_IXZ': 0.0, 'SIH_IYZ': 0.0, 'SIH_T_MAX': 5.0, 'SIH_Q_MAX': 0.1, 'SIH_L_ROLL': 0.2,
         'SIH_L_PITCH': 0.2, 'SIH_KDV': 1.0, 'SIH_KDW': 0.025, 'SIH_T_TAU': 0.05,
         'SIH_WIND_N': 0.0, 'SIH_WIND_E': 0.0, 'SIH_VEHICLE_TYPE': 0.0}
AXES = {'XX': 1, 'YY': 1, 'ZZ': 1, 'XY': -1, 'XZ': -1, 'YZ': 1}
_HALF = math.sqrt(3.0) / 2.0
# By SIH_VEHICLE_TYPE: per rotor its place in arms of pitch and roll (forward, left), and its spin.
LAYOUTS: dict[float, tuple[tuple[float, float, int], ...]] = {
    0: ((1, -1, -1), (-1, 1, -1), (1, 1, 1), (-1, -1, 1)),
    4: ((_HALF, -0.5, -1), (0, -1, 1), (-_HALF, -0.5, -1), (-_HALF, 0.5, 1), (0, 1, -1),
        (_HALF, 0.5, 1))}
OTHERS: dict[float, str] = {1: 'a fixed wing', 2: 'a tailsitter', 3: 'a VTOL', 5: 'a rover'}
_NAME = r'\b(SIH_[A-Z0-9_]+)\b(?:[ \t]*\[[^\]\n]*\])?[ \t,:=]*'
# Neither a unit nor a decimal comma may follow the number.
_LINE = re.compile(_NAME + r'([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?![\w.]|,\d)')
_ANY = re.compile(_NAME + r'(\S*)')


@dataclass(frozen=True)
class Parameter:
    """A parameter that is set: its value, line, and from where to where that stands, in bytes."""

    value: float
    line: int
    span: tuple[int, int]


def recognises(text: str) -> bool:
    """Whether a text sets parameters of PX4's SIH."""
    return _LINE.search(text) is not None


def read(source: Source) -> Draft:
    """Return the Draft of parameters of PX4's SIH; raises InputError."""
    _check_lines(source)
    known = parameters_of(source.text)
    values = {key: one.value for key, one in known.items()}
    kind = values.get('SIH_VEHICLE_TYPE', 0.0)
    if kind not in LAYOUTS:
        raise InputError(f'{source.path}, line {known["SIH_VEHICLE_TYPE"].line}: SIH_VEHICLE_TYPE '
                         f'{kind:g} is {OTHERS.get(kind, "none that is known")}; expected 0 '
                         '(quadrotor) or 4 (hexarotor)')
    draft = Draft(source.path, source.stem)

    def place(*keys: str) -> str:
        found = [f'line {known[key].line}: {key}' for key in keys if key in known]
        return ', '.join(found) or f'usual {keys[0]} of PX4'

    def number(key: str, least: float = -math.inf) -> float:
        where = f'{source.path}, {place(key)}'
        return schema.number(where, values.get(key, USUAL[key]), least, MOST)

    # PX4's axes y and z point right and down.
    moments = symmetric(*(sign * number(f'SIH_I{axes}') + 0.0 for axes, sign in AXES.items()))
    draft.take_body(Body(number('SIH_MASS', 0.0), np.zeros(3), moments), place('SIH_MASS'),
                    place(*(f'SIH_I{axes}' for axes in AXES)))
    draft.data['gravity'] = GRAVITY
    draft.assumed.append(f'gravity {GRAVITY:g} m/s2; newer versions of PX4 have that of the '
                         'latitude, 0.3 % off at most')
    roll, pitch = number('SIH_L_ROLL', 0.0), number('SIH_L_PITCH', 0.0)
    draft.take_rotors([np.array([x * pitch, y * roll, 0.0]) for x, y, _ in LAYOUTS[kind]],
                      [spin for _, _, spin in LAYOUTS[kind]], place('SIH_L_ROLL', 'SIH_L_PITCH'))
    most, torque = number('SIH_T_MAX', 0.0), number('SIH_Q_MAX', 0.0)
    if not most > 0.0:
        raise InputError(f'{source.path}, {place("SIH_T_MAX")}: a rotor that gives no thrust')
    thrusts_as_commands(draft, most, torque / most, place('SIH_T_MAX', 'SIH_Q_MAX'),
                        signal=(0.0, 1.0))
    draft.take('linear_drag', [number('SIH_KDV', 0.0)] * 3, 'N/(m/s)', place('SIH_KDV'))
    lag, wind = number('SIH_T_TAU', 0.0), (number('SIH_WIND_E'), number('SIH_WIND_N'))
    draft.note('SIH_T_TAU', lag, 's', place('SIH_T_TAU'))
    if lag > 0.0:
        draft.assumed.append(f'the lag of {lag:g} s is one of the thrust; it is taken as that of '
                             'the speed, which is the same for small changes')
    damping = number('SIH_KDW', 0.0)
    if damping > 0.0:
        draft.assumed.append(f'SIH_KDW {damping:g} N m/(rad/s) is left out: no effect is a moment '
                             'linear in the rate; it slows roll by '
                             f'{damping / moments[0, 0]:.3g} 1/s')
    absent = [key for key in USUAL if key not in values]
    if absent:
        draft.assumed.append("PX4's usual values of what is not set: "
                             + ', '.join(f'{key} {USUAL[key]:g}' for key in absent))

    def effects(_: Vehicle) -> Values:
        # PX4 names the wind by where it comes from.
        return {'motor_lag': {'time_constant': lag}, 'wind': {'x': -wind[0], 'y': -wind[1]}}

    draft.effects = effects
    return draft


def _check_lines(source: Source) -> None:
    """Raise InputError for a parameter of SIH that is set to what is no number."""
    for number, line in enumerate(source.text.splitlines(), 1):
        for match in _ANY.finditer(line.partition('#')[0]):
            if match[1] in USUAL and not _LINE.match(line, match.start()):
                raise InputError(f'{source.path}, line {number}: {match[1]}: expected a number, '
                                 f'got {schema.shown(match[2])}')


def parameters_of(text: str) -> dict[str, Parameter]:
    """Return the parameters of SIH in a text, of each that which is set last."""
    found, begin = {}, 0
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        for match in _LINE.finditer(line.partition('#')[0]):
            if match[1] in USUAL:
                first, last = (begin + len(line[:at].encode('utf-8')) for at in match.span(2))
                found[match[1]] = Parameter(float(match[2]), number, (first, last))
        begin += len(line.encode('utf-8'))
    return found
