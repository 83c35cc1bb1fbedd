# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inflow: thrust by blade elements in the velocity that momentum theory gives."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import HZ, PER_HOVER, RADIUS, SPEED, UX, UY, UZ

AIR_DENSITY = 1.225     # kg/m^3, the standard atmosphere at sea level
STEPS = 4   # of Newton's method: from above, to 1e-4 of the velocity and better


@compiled(fused=True, inlined=True)
def induced_velocity(hover: float, along: float, across: float) -> float:
    """
    Return the induced velocity of a rotor, m/s, of Glauert's v sqrt(across^2 + (along + v)^2).

    hover: that at rest, whose square the product is; along, across: the rotor's own velocity
    against the air along its thrust and across it. Descending, this is the branch of hover, on
    which no vortex ring is known.
    """
    v = 0.5 * (math.sqrt(along * along + 4.0 * hover * hover) - along)
    for _ in range(STEPS):
        through = along + v
        whole = math.sqrt(across * across + through * through) + 1e-12
        v -= (v * whole - hover * hover) / (whole + v * through / whole)
        v = max(v, 0.0)
    return v


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Change the thrust of each rotor by the velocity through its disc, beside that at rest."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            along = rotors[j, UZ, i]
            more = along
            if s[RADIUS, i] > 0.0:  # else the disc is not known, and the rotor's own motion is all
                disc = 2.0 * AIR_DENSITY * math.pi * s[RADIUS, i] ** 2
                hover = math.sqrt(max(rotors[j, HZ, i], 0.0) / disc)
                across = math.sqrt(rotors[j, UX, i] ** 2 + rotors[j, UY, i] ** 2)
                more += induced_velocity(hover, along, across) - hover
            rotors[j, HZ, i] -= p[k, i] * rotors[j, SPEED, i] * s[PER_HOVER, i] * more


FORM = Form(
    name='momentum', title='by momentum theory',
    parameters=(Parameter('through', 'kg/s', 0.0, 10.0, 0.2, 'thrust of all rotors lost per '
                          'velocity through their discs, at hover speed', excited_by='vertical'),
                ),
    source='thrust - through (speed / sum of hover speeds) (vz + v - v at rest) at each rotor, '
           'v sqrt(vx^2 + vy^2 + (vz + v)^2) = v at rest^2 = thrust / (2 density pi R^2): blade '
           'elements and momentum, translational lift included; Glauert, ARC R&M 1111, 1926; '
           'Mahony, Kumar, Corke 2012',
    wrench=wrench, needs_reference=True)
