# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is wrong with flights and bears on a fit: said beside its values."""

SHOWS = {
    'roll': ('inertia_x', 'rotational_drag_x', 'inertia_mismatch.factor_x'),
    'pitch': ('inertia_y', 'rotational_drag_y', 'inertia_mismatch.factor_y'),
    'yaw': ('inertia_z', 'rotational_drag_z', 'inertia_mismatch.factor_z', 'torque_coefficient'),
    'vertical': ('linear_drag_z', 'body_drag.vertical', 'inflow.axial'),
    'horizontal': ('linear_drag_x', 'linear_drag_y', 'rotor_drag.coefficient',
                   'body_drag.horizontal', 'inflow.translational', 'blade_flapping.coefficient'),
}
"""What the motion along each axis shows; axes as data.quality.excitation names them."""


def cautions(flights, names):
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
            said.append(f'{", ".join(touched)}: the {axis} axis is hardly excited in any flight: '
                        'the value may be off by far more than its standard error; add a flight '
                        f'that moves the {axis} axis')
    for code in dict.fromkeys(finding.code for _, found in flights for finding in found
                              if finding.severity == 'warning'):
        (name, finding), *more = [(name, finding) for name, found in flights for finding in found
                                  if finding.code == code and finding.severity == 'warning']
        where = f'{name}{f" (and {len(more)} more)" if more else ""}'
        said.append(f'{where}: {finding.where}: {finding.message}; {finding.remedy}')
    return said
