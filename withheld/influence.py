# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What acts on a vehicle beside rotorpy's model: strangers, forms of effects, logging."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Instant:
    """
    A moment of a flight.

    time s; position, velocity (3,) of the centre of mass in the world; rotation (3, 3) from body
    to world; rate (3,) rad/s and air (3,) m/s velocity relative to the air, in the body; speeds
    (n,) rad/s and heights (n,) m over ground of the rotors; places (n, 3) m of the rotors from
    the centre of mass.
    """

    time: float
    position: np.ndarray
    velocity: np.ndarray
    rotation: np.ndarray
    rate: np.ndarray
    air: np.ndarray
    speeds: np.ndarray
    heights: np.ndarray
    places: np.ndarray

    def hubs(self):
        """Return the velocities (n, 3) of the rotors relative to the air, in the body."""
        return self.air + np.cross(self.rate, self.places)


class Part:
    """
    Something that a reality is made of, where it is not as the vehicle file says.

    parameters: {name: value}, for the label; comparable: whether they mean what the effect's
    parameters of the same names mean in the library; beside: effects that are present with it, so
    that a verdict may name them.
    """

    parameters = {}
    comparable = False
    beside = ()

    def begin(self, rng):
        """Draw what is a flight's own."""

    def bodies(self):
        """Return the options of bodies.Bodies that it asks for: none where it needs no MuJoCo."""
        return {}


class Influence(Part):
    """Something that acts on a vehicle; each kind overrides what it changes."""

    def alter(self, true, params):
        """Change the parameters `true` of the reality; params are those of the nominal vehicle."""

    def mass(self, time):
        """Return the mass, kg, at a time on top of that of the reality."""
        return 0.0

    def given(self, command):
        """Return what the actuators are given, (n,) rad/s, of a command."""
        return command

    def gain(self, now):
        """Return the factors (n,) on the thrust of the rotors at an Instant."""
        return 1.0

    def torque(self, now):
        """Return the factors (n,) on the reaction torque of the rotors at an Instant."""
        return 1.0

    def wrench(self, now):
        """Return the force (3,) N and the moment (3,) N m in the body at an Instant, or None."""
        return None

    def wind(self, time, position):
        """Return the velocity (3,) m/s of the air in the world."""
        return 0.0

    def measured(self, time, state, thrust):
        """
        Return what sensors without noise say, (13,), of the declared state (13,).

        thrust is that of all rotors by command, over the weight.
        """
        return state

    def after(self, step, rotation, acceleration):
        """Take notice of the acceleration (3,) m/s^2 (world) during a step of s."""
