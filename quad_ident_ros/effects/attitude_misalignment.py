# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitude measured in a tilted frame."""

from quad_ident_ros.effects.base import Effect, Parameter

EFFECT = Effect(
    name='attitude_misalignment', title='tilt of the measured attitude',
    parameters=tuple(Parameter(name, 'rad', -0.5, 0.5, 0.02, f'rotation about body {axis} from '
                               'the body to the frame whose attitude is recorded')
                     for name, axis in zip(('roll', 'pitch', 'yaw'), 'xyz', strict=True)),
    source='measured attitude = attitude * tilt',
    excitation='any flight; turns of the heading to tell it from wind',
    confused_with=('wind', 'com_offset'),
    sensor='attitude')
