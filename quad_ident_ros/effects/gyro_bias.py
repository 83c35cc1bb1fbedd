# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Constant bias of the measured rate."""

from quad_ident_ros.effects.base import Effect, Parameter

EFFECT = Effect(
    name='gyro_bias', title='bias of the gyroscope',
    parameters=tuple(Parameter(axis, 'rad/s', -1.0, 1.0, 0.02, f'of the rate about body {axis}')
                     for axis in 'xyz'),
    source='measured rate = rate + bias',
    excitation='any flight with a measured attitude',
    sensor='rate')
