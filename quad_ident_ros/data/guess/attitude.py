# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The attitude in a table, as quaternion or angles, and the body rates."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from quad_ident_ros.data.columns import from_euler, POSITION, RATE, VELOCITY
from quad_ident_ros.data.guess.draft import Draft, together
from quad_ident_ros.data.guess.motion import bends, summed
from quad_ident_ros.data.guess.names import ANGLE, PITCH_DOWN
from quad_ident_ros.data.guess.series import alike, is_unit, ratio_of, unit_length
from quad_ident_ros.data.mapping import ATTITUDE, Column, factor_of, UNITS
from quad_ident_ros.data.record import EULER, QUATERNION

LEVEL, TURNED = 40.0, 60.0      # deg: the usual tilt is less; one of another order is more
FOLLOWS = 0.7           # correlation of the gyro with the turns of the right attitude, at least
CLEAR, CLEARER = 0.2, 0.3   # of correlation, that the better of two signs or orders is ahead
RADIANS, DEGREES = (0.3, 4.0), (15.0, 230.0)    # gyro over turns: 1 or 57.3 within a factor of 4
SLOWLY = 0.5            # s over which turns show above the noise of an attitude in hover
FAST, SLOW = 35.0, 12.0     # what turns by over 35 rad/s is past its gyro; below 12 deg/s nothing
                            # manoeuvres
TILTED = 1.0            # rad: nobody flies tilted by more for a tenth of the time
ROUND = 6.5             # rad: no angle is more, 2 pi with rounding
MOVES = 0.1             # rad: angles that vary by more move what flies
CALM = 10.0             # times less than angles in rad would have it, as where they are in deg


def quaternion(draft: Draft) -> None:
    """Take the attitude where it is a quaternion."""
    letters = draft.trio(QUATERNION, 'wxyz')
    if letters:
        q = draft.values(letters)
        if not is_unit(q):
            draft.guess.doubts.append(f'q: {together(letters)} are not a unit quaternion')
            return
        draft.take(QUATERNION, letters, role='pose', said='attitude')
        draft.attitude = unit_length(q)
        return
    for entries in ('0123', '1234'):
        numbers = draft.trio(QUATERNION, entries)
        if numbers and is_unit(draft.values(numbers)):
            break
    else:
        return
    order = _order(draft, draft.values(numbers))
    if order is None:
        draft.guess.doubts.append(f'quaternion: the order of {together(numbers)} (wxyz, xyzw)')
        order = 'wxyz'
    draft.order = order
    draft.columns[ATTITUDE] = Column(tuple(numbers))
    draft.taken(numbers, 'pose')
    draft.guess.said.append(f'{together(numbers)}: attitude, {order}')
    q = unit_length(draft.values(numbers))
    draft.attitude = q if order == 'wxyz' else q[:, [3, 0, 1, 2]]


def angles(draft: Draft) -> None:
    """Take roll, pitch and yaw where there is no quaternion."""
    if draft.attitude is not None:
        return
    found = [draft.one(pattern, draft.states) for pattern in ANGLE.values()]
    names = [name for name in found if name is not None]
    if len(names) < len(ANGLE):
        return
    values = draft.values(names)
    unit = draft.said_unit('phi', names, UNITS['rad']) or angle_unit(values)
    if not any(draft.units[name] for name in names) and _is_calm(draft, values):
        unit = 'deg'
    down = _pitch_down(draft, names, values * factor_of('phi', unit))
    draft.take(EULER, names, unit, role='pose', said=f'roll, pitch, yaw in {unit}'
               + (', pitch with the other sign' if down else ''))
    signs = np.array([1.0, 1.0, 1.0])
    if down:
        draft.columns['theta'] = replace(draft.columns['theta'], unit=f'-{unit}')
        signs[1] = -1.0
    draft.attitude = from_euler(*(values * factor_of('phi', unit) * signs).T)


def rates(draft: Draft) -> None:
    """Take the body rates, in the unit by the name or the attitude."""
    names = draft.found[RATE]
    if names is None or any(name not in draft.free for name in names):
        return
    values, unit = draft.values(names), draft.said_unit('wx', names, UNITS['rad/s'])
    if not unit and draft.attitude is not None and draft.t is not None:
        turned, measured = draft.turning(draft.attitude, values)
        ratio = ratio_of(measured, turned)
        unit = _unit_by(ratio)
        if ratio is not None:
            unit = unit or 'none'
        else:       # of a hover, most turns are noise
            turned, measured = draft.turning(draft.attitude, values, SLOWLY)
            unit = _unit_by(ratio_of(measured, turned))
    if unit == 'none':
        draft.guess.doubts.append(f'wx: {together(names)} are {ratio:.3g} times the rates of '
                                  'the attitude, which is not a unit')
        unit = 'rad/s'
    if not unit and _is_weight(values):
        return
    if not unit:
        fast = float(np.nanquantile(np.abs(values), 0.99))
        unit = 'deg/s' if fast > FAST else 'rad/s' if fast < SLOW else ''
    if not unit:
        draft.guess.doubts.append(f'wx: the unit of {together(names)} (rad/s, deg/s)')
        unit = 'rad/s'
    draft.take(RATE, names, unit, role='rate', said=f'body rate in {unit}')


def _unit_by(ratio: float | None) -> str:
    """Return the unit of a gyro by its ratio to the turns of the attitude, '' if unknown."""
    if ratio is None:
        return ''
    return 'rad/s' if RADIANS[0] < ratio < RADIANS[1] else (
        'deg/s' if DEGREES[0] < ratio < DEGREES[1] else '')


def _order(draft: Draft, q: np.ndarray) -> str | None:
    """Return wxyz or xyzw by the tilt of what flies, and by the gyro, or None."""
    q = unit_length(q)
    readings = {'wxyz': q, 'xyzw': q[:, [3, 0, 1, 2]]}
    tilt = {name: float(np.nanmedian(np.degrees(np.arccos(np.clip(
        1 - 2 * (one[:, 1] ** 2 + one[:, 2] ** 2), -1, 1))))) for name, one in
        readings.items()}
    level = [name for name, angle in tilt.items() if angle < LEVEL]
    if len(level) == 1 and max(tilt.values()) > TURNED:
        return level[0]
    rates = draft.found[RATE]
    if rates and draft.t is not None:
        gyro = draft.values(rates)
        close = {name: alike(*draft.turning(one, gyro)) for name, one in readings.items()}
        best = max(close, key=close.__getitem__)
        if close[best] > FOLLOWS and close[best] > min(close.values()) + CLEARER:
            return best
    return None


def _pitch_down(draft: Draft, names: Sequence[str], angles: np.ndarray) -> bool:
    """Return whether the pitch of angles (N, 3) rad has the other sign, by gyro or name."""
    named = bool(PITCH_DOWN.search(draft.names[names[1]]))
    rates = draft.found[RATE]
    if not rates or draft.t is None:
        return named
    gyro = draft.values(rates)
    close = [alike(*draft.turning(from_euler(*(angles * [1.0, sign, 1.0]).T), gyro))
             for sign in (1.0, -1.0)]
    if max(close) < FOLLOWS or abs(close[1] - close[0]) < CLEAR:
        return named
    return close[1] > close[0]


def _is_weight(values: np.ndarray) -> bool:
    """Return whether values (N, 3) have one length, as gravity in body axes has."""
    length = np.linalg.norm(values, axis=1)
    usual = float(np.nanmedian(length))
    return usual > 0.5 and float(np.nanstd(length)) < 0.01 * usual  # a gyro at rest is less


def _is_calm(draft: Draft, angles: np.ndarray) -> bool:
    """Return whether angles (N, 3) in rad would move the vehicle far more than it moved."""
    if draft.t is None or np.nanmax(np.nanstd(angles, axis=0)) < MOVES:
        return False
    q = from_euler(*angles.T)
    pairs = []
    if rates := draft.found[RATE]:
        factor = factor_of('wx', draft.unit_of(rates, UNITS['rad/s']) or 'rad/s')
        pairs += [draft.turning(q, factor * draft.values(rates))[::-1]]
    if np.nanmax(np.nanstd(angles[:, :2], axis=0)) > MOVES:
        for group, unit in ((POSITION, 'm'), (VELOCITY, 'm/s')):
            if names := draft.found[group]:
                values = draft.values(names) * factor_of(
                    group[0], draft.unit_of(names, UNITS[unit]) or unit)
                bent = bends(draft, summed(draft, values) if group == VELOCITY else values, q)
                pairs += [bent] if bent else []
    return any(0.0 < CALM * np.nanstd(moved) < np.nanstd(led) for moved, led in pairs)


def angle_unit(values: np.ndarray) -> str:
    """Return rad or deg of roll, pitch and yaw (N, 3)."""
    tilt = float(np.nanquantile(np.abs(values[:, :2]), 0.9))
    return 'deg' if tilt > TILTED or np.nanmax(np.abs(values)) > ROUND else 'rad'
