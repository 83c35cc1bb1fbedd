# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The closed loop of a diagnosis in words and cells."""

from quad_ident_ros.closed_loop.bandwidth import AXES, HIGHEST
from quad_ident_ros.closed_loop.compare import ClosedLoop, CORRECTED, NOMINAL, REAL

TITLES = ('', NOMINAL, CORRECTED, REAL, 'unit')
"""What loop_rows say."""

COSTS = ('effect', 'position error without it, m', 'cost, m', 'velocity error without it, m/s',
         'cost, m/s')
COST_LINE = 'cost of each effect: the corrected vehicle without it, all others unchanged'
"""What cost_rows say of an effect."""

LEFT = 'leaves the path'
UNKNOWN = '?'


def loop_line(one: ClosedLoop, flight: str) -> str:
    """Return what was flown, along what, in words."""
    path = ('the reference in the record' if one.asked else
            'the smoothed path of the flight, because the record has no reference, so that the '
            'error of the real vehicle is not known')
    return (f'closed loop with {one.controller}, {one.seconds:.3g} s along {flight}: bandwidth '
            f'about hover, and rms error against {path}')


def loop_rows(one: ClosedLoop) -> list[list[str]]:
    """Return the cells of the tracking of each group, and of the bandwidth of each axis."""
    rows = [[group, *(_error(one.tracking[who][group]) if who in one.tracking else UNKNOWN
                      for who in TITLES[1:-1]), unit] for group, unit in one.units.items()]
    return rows + [[f'bandwidth {axis}', *(_hertz(one, who, axis) for who in TITLES[1:-1]), 'Hz']
                   for axis in AXES]


def cost_rows(one: ClosedLoop) -> list[list[str]]:
    """Return the cells of what each effect costs the corrected vehicle."""
    rows = []
    for effect, errors in one.without.items():
        cells = []
        for group in ('position', 'velocity'):
            whole, left = one.tracking[CORRECTED][group], errors[group]
            cells += [_error(left), UNKNOWN if whole is None or left is None
                      else f'{whole - left:+.3g}']
        rows.append([effect, *cells])
    return rows


def _error(value: float | None) -> str:
    return LEFT if value is None else f'{value:.3g}'


def _hertz(one: ClosedLoop, who: str, axis: str) -> str:
    if who not in one.bandwidth:
        return UNKNOWN
    values = one.bandwidth[who]
    if values is None:
        return LEFT
    value = values[axis]
    if value is None:
        return UNKNOWN if who == REAL else f'over {HIGHEST:g}'
    return f'{value:.3g}'
