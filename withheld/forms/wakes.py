# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors in their own wakes: stall and vortex ring, fountains over ground and half of it."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Ground, Thrust


class Stalling(Thrust):
    """
    Blades whose lift goes with the axial velocity until they stall, and then falls off again.

    Blade elements with a table of the profile, at Reynolds numbers of small propellers (J. G.
    Leishman, Principles of Helicopter Aerodynamics, 2006, section 7.9 on static stall).
    """

    STALL = 0.2         # of the induced velocity, downwards

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        sinking = -hubs[:, 2] / self.STALL
        lift = sinking / (1.0 + np.maximum(sinking, 0.0) ** 3)
        across = hubs[:, 0] ** 2 + hubs[:, 1] ** 2
        return 1.0 + self.size * (0.006 * lift + 0.01 * across / (1.0 + across))


class Settling(Thrust):
    """
    Rotors that sink into their own wake: a ring of vortices builds up and takes thrust.

    Forward flight leaves it behind. Loss and onset: W. Johnson, Model for vortex ring state
    influence on rotorcraft flight dynamics, NASA TP-2005-213477.
    """

    TIME = 0.25         # s, in which a ring builds up

    def begin(self, rng):
        """Start without a ring."""
        self._ring, self._towards = 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        x, y, z = now.air / self.induced
        self._towards = 1.6 * max(-z, 0.0) ** 1.5 * np.exp(-x * x - y * y)
        return 1.0 - 0.025 * self.size * (np.clip(hubs[:, 2], -3.0, 3.0) + min(self._ring, 3.0))

    def after(self, step, rotation, acceleration):
        """Let the ring follow."""
        self._ring += (1.0 - np.exp(-step / self.TIME)) * (self._towards - self._ring)


class Fountain(Ground):
    """
    Four images in the ground, and the fountain between the rotors that lifts the body.

    With the coefficient 2 of the body's lift: P. Sanchez-Cuevas, G. Heredia, A. Ollero,
    Characterization of the aerodynamic ground effect and its influence in multirotor control,
    International Journal of Aerospace Engineering 2017, 1823056.
    """

    LIFT = 2.0

    def __init__(self, size, params, rng):
        """Take how far the rotors are apart, over their radius."""
        super().__init__(size, params, rng)
        self.opposite = 2.0 * arm_length(params) / self.radius
        self.adjacent = self.opposite / np.sqrt(2.0)

    def law(self, heights, now):
        """Return the gain at size 1."""
        z, b, d = float(np.mean(heights)), self.opposite, self.adjacent
        images = (1.0 / (16.0 * z * z) + z / (d * d + 4.0 * z * z) ** 1.5
                  + 0.5 * z / (2.0 * d * d + 4.0 * z * z) ** 1.5
                  + 2.0 * self.LIFT * z / (b * b + 4.0 * z * z) ** 1.5)
        return 0.2 * (1.0 / (1.0 - min(images, 0.6)) - 1.0)


class Platform(Ground):
    """
    Ground under some of the rotors: a platform on one side of an edge, and nothing beyond.

    Partial ground effect of multirotors, each rotor with its own: Sanchez-Cuevas and others, as
    above. It fades exponentially with the height.
    """

    def __init__(self, size, params, rng):
        """Draw where the edge is."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.edge = rng.uniform(-0.3, 0.3)

    def law(self, heights, now):
        """Return the gain at size 1."""
        inside = (now.position + now.places @ now.rotation.T) @ self.onto - self.edge
        over = 0.5 * (1.0 + np.tanh(inside / self.radius))
        return 0.15 * over * np.exp(-heights)
