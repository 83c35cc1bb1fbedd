# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tilted frame of measurement: the rate sensor alone."""

from quad_ident_ros.effects.base import Form, Parameter

FORM = Form(
    name='gyro', title='tilt of the rate sensor alone',
    parameters=tuple(Parameter(f'gyro_{name}', 'rad', -0.5, 0.5, 0.02, f'rotation about body '
                               f'{axis} from the body to the frame in which rates are measured')
                     for name, axis in zip(('roll', 'pitch', 'yaw'), 'xyz', strict=True)),
    source='measured rate = inverse of tilt * rate: attitude from motion capture whose body is '
           'level, rates from an autopilot that is not',
    sensor='rate', on_rotors=False, needs_reference=True)
