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
    blades,
    body,
    carried,
    cells,
    damage,
    drags,
    drives,
    escs,
    floors,
    flows,
    grasped,
    hung,
    links,
    loads,
    motors,
    mounts,
    obstacles,
    packs,
    places,
    propellers,
    queues,
    readings,
    rotors,
    supplies,
    tables,
    trackers,
    traffic,
    wakes,
    weather,
)

# Those that one develops with, and those that nobody looks at before a release.
DEVELOPMENT = {
    'motor_lag': {'underdamped': motors.Underdamped, 'two_poles': motors.TwoPoles,
                  'speed_dependent': motors.SpeedDependent, 'torque_balance': motors.TorqueBalance,
                  'dead_band': motors.DeadBand, 'brushed': hung.identified('cf2x_P250'),
                  'brushless': hung.identified('cf21B_500'), 'coasting': escs.Coasting,
                  'slow_tail': escs.SlowTail, 'current_limited': drives.CurrentLimited,
                  'one_slow': drives.OneSlow},
    'actuation_delay': {'jitter': motors.Jitter, 'staggered': motors.Staggered,
                        'clocked': motors.Clocked, 'growing': motors.Growing,
                        'congested': links.Congested, 'drifting': links.Drifting,
                        'retransmitted': traffic.Retransmitted, 'blocked': traffic.Blocked},
    'rotor_drag': {'saturating': air.Saturating, 'offset_point': air.Offset,
                   'power_1.25': air.Steeper, 'skewed': air.Skewed,
                   'with_inflow': tables.InflowDrag, 'trailing': flows.Trailing},
    'body_drag': {'power_1.6': air.Power16, 'plates': air.Plates, 'hull': hung.Hull,
                  'crisis': air.Crisis, 'plate': air.Plate, 'nosed': tables.Nosed,
                  'tabulated': tables.Tabulated, 'arms': flows.Arms,
                  'retracting': flows.Retracting},
    'wind': {'profile': air.Profile, 'turning': air.Turning, 'sheltered': air.Sheltered,
             'shear': air.Shear, 'plume': weather.Plume, 'front': weather.Front,
             'jet': obstacles.Jet, 'street': obstacles.Street},
    'inflow': {'momentum': air.Momentum, 'following': air.Following, 'flat_table': air.FlatTable,
               'shadowed': air.Shadowed, 'stalling': wakes.Stalling, 'settling': wakes.Settling,
               'pitched': blades.Pitched, 'descending': blades.Descending},
    'ground_effect': {'rational': air.Rational, 'cushion': air.Cushion, 'swept': air.Swept,
                      'bounded': air.Bounded, 'fountain': wakes.Fountain,
                      'platform': wakes.Platform, 'ground_vortex': floors.GroundVortex,
                      'slow_cushion': floors.SlowCushion},
    'battery_sag': {'knee': batteries.Knee, 'recovery': batteries.Recovery,
                    'exponential_zone': batteries.ExponentialZone, 'warming': batteries.Warming,
                    'run_down': cells.Rundown, 'headroom': cells.Headroom,
                    'diffusing': supplies.Diffusing, 'soft_cutoff': supplies.SoftCutoff},
    'thrust_scale': {'sloped': body.Sloped, 'levelling': body.Levelling,
                     'scalloped': escs.Scalloped, 'bubble': blades.Bubble},
    'mass_offset': {'payload_below': body.Payload, 'other_battery': body.OtherBattery,
                    'cable': hung.Cable, 'bungee': loads.Bungee, 'emptying': loads.Emptying,
                    'soaking': carried.Soaking, 'chain': carried.Chain},
    'inertia_mismatch': {'products': body.Products, 'torque': body.TorqueCoefficient,
                         'outriggers': body.Outriggers, 'entrained': body.Entrained,
                         'sprung': body.Sprung, 'slipping': loads.Slipping,
                         'rattling': carried.Rattling},
    'com_offset': {'sliding': body.Sliding, 'elastic': body.Elastic, 'jumping': loads.Jumping,
                   'panning': carried.Panning},
    'rotor_fault': {'thrust_and_torque': body.Broken, 'chipped': body.Chipped,
                    'incipient': body.Incipient, 'dragging': body.Dragging,
                    'slipping_hub': rotors.SlippingHub, 'overheating': rotors.Overheating,
                    'intermittent': damage.Intermittent, 'rough': damage.Rough},
    'rotor_gyro': {'unequal': body.Unequal, 'heavy_pair': body.HeavyPair,
                   'folding': rotors.Folding, 'rubber_ring': damage.RubberRing},
    'blade_flapping': {'tilted_disk': air.TiltedDisk, 'cross_flapping': air.CrossFlapping,
                       'with_rates': rotors.RateFlapping, 'through_flow': blades.ThroughFlow},
    'attitude_misalignment': {'block_with_lever': body.BlockWithLever, 'creeping': body.Creeping,
                              'skewed_block': body.SkewedBlock, 'soft_mount': body.SoftMount,
                              'knocked': mounts.Knocked, 'distorted': readings.Distorted},
    'gyro_bias': {'warming': body.Warming, 'wandering': body.Wandering,
                  'rectified': body.Rectified, 'popcorn': mounts.Popcorn,
                  'walking': readings.Walking},
}
EVALUATION = {
    'motor_lag': {'common_supply': queues.CommonSupply, 'refreshed': queues.Refreshed},
    'actuation_delay': {'arbitrated': queues.Arbitrated, 'queued': queues.Queued},
    'rotor_drag': {'ducted': drags.Ducted},
    'body_drag': {'downwashed': drags.Downwashed, 'shedding': drags.Shedding},
    'wind': {'crest': places.Crest, 'cycled': places.Cycled},
    'inflow': {'dihedral': propellers.Dihedral, 'deficient': propellers.Deficient},
    'ground_effect': {'slope': places.Slope, 'recirculating': places.Recirculating},
    'battery_sag': {'weak_cell': packs.WeakCell, 'power_limit': packs.PowerLimit},
    'thrust_scale': {'resonant': propellers.Resonant},
    'mass_offset': {'seized': grasped.Seized, 'bulky': grasped.Bulky},
    'inertia_mismatch': {'bundled': grasped.Bundled},
    'com_offset': {'reaching': grasped.Reaching},
    'rotor_fault': {'desynchronised': propellers.Desynchronised, 'iced': propellers.Iced},
    'rotor_gyro': {'teetering': propellers.Teetering},
    'blade_flapping': {'coned': propellers.Coned},
    'attitude_misalignment': {'occluded': trackers.Occluded},
    'gyro_bias': {'changed_over': trackers.ChangedOver},
}
FORMS = {'development': DEVELOPMENT, 'evaluation': EVALUATION}
# Of no set's forms: what happens in flight is a kind of log (logs.py).
EVENTS = {'mass_offset': {'dropped': body.Dropped}}


def form_of(effect, form):
    """Return the class of a form of an effect."""
    tables = (DEVELOPMENT, EVALUATION, EVENTS)
    return next(table[effect][form] for table in tables if form in table.get(effect, ()))
