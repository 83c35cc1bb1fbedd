# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lag of the motors: two equal lags, one after the other."""

from quad_ident_ros.effects.base import Form, Parameter

FORM = Form(
    name='second_order', title='two equal lags in series',
    parameters=(Parameter('stage', 's', 0.0, 0.5, 0.03,
                          'time constant of each of the two lags'),),
    source="stage^2 speed'' + 2 stage speed' + speed = command: a speed controller, or the filter "
           'before it, and a rotor that lags in turn; the linear second-order actuator of the '
           'Aerospace Blockset (MathWorks) with a damping ratio of 1',
    actuator='lag')
