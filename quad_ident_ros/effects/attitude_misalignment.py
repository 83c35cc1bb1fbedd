# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitude measured in a tilted frame."""

from quad_ident_ros.effects import (
    attitude_misalignment_block,
    attitude_misalignment_gyro,
    attitude_misalignment_heading,
)
from quad_ident_ros.effects.base import Effect, Form, Parameter

FORM = Form(
    name='attitude', title='tilt of the attitude alone',
    parameters=tuple(Parameter(name, 'rad', -0.5, 0.5, 0.02, f'rotation about body {axis} from '
                               'the body to the frame whose attitude is recorded')
                     for name, axis in zip(('roll', 'pitch', 'yaw'), 'xyz', strict=True)),
    source='measured attitude = attitude * tilt',
    on_rotors=False,
    sensor='attitude', needs_reference=True)
EFFECT = Effect(
    name='attitude_misalignment', title='misaligned attitude or gyro',
    forms=(FORM, attitude_misalignment_block.FORM, attitude_misalignment_gyro.FORM,
           attitude_misalignment_heading.FORM),
    excitation='any flight; turns of the heading to separate it from wind',
    confused_with=('wind', 'com_offset'))
