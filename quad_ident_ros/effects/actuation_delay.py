# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Commands act after a pure delay."""

from quad_ident_ros.effects.base import Effect, Form, Parameter

FORM = Form(
    name='pure_delay', title='pure delay',
    parameters=(Parameter('delay', 's', 0.0, 0.3, 0.02,
                          'from the time of a command to the time at which it acts', later=1.0),),
    source='pure delay, speed(t) = command(t - delay)',
    actuator='delay')
EFFECT = Effect(
    name='actuation_delay', title='delay of the commands', forms=(FORM,),
    excitation='commands that change within a few delays: steps, chirps, fast turns',
    confused_with=('motor_lag',))
