# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into parameters of PX4's SIH."""

from __future__ import annotations

import re

import numpy as np

from quad_ident_ros.vehicle_files.edits import Edits, shown
from quad_ident_ros.vehicle_files.new_px4_sih import new
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import inertia_for
from quad_ident_ros.vehicle_files.px4_sih import AXES, parameters_of, USUAL
from quad_ident_ros.vehicle_files.reading import FULL_SPEED
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.target import Target
from quad_ident_ros.vehicle_files.ways import LAGS


def write(base: Base) -> Edits:
    """Return the Edits that give parameters of PX4's SIH what is wanted; InputError."""
    wanted = base.wanted
    edited = _EditedParameters(base.source)
    inertia = inertia_for(base, edited, f'{base.source.path}: SIH_IXX')
    edited.set('SIH_MASS', wanted.mass, 'kg', wanted.sources['mass'])
    size = float(np.max(np.abs(inertia)))
    for axes, sign in AXES.items():
        at = 'XYZ'.index(axes[0]), 'XYZ'.index(axes[1])
        edited.set(f'SIH_I{axes}', sign * float(inertia[at]), 'kg m2',
                   wanted.sources['inertia'], size)
    for name, factor in (('SIH_L_PITCH', wanted.arms[0]), ('SIH_L_ROLL', wanted.arms[1])):
        edited.scale(name, float(factor), 'm', wanted.sources['moments'])
    for name, key, value, unit in (('SIH_T_MAX', 'thrust', wanted.thrust, 'N'),
                                   ('SIH_Q_MAX', 'torque', wanted.torque, 'N m')):
        edited.set(name, value * FULL_SPEED ** 2, unit, wanted.sources[key])
    edited.lack(['speed_max'], 'a command is a share of SIH_T_MAX, and speeds are not of the file')
    if wanted.lag > 0.0:
        edited.set('SIH_T_TAU', wanted.lag, 's', wanted.sources['rise'])
    else:
        edited.lack(LAGS, 'PX4 divides by SIH_T_TAU, which needs to be above 0')
    if wanted.rise != wanted.fall:
        edited.one_lag()
    drag = wanted.linear_drag
    edited.set('SIH_KDV', float(drag.mean()), 'N/(m/s)', wanted.sources['linear_drag'])
    if np.ptp(drag) > 0.0:
        edited.nearest['linear_drag'] = 'its mean over the axes, the same along each'
    # PX4 names the wind by where it comes from.
    for name, value in (('SIH_WIND_E', -wanted.wind[0]), ('SIH_WIND_N', -wanted.wind[1])):
        edited.set(name, float(value), 'm/s', wanted.sources['wind'])
    if wanted.wind[2] != 0.0:
        edited.nearest['wind'] = 'its part along the ground'
    edited.lack(['rotors'], "PX4's SIH has its rotors in one plane, at SIH_L_ROLL and SIH_L_PITCH")
    return edited


class _EditedParameters(Edits):
    """The text of a list of parameters."""

    def __init__(self, source: Source) -> None:
        super().__init__(source.text)
        self.parameters = parameters_of(source.text)

    def set(self, name: str, new: float, unit: str, source: str, size: float = 0.0) -> None:
        """Have a parameter hold another number; one that is not set has the usual one of PX4."""
        known = self.parameters.get(name)
        if known is not None:
            self.number(known.span, f'line {known.line}: {name}', known.value, new, unit, source,
                        size)
        elif any(self.enter(f'usual {name} of PX4', [USUAL[name]], [new], unit, source, size)):
            self._add(name, new)

    def scale(self, name: str, factor: float, unit: str, source: str) -> None:
        """Have a parameter hold the number that it has, times a factor."""
        known = self.parameters.get(name)
        self.set(name, factor * (USUAL[name] if known is None else known.value), unit, source)

    def _add(self, name: str, new: float) -> None:
        """Put a line before that of another parameter, in the form of that but for its comment."""
        key, other = max(self.parameters.items(), key=lambda each: (
            each[0] != 'SIH_VEHICLE_TYPE', each[1].line))
        begin = self.data.rfind(b'\n', 0, other.span[0]) + 1
        end = self.data.find(b'\n', other.span[0])
        line = self.data[begin:len(self.data) if end < 0 else end]
        before = line[:other.span[0] - begin]
        after = re.sub(rb'[ \t]*#[^\r]*', b'', line[other.span[1] - begin:])
        text = (before.replace(key.encode(), name.encode()) + shown([new]).encode() + after)
        self.replace(begin, begin, text.decode() + '\n')


TARGET = Target('px4_sih', ('', '.params', '.txt', '.sh', '.post'), frozenset((
    'mass', 'inertia', 'moments', 'thrust', 'torque', *LAGS, 'linear_drag', 'wind')), write, new)
