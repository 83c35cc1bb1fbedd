# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitude measured in a world whose north is not that of the position."""

from quad_ident_ros.effects.base import Form, Parameter

FORM = Form(
    name='heading', title='heading offset',
    parameters=(Parameter('heading', 'rad', -0.8, 0.8, 0.03, 'rotation about the vertical from '
                          'the axes of position and velocity to those of the recorded attitude'),),
    source='measured attitude = turn about the vertical * attitude: a compass beside iron or '
           'currents, a declination that is missing',
    sensor='heading', on_rotors=False, needs_reference=True)
