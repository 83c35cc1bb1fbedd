# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Other forms of the effects; none of those of the evaluation is a form that the library has.

A form is a class of (size, params, rng): size 0 is no effect, size 1 opens about the gap of the
noise; rng draws what does not depend on the size. Each is a Part (influence.py): an Influence, a
Line, a Motor or a Battery (actuators.py).
"""

from withheld.forms import air, batteries, body, hung, motors

# Those that one develops with, and those that nobody looks at before a release.
DEVELOPMENT = {
    'motor_lag': {'underdamped': motors.Underdamped, 'two_poles': motors.TwoPoles,
                  'speed_dependent': motors.SpeedDependent,
                  'brushed': hung.identified('cf2x_P250'),
                  'brushless': hung.identified('cf21B_500')},
    'actuation_delay': {'jitter': motors.Jitter, 'staggered': motors.Staggered},
    'rotor_drag': {'saturating': air.Saturating, 'offset_point': air.Offset},
    'body_drag': {'power_1.6': air.Power16, 'plates': air.Plates, 'hull': hung.Hull},
    'wind': {'profile': air.Profile, 'turning': air.Turning},
    'inflow': {'momentum': air.Momentum, 'following': air.Following},
    'ground_effect': {'rational': air.Rational, 'cushion': air.Cushion},
    'battery_sag': {'knee': batteries.Knee, 'recovery': batteries.Recovery},
    'thrust_scale': {'sloped': body.Sloped},
    'mass_offset': {'payload_below': body.Payload},
    'inertia_mismatch': {'products': body.Products, 'torque': body.TorqueCoefficient,
                         'outriggers': body.Outriggers},
    'com_offset': {'sliding': body.Sliding},
    'rotor_fault': {'thrust_and_torque': body.Broken, 'chipped': body.Chipped},
    'rotor_gyro': {'unequal': body.Unequal},
    'blade_flapping': {'tilted_disk': air.TiltedDisk},
    'attitude_misalignment': {'block_with_lever': body.BlockWithLever, 'creeping': body.Creeping},
    'gyro_bias': {'warming': body.Warming, 'wandering': body.Wandering},
}
EVALUATION = {
    'motor_lag': {'torque_balance': motors.TorqueBalance, 'dead_band': motors.DeadBand},
    'actuation_delay': {'clocked': motors.Clocked, 'growing': motors.Growing},
    'rotor_drag': {'power_1.25': air.Steeper, 'skewed': air.Skewed},
    'body_drag': {'crisis': air.Crisis, 'plate': air.Plate},
    'wind': {'sheltered': air.Sheltered, 'shear': air.Shear},
    'inflow': {'flat_table': air.FlatTable, 'shadowed': air.Shadowed},
    'ground_effect': {'swept': air.Swept, 'bounded': air.Bounded},
    'battery_sag': {'exponential_zone': batteries.ExponentialZone,
                    'warming': batteries.Warming},
    'thrust_scale': {'levelling': body.Levelling},
    'mass_offset': {'other_battery': body.OtherBattery, 'cable': hung.Cable},
    'inertia_mismatch': {'entrained': body.Entrained, 'sprung': body.Sprung},
    'com_offset': {'elastic': body.Elastic},
    'rotor_fault': {'incipient': body.Incipient, 'dragging': body.Dragging},
    'rotor_gyro': {'heavy_pair': body.HeavyPair},
    'blade_flapping': {'cross_flapping': air.CrossFlapping},
    'attitude_misalignment': {'skewed_block': body.SkewedBlock, 'soft_mount': body.SoftMount},
    'gyro_bias': {'rectified': body.Rectified},
}
FORMS = {'development': DEVELOPMENT, 'evaluation': EVALUATION}
# Of no set's forms: what happens in flight is a kind of log (logs.py).
EVENTS = {'mass_offset': {'dropped': body.Dropped}}


def form_of(effect, form):
    """Return the class of a form of an effect."""
    tables = (DEVELOPMENT, EVALUATION, EVENTS)
    return next(table[effect][form] for table in tables if form in table.get(effect, ()))
