# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Angular momentum of rotors whose two spins are not alike, so that some stays in hover."""

from collections.abc import Mapping

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Form, Parameter, Table
from quad_ident_ros.model.situation import MX, MY, SPEED, SPIN, WX, WY

NAMES = {1: 'heavier_clockwise', -1: 'heavier_counterclockwise'}
"""Parameters by the spin of the rotors that they make heavier."""


@compiled(fused=True, inlined=True)
def inertia_of(own: float, other: float) -> float:
    """
    Return the inertia of a rotor about its axis, by the parameters of its spin and of the other.

    Neither of the two spins has more than one and a half times the inertia of the other, as rotors
    of two makes may: those of one spin alone would be a wheel on board.
    """
    return 1.2 * own + 0.8 * other


@compiled(fused=True, inlined=True)
def wrench(p: Table, k: int, s: Table, rotors: Table) -> None:
    """Add the moment of turning the rotors' axes; rigid_body adds that of speeding them up."""
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            # A rotor turns against the reaction torque that its spin names.
            inertia = (inertia_of(p[k, i], p[k + 1, i]) if rotors[j, SPIN, i] > 0.0 else
                       inertia_of(p[k + 1, i], p[k, i]))
            momentum = inertia * rotors[j, SPIN, i] * rotors[j, SPEED, i]
            s[MX, i] += momentum * s[WY, i]
            s[MY, i] -= momentum * s[WX, i]


def inertias(values: Mapping[str, float]) -> dict[int, float]:
    """Return {spin: inertia of a rotor about its axis, kg m^2} of {parameter: value}."""
    return {spin: float(inertia_of(values.get(NAMES[spin], 0.0), values.get(NAMES[-spin], 0.0)))
            for spin in NAMES}


def values_of(by_spin: Mapping[int, float]) -> dict[str, float] | None:
    """Return {parameter: value} of {spin: inertia}; None where one is over 1.5 times the other."""
    values = {NAMES[spin]: 1.5 * by_spin[spin] - by_spin[-spin] for spin in NAMES}
    return values if min(values.values()) >= 0.0 else None


FORM = Form(
    name='momentum_by_spin', title='angular momentum, of rotors that are not alike',
    parameters=(Parameter('heavier_clockwise', 'kg m^2', 0.0, 0.5, 0.001, 'of one rotor about its '
                          'axis, the part of which those that turn clockwise as seen from above '
                          '(spin 1) have one and a half times as much as the others'),
                Parameter('heavier_counterclockwise', 'kg m^2', 0.0, 0.5, 0.001, 'the same for '
                          'those that turn the other way (spin -1)')),
    source='moment -w x h - dh/dt with h = -sum(spin J speed) along body z, J of spin 1 '
           '1.2 heavier_clockwise + 0.8 heavier_counterclockwise, of spin -1 the other way '
           'round, so that their mean is the sum of both: rotors, or what turns with them, of two '
           'makes; eqs. (10), (11) of the paper with the sign of the errata',
    like_feedback=True,
    same_motion=(('inertia of the rotors of one spin',
                  'another body that spins on board, such as a wheel or a scanner'),),
    separated_by='a flight with that body at rest, or a rotor of each kind swung as a pendulum',
    wrench=wrench)
