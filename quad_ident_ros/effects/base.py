# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What an effect is: a name, parameters, and what it changes in the vehicle model."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Parameter:
    """
    A number of an effect: its unit, the value at which there is no effect, bounds, usual size.

    Bounds and size (what the parameter is usually about) are in units of the vehicle's own scale
    where the unit has mass or length in it, so that they hold for 30 g and for 3 kg: see scale.
    """

    name: str
    unit: str
    lower: float
    upper: float
    size: float
    description: str
    null: float = 0.0

    def scale(self, vehicle):
        """Return the vehicle's own measure of this parameter's unit: its mass, arm or inertia."""
        mass, arm = vehicle.mass, vehicle.arm_length
        weight = mass * vehicle.gravity
        return {'kg': mass, 'kg/s': mass, 'kg/m': mass, 'kg m/s': mass * arm, 'm': arm,
                'kg m^2': vehicle.inertia[0],
                'N': weight, 'N m': weight * arm}.get(self.unit, 1.0)


@dataclass(frozen=True)
class Effect:
    """
    Something that reality has and the nominal model lacks.

    parameters: of Parameter; source: where the formula stands; excitation: what a flight must do
    to show it; confused_with: names of effects that look alike. What it changes, each a function
    or None (rows of the tables: model.situation; p (P, LANES) has its parameters from row k on):
    body(p, k, s): mass, inertia, centre of mass, before the flight; air(p, k, s): the wind;
    thrust(p, k, s, rotors): factors on the rotors' thrust; wrench(p, k, s, rotors): forces of
    the rotors, forces and moments on the body. actuator: 'delay' or 'lag', where its parameter is
    one of the actuators; ratio: the quotient that alone shows in motion, of two effects with one
    of it only one is named; sensor: 'attitude' or 'rate', where its parameters are those of a sensor;
    per_rotor: each parameter belongs to one rotor, and one at a time is off.
    """

    name: str
    title: str
    parameters: tuple
    source: str
    excitation: str
    confused_with: tuple = ()
    body: object = field(default=None, repr=False)
    air: object = field(default=None, repr=False)
    thrust: object = field(default=None, repr=False)
    wrench: object = field(default=None, repr=False)
    actuator: str | None = None
    sensor: str | None = None
    per_rotor: bool = False
    ratio: str | None = None
