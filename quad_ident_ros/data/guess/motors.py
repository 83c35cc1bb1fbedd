# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The commands, measured rotor speeds and battery in a table."""

import re

import numpy as np

from quad_ident_ros.data.guess.draft import Draft
from quad_ident_ros.data.guess.names import (
    BATTERY,
    COMMANDED,
    CORNER,
    CORNERS,
    CRAZYFLIE,
    FORCES,
    MOTOR,
    NO_UNITS,
    REPORTED,
    SAID_PWM,
    SPEED,
)
from quad_ident_ros.data.mapping import factor_of, UNITS
from quad_ident_ros.data.motor_order import about_motors, quad, rotors_of
from quad_ident_ros.data.record import INPUTS
from quad_ident_ros.data.signal_kind import are_signals, kinds_of, TITLES

AROUND = (1, -1), (-1, -1), (-1, 1), (1, 1)     # forward, left: front right to front left
SPEEDS = 'rad/s', 'rpm', 'krpm', 'Hz'
SLOWEST = 20.0          # rad/s: no rotor that flies turns more slowly
FEWEST, MOST = 3, 12    # motors
CELLS = 2.0, 100.0      # V: one cell that is empty, to over 20 in series; more is in mV


def motors(draft: Draft) -> None:
    """Take the commands, or outputs to the motors, and measured rotor speeds."""
    speeds, signals = _numbered(draft, SPEED), _numbered(draft, MOTOR)
    asked = [names for names in speeds if COMMANDED.search(draft.names[names[0]])]
    others = [names for names in signals if not draft.unit_of(names, SPEEDS)]
    reported = [names for names in signals if names not in others
                and not COMMANDED.search(draft.names[names[0]])
                and (others or REPORTED.search(draft.names[names[0]]))]
    for measured in (*speeds, *reported):
        if measured in asked:
            continue
        values, unit = draft.logged(measured), _unit_of(draft, 'rotor1', measured)
        if np.nanmin(values) >= 0 and np.nanmedian(values) * factor_of('rotor1', unit) > SLOWEST:
            draft.take([f'rotor{k}' for k in range(1, len(measured) + 1)], measured, unit,
                       role='rotors', said=f'measured rotor speeds in {unit}')
            break
    if set(INPUTS) <= set(draft.free) and not are_signals(draft.logged(INPUTS)) and all(
            column.names == (role,) for role, column in draft.columns.items()):
        draft.take(INPUTS, INPUTS, role='commands', said='thrust and moments, for the other '
                   'columns have the names of a flight record')
        return
    names = next((names for names in (*asked, *signals) if names not in reported), None)
    names = names or _corners(draft)
    if not names:
        return
    values = draft.logged(names)
    kinds = kinds_of(values)
    if FORCES.search(draft.names[names[0]]) and list(kinds) != ['normalised']:
        return
    unit = _unit_of(draft, 'cmd1', names) if names in asked else draft.unit_of(names, SPEEDS)
    if unit:
        draft.take([f'cmd{k}' for k in range(1, len(names) + 1)], names, unit,
                   role='commands', said=f'rotor speed commands in {unit}')
        return
    if SAID_PWM.search(draft.names[names[0]]) and list(kinds) == ['pwm']:
        rotors = draft.guess.motors and rotors_of(draft.guess.motors)
        draft.guess.motors = about_motors(rotors or (), 'the names of the columns', 'pwm')
    if CRAZYFLIE.fullmatch(draft.names[names[0]]) and list(kinds) == ['duty16']:
        draft.guess.motors = about_motors(quad(*AROUND), 'the order of the Crazyflie', 'duty16')
    what = ' or '.join(TITLES[kind] for kind in kinds)
    draft.take([f'output{k}' for k in range(1, len(names) + 1)], names, role='commands',
               said='outputs, ' + (f'{what} by their size' if what else 'of an unknown kind'))


def battery(draft: Draft) -> None:
    """Take the voltage of the battery."""
    name = draft.one(BATTERY.pattern)
    if name is None or draft.units[name] not in (*UNITS['V'], *NO_UNITS):    # as % of its charge
        return
    usual = float(np.nanmedian(draft.table.columns[name]))
    unit = 'mV' if usual > 1000 else 'V'
    if CELLS[0] < usual * factor_of('vbat', unit) < CELLS[1]:
        draft.take(('vbat',), (name,), unit, role='battery', said=f'battery in {unit}')


def _unit_of(draft: Draft, role: str, names: list[str]) -> str:
    """Return the unit of rotor speeds by their names, rad/s where these say none."""
    said = (unit for unit in ('krpm', 'rpm') if any(unit in draft.names[name] for name in names))
    return draft.said_unit(role, names, SPEEDS) or next(said, 'rad/s')


def _numbered(draft: Draft, pattern: re.Pattern) -> list[list[str]]:
    """Return the columns of 3 to 12 numbers from 0 or 1 on, by name, the shortest name first."""
    groups: dict[tuple[str, str], dict[int, str]] = {}
    for name in draft.free:
        match = pattern.search(draft.names[name])
        if match:
            groups.setdefault((draft.names[name][:match.start(3)], draft.units[name]), {})[
                int(match.group(3))] = name
    whole = []
    for (prefix, _), group in groups.items():
        first = min(group)
        count = next(k for k in range(len(group) + 1) if first + k not in group)
        names = [group[first + k] for k in range(count)]
        moving = [np.nanstd(draft.table.columns[name]) > 0 for name in names]
        while len(names) > FEWEST and any(moving) and not moving[len(names) - 1]:
            names.pop()     # channels that nothing is on
        if first in (0, 1) and FEWEST <= len(names) <= MOST:
            whole.append((len(prefix), names))
    return [names for _, names in sorted(whole)]


def _corners(draft: Draft) -> list[str] | None:
    """Return the columns of four motors by their places, from front right to front left."""
    asked = [draft.one(CORNER.format(pattern)) for pattern in CORNERS.values()]
    found = [name for name in asked if name is not None]
    if len(set(found)) < 4:
        return None
    draft.guess.motors = about_motors(quad(*AROUND), 'the names of the columns')
    return found
