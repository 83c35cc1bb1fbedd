# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind that changes along a flight, whatever makes it change."""

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Effect, Form, Parameter, Table
from quad_ident_ros.model.situation import ALONG, WIND_X, WIND_Y

KNOTS = 8
"""
Of the wind along a flight, evenly spaced, between which it changes linearly.

In flights of 20 to 60 s they are 3 to 9 s apart. Near the ground horizontal gusts of Dryden's
spectrum (MIL-F-8785C) hang together over some 100 m, for 10 s and more at the speeds flown.
"""


@compiled(fused=True, inlined=True)
def gust(p: Table, k: int, s: Table, _: Table) -> None:
    """Add the wind at this time of the flight."""
    for i in range(s.shape[1]):
        along = min(max(s[ALONG, i], 0.0), 1.0) * (KNOTS - 1)
        knot = min(int(along), KNOTS - 2)
        share = along - knot
        s[WIND_X, i] += (1.0 - share) * p[k + knot, i] + share * p[k + knot + 1, i]
        s[WIND_Y, i] += ((1.0 - share) * p[k + KNOTS + knot, i]
                         + share * p[k + KNOTS + knot + 1, i])


FORM = Form(
    name='along_flight', title='wind that changes along a flight',
    parameters=tuple(Parameter(f'{axis}_{knot}', 'm/s', -20.0, 20.0, 1.0,
                               f'velocity of the air along world {axis}, beyond the steady wind, '
                               f'{knot} of {KNOTS - 1} parts into the flight')
                     for axis in 'xy' for knot in range(KNOTS)),
    source='air velocity = velocity - steady wind - gust, in everything that depends on it',
    on_rotors=False,
    gust=gust, needs_reference=True)
EFFECT = Effect(
    name='gusts', title='wind that changes along a flight', forms=(FORM,),
    excitation='any flight; it acts through drag, known or found')
