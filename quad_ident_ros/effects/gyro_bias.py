# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Constant bias of the measured rate."""

from quad_ident_ros.effects.base import Effect, Form, Parameter

FORM = Form(
    name='constant', title='constant bias',
    parameters=tuple(Parameter(axis, 'rad/s', -1.0, 1.0, 0.02, f'of the rate about body {axis}')
                     for axis in 'xyz'),
    source='measured rate = rate + bias',
    on_rotors=False,
    sensor='rate', needs_reference=True)
EFFECT = Effect(
    name='gyro_bias', title='bias of the gyroscope', forms=(FORM,),
    excitation='any flight with a measured attitude')
