# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What realities are made of, by name: a list to develop with, another one to evaluate with.

No name is in both lists of a subject. What an evaluation has used goes over to development, as
its flights may have been looked at: all that the five runs before 2026-11-22 flew stands there.
Forms have such lists in forms/__init__.py, estimators in estimator/setups.py; ORDINARY are those
of development that the first draws flew, as motors, air, loads and sensors have them as a rule.
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
                  'stutter', 'wall', 'whirl', 'hoops', 'wand', 'barometer', 'retractor', 'glitch',
                  'pushed'),
    EVALUATION: ('lead', 'moving_base', 'rangefinder', 'sticks')}
ORDINARY = {
    'motor_lag': ('underdamped', 'two_poles', 'speed_dependent', 'brushed', 'brushless',
                  'torque_balance', 'dead_band'),
    'actuation_delay': ('jitter', 'staggered', 'clocked', 'growing'),
    'rotor_drag': ('saturating', 'offset_point', 'power_1.25', 'skewed'),
    'body_drag': ('power_1.6', 'plates', 'hull', 'crisis', 'plate'),
    'wind': ('profile', 'turning', 'sheltered', 'shear'),
    'inflow': ('momentum', 'following', 'flat_table', 'shadowed'),
    'ground_effect': ('rational', 'cushion', 'swept', 'bounded'),
    'battery_sag': ('knee', 'recovery', 'exponential_zone', 'warming'),
    'thrust_scale': ('sloped', 'levelling'),
    'mass_offset': ('payload_below', 'other_battery', 'cable'),
    'inertia_mismatch': ('products', 'torque', 'entrained', 'outriggers'),
    'com_offset': ('sliding', 'elastic'),
    'rotor_fault': ('chipped', 'incipient', 'dragging'),
    'rotor_gyro': ('unequal', 'heavy_pair'),
    'blade_flapping': ('tilted_disk', 'cross_flapping'),
    'attitude_misalignment': ('block_with_lever', 'creeping', 'skewed_block', 'soft_mount'),
    'gyro_bias': ('warming', 'wandering', 'rectified')}
