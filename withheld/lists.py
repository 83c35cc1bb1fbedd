# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What realities are made of, by name: a list to develop with, another one to evaluate with.

No name is in both lists of a subject. What an evaluation has used goes over to development, as
its flights may have been looked at: all that the five runs before 2026-11-22 flew stands there.
Forms have such lists in forms/__init__.py, estimators in estimator/setups.py.
"""

DEVELOPMENT, EVALUATION = 'development', 'evaluation'
PARTS = (DEVELOPMENT, EVALUATION)

VEHICLES = {
    DEVELOPMENT: ('crazyflie_brushless', 'px4_quadrotor', 'hummingbird_small', 'hummingbird',
                  'crazyflie', 'hummingbird_large'),
    EVALUATION: ('hexacopter_x', 'lifter_3kg', 'racer_250g', 'asymmetric_h')}
PATHS = {
    DEVELOPMENT: ('sines', 'minimum_snap'),
    EVALUATION: ('stops', 'gates', 'knot', 'spirals', 'sweep')}
CONTROLLERS = {
    DEVELOPMENT: ('geometric', 'cascade'),
    EVALUATION: ('tilt_first', 'lqr')}
NOISES = {
    DEVELOPMENT: ('normal', 'student'),
    EVALUATION: ('laplace', 'breathing', 'uneven')}
STRANGERS = {
    DEVELOPMENT: ('periodic_force', 'tether', 'thrust_exponent', 'backlash', 'updraft', 'slosh',
                  'ceiling', 'neighbours', 'compass', 'branches', 'leash', 'recoil',
                  'keel', 'twisted', 'flywheel', 'carousel', 'sandbag', 'bent', 'turret', 'roped',
                  'stutter'),
    EVALUATION: ('wall', 'whirl', 'hoops', 'wand')}
