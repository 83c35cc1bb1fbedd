# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Other forms of the effects; none of those of the evaluation is a form that the library has.

A form is a class of (size, params, rng): size 0 is no effect, size 1 opens about the gap of the
noise; rng draws what does not depend on the size. Each is a Part (influence.py): an Influence, a
Line, a Motor or a Battery (actuators.py).
"""

from withheld.forms import (
    air,
    batteries,
    body,
    cells,
    escs,
    hung,
    links,
    loads,
    motors,
    mounts,
    rotors,
    tables,
    wakes,
    weather,
)

# Those that one develops with, and those that nobody looks at before a release.
DEVELOPMENT = {
    'motor_lag': {'underdamped': motors.Underdamped, 'two_poles': motors.TwoPoles,
                  'speed_dependent': motors.SpeedDependent,
                  'torque_balance': motors.TorqueBalance, 'dead_band': motors.DeadBand,
                  'brushed': hung.identified('cf2x_P250'),
                  'brushless': hung.identified('cf21B_500')},
    'actuation_delay': {'jitter': motors.Jitter, 'staggered': motors.Staggered,
                        'clocked': motors.Clocked, 'growing': motors.Growing},
    'rotor_drag': {'saturating': air.Saturating, 'offset_point': air.Offset,
                   'power_1.25': air.Steeper, 'skewed': air.Skewed},
    'body_drag': {'power_1.6': air.Power16, 'plates': air.Plates, 'hull': hung.Hull,
                  'crisis': air.Crisis, 'plate': air.Plate},
    'wind': {'profile': air.Profile, 'turning': air.Turning, 'sheltered': air.Sheltered,
             'shear': air.Shear},
    'inflow': {'momentum': air.Momentum, 'following': air.Following, 'flat_table': air.FlatTable,
               'shadowed': air.Shadowed},
    'ground_effect': {'rational': air.Rational, 'cushion': air.Cushion, 'swept': air.Swept,
                      'bounded': air.Bounded},
    'battery_sag': {'knee': batteries.Knee, 'recovery': batteries.Recovery,
                    'exponential_zone': batteries.ExponentialZone, 'warming': batteries.Warming},
    'thrust_scale': {'sloped': body.Sloped, 'levelling': body.Levelling},
    'mass_offset': {'payload_below': body.Payload, 'other_battery': body.OtherBattery,
                    'cable': hung.Cable},
    'inertia_mismatch': {'products': body.Products, 'torque': body.TorqueCoefficient,
                         'outriggers': body.Outriggers, 'entrained': body.Entrained,
                         'sprung': body.Sprung},
    'com_offset': {'sliding': body.Sliding, 'elastic': body.Elastic},
    'rotor_fault': {'thrust_and_torque': body.Broken, 'chipped': body.Chipped,
                    'incipient': body.Incipient, 'dragging': body.Dragging},
    'rotor_gyro': {'unequal': body.Unequal, 'heavy_pair': body.HeavyPair},
    'blade_flapping': {'tilted_disk': air.TiltedDisk, 'cross_flapping': air.CrossFlapping},
    'attitude_misalignment': {'block_with_lever': body.BlockWithLever, 'creeping': body.Creeping,
                              'skewed_block': body.SkewedBlock, 'soft_mount': body.SoftMount},
    'gyro_bias': {'warming': body.Warming, 'wandering': body.Wandering,
                  'rectified': body.Rectified},
}
EVALUATION = {
    'motor_lag': {'coasting': escs.Coasting, 'slow_tail': escs.SlowTail},
    'actuation_delay': {'congested': links.Congested, 'drifting': links.Drifting},
    'rotor_drag': {'with_inflow': tables.InflowDrag},
    'body_drag': {'nosed': tables.Nosed, 'tabulated': tables.Tabulated},
    'wind': {'plume': weather.Plume, 'front': weather.Front},
    'inflow': {'stalling': wakes.Stalling, 'settling': wakes.Settling},
    'ground_effect': {'fountain': wakes.Fountain, 'platform': wakes.Platform},
    'battery_sag': {'run_down': cells.Rundown, 'headroom': cells.Headroom},
    'thrust_scale': {'scalloped': escs.Scalloped},
    'mass_offset': {'bungee': loads.Bungee, 'emptying': loads.Emptying},
    'inertia_mismatch': {'slipping': loads.Slipping},
    'com_offset': {'jumping': loads.Jumping},
    'rotor_fault': {'slipping_hub': rotors.SlippingHub, 'overheating': rotors.Overheating},
    'rotor_gyro': {'folding': rotors.Folding},
    'blade_flapping': {'with_rates': rotors.RateFlapping},
    'attitude_misalignment': {'knocked': mounts.Knocked},
    'gyro_bias': {'popcorn': mounts.Popcorn},
}
FORMS = {'development': DEVELOPMENT, 'evaluation': EVALUATION}
# Of no set's forms: what happens in flight is a kind of log (logs.py).
EVENTS = {'mass_offset': {'dropped': body.Dropped}}


def form_of(effect, form):
    """Return the class of a form of an effect."""
    tables = (DEVELOPMENT, EVALUATION, EVENTS)
    return next(table[effect][form] for table in tables if form in table.get(effect, ()))
