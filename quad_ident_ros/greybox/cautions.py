# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Faults of flights that affect a fit, reported beside its values."""

from collections.abc import Iterable, Sequence

from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.effects.registry import PARAMETERS, titled

CONSTANTS = {
    'roll': ('inertia_x', 'rotational_drag_x'),
    'pitch': ('inertia_y', 'rotational_drag_y'),
    'yaw': ('inertia_z', 'rotational_drag_z', 'torque_coefficient'),
    'vertical': ('linear_drag_z',),
    'horizontal': ('linear_drag_x', 'linear_drag_y'),
}
SHOWS = {axis: (*constants, *(f'{effect}.{parameter.name}' for effect, parameter in PARAMETERS
                              if parameter.excited_by == axis))
         for axis, constants in CONSTANTS.items()}
"""What the motion along each axis shows; axes as data.quality.excitation names them."""


def cautions(flights: Sequence[tuple[str, Sequence[Finding]]], names: Iterable[str]) -> list[str]:
    """
    Return lines on a fit: its parameters that no flight moves, and the warnings on the flights.

    Args: flights: (name, Findings) of each; names: full names of what is freed.
    """
    still = [{finding.where for finding in found if finding.code == 'excitation'}
             for _, found in flights]
    said = []
    for axis, shown in SHOWS.items():
        touched = [name for name in names if name in shown]
        if touched and all(axis in axes for axes in still):
            said.append(f'{", ".join(map(titled, touched))}: the {axis} axis is hardly excited '
                        'in any flight: the value may be off by far more than its standard '
                        f'error; add a flight that moves the {axis} axis')
    for code in dict.fromkeys(finding.code for _, found in flights for finding in found
                              if finding.severity == 'warning'):
        (name, finding), *more = [(name, finding) for name, found in flights for finding in found
                                  if finding.code == code and finding.severity == 'warning']
        where = f'{name}{f" (and {len(more)} more)" if more else ""}'
        said.append(f'{where}: {finding.where}: {finding.message}; {finding.remedy}')
    return said
