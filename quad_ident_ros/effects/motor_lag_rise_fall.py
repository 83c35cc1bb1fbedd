# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lag of the motors: rotors speed up with one time constant and slow down with another."""

from quad_ident_ros.effects.base import Form, Parameter

FORM = Form(
    name='rise_fall', title='different lags up and down',
    parameters=tuple(Parameter(name, 's', 0.0, 0.5, 0.03,
                               f'time constant while the rotor {how}', later=0.5)
                     for name, how in (('rise', 'speeds up'), ('fall', 'slows down'))),
    source="speed' = (command - speed) / rise below the command, / fall above it: a motor drives "
           'a rotor up, drag alone brakes it; e.g. the motor model of RotorS, Furrer et al., '
           'Robot Operating System (ROS), Springer 2016',
    actuator='lag')
