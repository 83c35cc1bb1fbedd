# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Steady wind."""

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import WIND_X, WIND_Y, WIND_Z

SIZES = {'x': 1.0, 'y': 1.0, 'z': 0.05}
"""Usual sizes, m/s. Over ground, air that moves steadily moves level: its mean rises or sinks by
some centimetres per second (Kaimal and Finnigan, Atmospheric Boundary Layer Flows, 1994)."""
MOST = {'x': np.inf, 'y': np.inf, 'z': 1.0}
"""Largest values identified, m/s: what seems to rise or sink faster all along flights is another
force. Thermals rise at about 1 m/s (Lenschow, Stephens, Boundary-Layer Meteorology 19, 1980)."""


@compiled(fused=True, inlined=True)
def air(p: Table, k: int, s: Table) -> None:
    """Set the wind."""
    for i in range(s.shape[1]):
        s[WIND_X, i] = p[k, i]
        s[WIND_Y, i] = p[k + 1, i]
        s[WIND_Z, i] = p[k + 2, i]


FORM = Form(
    name='steady', title='steady wind',
    parameters=tuple(Parameter(axis, 'm/s', -20.0, 20.0, size,
                               f'velocity of the air along world {axis}', identified=MOST[axis])
                     for axis, size in SIZES.items()),
    source='air velocity = velocity - wind, in everything that depends on it; identified with a '
           'vertical part of 1 m/s at most',
    on_rotors=False,
    air=air, needs_reference=True)
EFFECT = Effect(
    name='wind', title='steady wind', forms=(FORM,),
    excitation='flight in several directions or headings; it acts through drag, known or found',
    confused_with=('attitude_misalignment', 'rotor_drag', 'body_drag'),
    per_flight=(1.0, 1.0, 0.0), needs_air=True)
