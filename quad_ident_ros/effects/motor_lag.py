# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotor speed follows its command with a first-order lag."""

from quad_ident_ros.effects import motor_lag_rise_fall, motor_lag_second_order, motor_lag_slew
from quad_ident_ros.effects.base import Effect, Form, Parameter

FORM = Form(
    name='first_order', title='the same lag up and down',
    parameters=(Parameter('time_constant', 's', 0.0, 0.5, 0.03,
                          'of the first-order lag from commanded to actual rotor speed',
                          later=1.0),),
    source="first-order motor, speed' = (command - speed) / time_constant; e.g. Mahony, Kumar, "
           'Corke, IEEE Robotics & Automation Magazine 19(3), 2012',
    actuator='lag')
EFFECT = Effect(
    name='motor_lag', title='lag of the motors',
    forms=(FORM, motor_lag_rise_fall.FORM, motor_lag_slew.FORM, motor_lag_second_order.FORM),
    excitation='commands that change within a few time constants: steps, chirps, fast turns',
    confused_with=('actuation_delay', 'inertia_mismatch'))
