# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lag of the motors: the torque that speeds a rotor up has a lag of its own."""

from quad_ident_ros.effects.base import Form, Parameter

FORM = Form(
    name='second_order', title='second-order response',
    parameters=(Parameter('mean_lag', 's', 0.0, 0.5, 0.03,
                          'of the speed behind a command that rises evenly', later=1.0),
                Parameter('inner_lag', 's', 0.0, 0.2, 0.01,
                          'of the torque; damping 0.5 (mean_lag / inner_lag)^0.5')),
    source="inner_lag torque' = torque_wanted - torque, speed' in proportion to the torque, which "
           'is wanted in proportion to command - speed: windings or a filter of the speed '
           'controller before the inertia of the rotor; e.g. Franchi and Mallet, IEEE ICRA 2017',
    actuator='lag')
