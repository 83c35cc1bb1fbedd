# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Positions, velocities and specific forces in a table, and the axes that they are in."""

from collections.abc import Sequence
import re

import numpy as np

from quad_ident_ros.data.columns import FORCE, POSITION, RATE, VELOCITY
from quad_ident_ros.data.guess.draft import Draft, together
from quad_ident_ros.data.guess.names import SAID_WORLD, TURNING, WORLD
from quad_ident_ros.data.guess.series import ratio_of, unit_length
from quad_ident_ros.data.mapping import factor_of, UNITS
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.attitude import rotate

HOVERS = 0.6, 1.6       # of gravity: the usual specific force of what flies
ONE_WAY = 0.5           # of its size, that its median along one direction is: thrust is along z
QUICK = 100.0           # m/s: multirotors do under 60, so faster ones are in mm
BELOW = 0.3             # of the greatest depth or height that the other one may be: ground is 0
BETTER = 1.5            # times that the wrong axes are further off than the right ones
NEAREST = 10 ** 0.5     # times; units are ten times apart, and drag makes a path bend less
SPAN = 0.5              # s, over which noise of single samples counts for little


def vectors(draft: Draft) -> None:
    """Find the trios first: one that is found is not taken for another."""
    draft.found = {group: draft.trio(group, 'xyz') or draft.numbered(group)
                   for group in (POSITION, VELOCITY, RATE, FORCE)}
    if draft.found[RATE] is None:
        turning = [draft.one(rf'(^|_){axis}_?(rate|speed|vel)$', draft.states)
                   for axis in TURNING]
        names = [name for name in turning if name is not None]
        if len(names) == len(TURNING):
            draft.found[RATE] = names


def positions(draft: Draft) -> None:
    """Take the position, in the unit by name, velocity or tilt."""
    names = draft.found[POSITION]
    if names is None or any(name not in draft.free for name in names):
        return
    unit = draft.said_unit('px', names, UNITS['m'])
    if not unit and draft.t is not None:
        with np.errstate(all='ignore'):
            speed = np.linalg.norm(np.diff(draft.values(names), axis=0), axis=1) / draft.dt()
        speed = speed[np.isfinite(speed) & (speed > 0)]
        quick = float(np.quantile(speed, 0.9)) if len(speed) else 0.0
        unit = _by_velocity(draft, names) or _by_tilt(draft, names)
        if not unit and QUICK < quick < 10 * QUICK:
            draft.guess.doubts.append(f'px: the unit of {together(names)} (mm, cm)')
        unit = unit or ('mm' if quick > QUICK else 'm')
    draft.take(POSITION, names, unit or 'm', role='pose', said=f'position in {unit or "m"}')


def forces(draft: Draft) -> None:
    """Take the specific force, in the unit by name, or else that in which it is about gravity."""
    names = draft.found[FORCE]
    if names is None or any(name not in draft.free for name in names):
        return
    values = draft.values(names)
    usual = float(np.nanmedian(np.linalg.norm(values, axis=1)))
    steady = float(np.linalg.norm(np.nanmedian(values, axis=0))) > ONE_WAY * usual
    said = draft.said_unit('ax', names, UNITS['m/s^2'])
    if said:
        usual *= factor_of('ax', said) / GRAVITY
    for unit, one in ((said, 1.0),) if said else (('m/s^2', GRAVITY), ('g', 1.0), ('mg', 1000.0)):
        if steady and HOVERS[0] * one < usual < HOVERS[1] * one:
            draft.take(FORCE, names, unit, role='specific_force',
                       said=f'specific force in {unit}')
            return
    if usual < HOVERS[0] or not steady:
        draft.guess.said.append(f'{together(names)}: not taken, an acceleration without '
                                'gravity is not a specific force')
        draft.taken(names, '')
        draft.found[FORCE] = draft.trio(FORCE, 'xyz') or draft.numbered(FORCE)
        forces(draft)
        return
    draft.guess.doubts.append(f'ax: the unit of {together(names)}, {usual:.3g} as a rule')


def axes(draft: Draft) -> None:
    """Tell FLU or FRD, and ENU or NED, by where up is."""
    if (draft.given.world, draft.given.body) != ('ENU', 'FLU'):
        return
    down = None
    why = ''
    if 'az' in draft.columns:
        down = bool(np.nanmedian(draft.table.columns[draft.columns['az'].names[0]]) < 0)
        why = 'the accelerometer'
    elif 'pz' in draft.columns:
        height = draft.table.columns[draft.columns['pz'].names[0]]
        low, high = np.nanquantile(height, [0.05, 0.95])
        if high < BELOW * abs(low):
            down, why = True, 'the height'
        elif low > -BELOW * abs(high):
            down, why = False, 'the height'
    known = [found for group in (POSITION, VELOCITY) if (found := draft.found[group])]
    named = {_named_world([draft.names[name] for name in found]): found for found in known}
    text = ' '.join(draft.names.values())
    if down is None and ('NED' in named or re.search(r'(^|_| )(ned|frd)(_| |$)', text)):
        down, why = True, 'the names'
    if down:
        draft.body = 'FRD'
        level = draft.attitude is None or _up(draft.attitude) > 0
        draft.world = 'NED' if level else 'ENU'
    elif down is not None and draft.attitude is not None and _up(draft.attitude) < 0:
        draft.guess.doubts.append('world, body: by the attitude the vehicle flies upside down')
    for world in named.keys() - {'', draft.world}:
        draft.guess.doubts.append(f'world: {together(named[world])} are {world} by '
                                  f'their names, the others {draft.world} by {why}')
    said = f'by {why}' if why else 'assumed, as nothing shows it'
    draft.guess.said.append(f'frames {draft.world} and {draft.body}, {said}')


def velocities(draft: Draft) -> None:
    """Take the velocity, in the axes by name, position or accelerometer."""
    names = draft.found[VELOCITY]
    if names is None or any(name not in draft.free for name in names):
        return
    values = draft.values(names)
    unit = draft.said_unit('vx', names, UNITS['m/s'])
    if not unit:
        fast = float(np.nanquantile(np.abs(values), 0.9))
        place = draft.columns['px'].unit if 'px' in draft.columns else ''
        unit = 'm/s' if fast <= QUICK else 'cm/s' if place == 'cm' else 'mm/s'
        unit = _nearest(draft, values, unit)
    frame, said = 'world', 'as no stream contradicts it'
    if draft.of_body(names):
        frame, said = 'body', 'by its name'
    if frame == 'body' and draft.attitude is None:
        draft.taken(names, '')
        draft.guess.said.append(f'{together(names)}: not taken, a velocity in body axes needs an '
                                'attitude')
        return
    off = _off(draft, values * factor_of('vx', unit))
    if off is not None and max(off) > BETTER * min(off):
        frame = 'world' if off[0] < off[1] else 'body'
        said = 'by the position' if 'px' in draft.columns else 'by the accelerometer'
    draft.take(VELOCITY, names, unit, frame, role='velocity',
               said=f'velocity in {unit}, {frame} axes, {said}')


def _named_world(names: Sequence[str]) -> str:
    """Return the axes of the world that plain names of a trio say, '' for none."""
    said = SAID_WORLD.search(names[0])
    return WORLD.get(tuple(names), said[1].upper() if said else '')


def _by_velocity(draft: Draft, names: Sequence[str]) -> str:
    """Return the unit of positions of which the velocity is the change, '' if unknown."""
    given = draft.found[VELOCITY]
    if given is None:
        return ''
    said = draft.unit_of(given, UNITS['m/s'])
    if not said and np.nanquantile(np.abs(draft.values(given)), 0.9) > QUICK:
        return ''       # it is in mm or cm, and so is the position
    said = said or 'm/s'
    place, speed = draft.values(names), draft.values(given) * factor_of('vx', said)
    width = max(1, round(SPAN / draft.period()))
    if len(place) < 4 * width:
        return ''
    moved = place[width:] - place[:-width]
    sums = np.vstack([np.zeros(3), np.cumsum(np.nan_to_num(
        0.5 * (speed[1:] + speed[:-1]) * draft.dt()[:, None]), axis=0)])
    ratio = ratio_of(moved, sums[width:] - sums[:-width])
    if ratio is None:
        return ''       # a velocity in body axes of a vehicle that turns, or sparse samples
    for unit, factor in (('m', 1.0), ('cm', 100.0), ('mm', 1000.0)):
        if factor / 2 < ratio < 2 * factor:
            return unit
        if not draft.unit_of(given, UNITS['m/s']) and 0.7 < factor * ratio < 1.4:
            return 'm'      # and the velocity is in cm/s or mm/s
    draft.guess.doubts.append(f'px: {together(names)} change {ratio:.3g} times as fast as '
                              f'{together(given)} says, which is not a unit')
    return 'm'


def _by_tilt(draft: Draft, names: Sequence[str]) -> str:
    """
    Return the unit of positions that bend as a tilting thrust makes them, '' if unknown.

    What hovers accelerates by g times the tangent of its tilt.
    """
    if draft.attitude is None:
        return ''
    bent = bends(draft, draft.values(names), draft.attitude)
    ratio = ratio_of(*bent) if bent else None
    if ratio is None:
        return ''
    return next((unit for unit, factor in (('m', 1.0), ('cm', 100.0), ('mm', 1000.0))
                 if factor / NEAREST < ratio < factor * NEAREST), '')


def bends(draft: Draft, place: np.ndarray, attitude: np.ndarray
          ) -> tuple[np.ndarray, np.ndarray] | None:
    """
    Return second differences (n, 2) of a position (N, 3), and those that a thrust gives it.

    The thrust is along attitudes (N, 4). None where the record is too short.
    """
    w, x, y, z = attitude.T
    up = 1 - 2 * (x ** 2 + y ** 2)
    leaning = GRAVITY * np.stack([2 * (x * z + w * y), 2 * (y * z - w * x)], axis=-1) / up[:, None]
    for _ in range(2):      # to a velocity, to a position
        leaning = summed(draft, leaning)
    width = max(1, round(SPAN / draft.period()))
    if len(leaning) < 4 * width:
        return None
    first, second = (one[2 * width:] - 2 * one[width:-width] + one[:-2 * width]
                     for one in (place[:, :2], leaning))
    return first, second


def summed(draft: Draft, values: np.ndarray) -> np.ndarray:
    """Return the integral (N, k) of values (N, k) over the time."""
    return np.cumsum(np.nan_to_num(values) * np.append(draft.dt(), 0.0)[:, None], axis=0)


def _nearest(draft: Draft, values: np.ndarray, unit: str) -> str:
    """
    Return the unit in which velocities (N, 3) go with the other streams, that given if open.

    They have to do so better than no velocity: noise in hover is least off in the smallest unit.
    """
    factors = {'': 0.0, **{one: factor_of('vx', one) for one in ('m/s', 'cm/s', 'mm/s')}}
    off = {one: min(found) for one, factor in factors.items()
           if (found := _off(draft, values * factor)) is not None}
    best = min(off, key=off.__getitem__, default=unit)
    return best if off and BETTER * off[best] < min(off[unit], off['']) else unit


def _off(draft: Draft, speed: np.ndarray) -> list[float] | None:
    """
    Return how far off a velocity (N, 3) is, read in world and in body axes, or None.

    Without an attitude it can be read in world axes alone, and held against the position alone.
    """
    if draft.t is None or draft.attitude is None and 'px' not in draft.columns:
        return None
    readings = [speed]
    if draft.attitude is not None:
        q = unit_length(draft.attitude)
        readings.append(rotate(q, speed))
    with np.errstate(all='ignore'):
        dt = np.diff(draft.t)[:, None]
        if 'px' in draft.columns:
            moved = np.diff(draft.scaled(POSITION), axis=0)
            rest = [moved - 0.5 * (one[1:] + one[:-1]) * dt for one in readings]
        elif 'ax' in draft.columns:
            weight = np.array([0.0, 0.0, GRAVITY if draft.world == 'NED' else -GRAVITY])
            force = rotate(q, draft.scaled(FORCE)) + weight
            rest = [np.diff(one, axis=0) - 0.5 * (force[1:] + force[:-1]) * dt
                    for one in readings]
        else:
            return None
        width = max(1, round(SPAN / draft.period()))
        if len(speed) < 4 * width:
            return None
        sums = [np.cumsum(np.nan_to_num(one), axis=0) for one in rest]
        off = [float(np.median(np.linalg.norm(one[width:] - one[:-width], axis=1)))
               for one in sums]
    return off if np.isfinite(off).all() else None


def _up(q: np.ndarray) -> float:
    """Return the median share of up along the body's own z axis."""
    return float(np.nanmedian(1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2)))
