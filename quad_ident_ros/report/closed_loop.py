# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The closed loop of a diagnosis in words and cells."""

from quad_ident_ros.closed_loop.bandwidth import AXES, HIGHEST
from quad_ident_ros.closed_loop.compare import (
    Bandwidths,
    ClosedLoop,
    CORRECTED,
    NOMINAL,
    REAL,
)
from quad_ident_ros.effects.registry import titled

TITLES = ('', NOMINAL, CORRECTED, REAL, 'unit')
"""What loop_rows say."""

COSTS = ('effect', 'of', 'without it', 'with it', 'cost', 'unit')
COST_LINE = ('cost of each effect in tracking and bandwidth: the corrected vehicle without it, '
             'all others unchanged')
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
    return rows + [[f'bandwidth {axis}', *(_hertz(one.bandwidth[who], axis, who == REAL)
                                           if who in one.bandwidth else UNKNOWN
                                           for who in TITLES[1:-1]), 'Hz'] for axis in AXES]


def cost_rows(one: ClosedLoop) -> list[list[str]]:
    """Return the cells of what each effect costs the corrected vehicle, error and bandwidth."""
    rows = []
    errors, bands = one.tracking[CORRECTED], one.bandwidth[CORRECTED]
    for effect, others in one.without.items():
        name = titled(effect)
        for group, unit in one.units.items():
            left, whole = others[group], errors[group]
            cost = UNKNOWN if left is None or whole is None else f'{whole - left:+.3g}'
            rows.append([name, f'{group} error', _error(left), _error(whole), cost, unit])
        other_bands = one.bandwidth_without[effect]
        rows += [[name, f'bandwidth {axis}', _hertz(other_bands, axis), _hertz(bands, axis),
                  _lost(other_bands, bands, axis), 'Hz'] for axis in AXES]
    return rows


def _lost(without: Bandwidths, whole: Bandwidths, axis: str) -> str:
    """Return the bandwidth that an effect costs, or the bound that HIGHEST sets to it."""
    if without is None or whole is None:
        return UNKNOWN
    left, kept = without[axis], whole[axis]
    if left is not None and kept is not None:
        return f'{left - kept:+.3g}'
    if kept is not None:
        return f'over {HIGHEST - kept:+.3g}'
    return UNKNOWN if left is None else f'under {left - HIGHEST:+.3g}'


def _error(value: float | None) -> str:
    return LEFT if value is None else f'{value:.3g}'


def _hertz(values: Bandwidths, axis: str, of_flight: bool = False) -> str:
    if values is None:
        return LEFT
    value = values[axis]
    if value is None:
        return UNKNOWN if of_flight else f'over {HIGHEST:g}'
    return f'{value:.3g}'
