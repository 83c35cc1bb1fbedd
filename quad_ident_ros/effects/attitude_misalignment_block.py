# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tilted frame of measurement: the whole sensor block, attitude and rate together."""

from quad_ident_ros.effects.base import Form, Parameter

FORM = Form(
    name='sensor_block', title='tilt of the whole sensor block',
    parameters=tuple(Parameter(f'block_{name}', 'rad', -0.5, 0.5, 0.02, f'rotation about body '
                               f'{axis} from the body to the block that measures attitude, rate '
                               'and force')
                     for name, axis in zip(('roll', 'pitch', 'yaw'), 'xyz', strict=True)),
    source='measured attitude = attitude * tilt, measured rate = inverse of tilt * rate: an '
           'autopilot that sits askew',
    sensor='block', on_rotors=False, needs_reference=True)
