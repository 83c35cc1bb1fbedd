# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Steady wind: it changes evenly with the place."""

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import PX, PY, PZ, WIND_X, WIND_Y, WIND_Z

AT_ORIGIN = {'x': 1.0, 'y': 1.0, 'z': 0.05}
"""Usual sizes, m/s: as of a steady wind."""
PER_METRE = 0.3
"""Usual size, 1/s: a wind that falls by half of itself over two metres, as beside an obstacle, in
the jet of a fan (Rajaratnam, Turbulent Jets, 1976) or close to the ground."""


@compiled(fused=True, inlined=True)
def air(p: Table, k: int, s: Table, _: Table) -> None:
    """Add the wind at the place of the vehicle."""
    for i in range(s.shape[1]):
        x, y, z = s[PX, i], s[PY, i], s[PZ, i]
        s[WIND_X, i] += p[k, i] + p[k + 3, i] * x + p[k + 4, i] * y + p[k + 5, i] * z
        s[WIND_Y, i] += p[k + 1, i] + p[k + 6, i] * x + p[k + 7, i] * y + p[k + 8, i] * z
        s[WIND_Z, i] += p[k + 2, i] - (p[k + 3, i] + p[k + 7, i]) * z


def gradient_of(parameters: np.ndarray) -> np.ndarray:
    """Return the change of the wind (3, 3), 1/s, by row along x, y and z, of parameters (9,)."""
    return np.vstack([parameters[3:].reshape(2, 3), [0.0, 0.0, -parameters[3] - parameters[7]]])


FORM = Form(
    name='gradient', title='changes with the place',
    parameters=(*(Parameter(f'at_origin_{axis}', 'm/s', -20.0, 20.0, size,
                            f'velocity of the air along world {axis}, at the origin of the '
                            'positions') for axis, size in AT_ORIGIN.items()),
                *(Parameter(f'{axis}_by_{along}', '1/s', -5.0, 5.0, PER_METRE,
                            f'change of the velocity along world {axis} per metre along {along}')
                  for axis in 'xy' for along in 'xyz')),
    source='wind at the origin + gradient * position; along z it changes by -(x_by_x + y_by_y) '
           'per metre, since air does not pile up: e.g. Batchelor, An Introduction to Fluid '
           'Dynamics, 1967, section 2.2',
    acts_on='translation', on_rotors=False, air=air, needs_reference=True)
