# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Where motors 1.. are on the usual frames, and how they turn: PX4 and ArduPilot have them alike.

Sources: the geometries of PX4's mixers (src/lib/mixer/MultirotorMixer, 1.12), and
AP_MotorsMatrix.cpp of ArduPilot 4.0.
"""

from dataclasses import replace
import math

from quad_ident_ros.model.vehicle import Rotor

_CCW, _CW = -1, 1       # spin: the sign of the torque about the upward axis that a rotor causes

# Each motor: its direction from the front, clockwise from above, in deg; and how it turns.
_MOTORS = {
    'quad x': ((45, _CCW), (-135, _CCW), (-45, _CW), (135, _CW)),
    'quad +': ((90, _CCW), (-90, _CCW), (0, _CW), (180, _CW)),
    'quad x of Betaflight': ((135, _CW), (45, _CCW), (-135, _CCW), (-45, _CW)),
    'quad x of Betaflight, turning outwards': ((135, _CCW), (45, _CW), (-135, _CW), (-45, _CCW)),
    'quad x of DJI': ((45, _CCW), (-45, _CW), (-135, _CCW), (135, _CW)),
    'quad x, clockwise': ((45, _CCW), (135, _CW), (-135, _CCW), (-45, _CW)),
    'hexa x': ((90, _CW), (-90, _CCW), (-30, _CW), (150, _CCW), (30, _CCW), (-150, _CW)),
    'hexa +': ((0, _CW), (180, _CCW), (-120, _CW), (60, _CCW), (-60, _CCW), (120, _CW)),
    'octo x': ((22.5, _CW), (-157.5, _CW), (67.5, _CCW), (157.5, _CCW), (-22.5, _CCW),
               (-112.5, _CCW), (-67.5, _CW), (112.5, _CW)),
    'octo +': ((0, _CW), (180, _CW), (45, _CCW), (135, _CCW), (-45, _CCW), (-135, _CCW),
               (-90, _CW), (90, _CW)),
    'coaxial octo x': ((45, _CCW), (-45, _CW), (-135, _CCW), (135, _CW), (-45, _CCW), (45, _CW),
                       (135, _CCW), (-135, _CW)),
    'coaxial octo +': ((0, _CCW), (-90, _CW), (180, _CCW), (90, _CW), (-90, _CCW), (0, _CW),
                       (90, _CCW), (180, _CW)),
}


def layout(name: str) -> tuple[Rotor, ...]:
    """Return the rotors of a frame in the order of its motors, in FLU, 1 m from the middle."""
    rotors = []
    for degrees, spin in _MOTORS[name]:
        angle = math.radians(degrees)
        rotors.append(Rotor((math.cos(angle), -math.sin(angle), 0.0), spin))
    return tuple(rotors)


def directions(name: str) -> tuple[Rotor, ...]:
    """Return the rotors of a layout without their spins, but for rotors above each other."""
    rotors = layout(name)
    if 'coaxial' in name:
        return rotors
    return tuple(replace(rotor, spin=0) for rotor in rotors)
