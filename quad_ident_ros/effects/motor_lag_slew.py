# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lag of the motors: no rotor changes its speed faster than a limit."""

from quad_ident_ros.effects.base import Form, Parameter

FORM = Form(
    name='slew', title='limited rate of change of the speed',
    parameters=(Parameter('slew', 's^2/rad', 0.0, 1.0, 0.03,
                          'reciprocal of the most that a speed changes in a second'),),
    source="|speed'| <= 1 / slew: the current of speed controllers is limited, and so is the "
           'torque that speeds a rotor up',
    actuator='lag')
