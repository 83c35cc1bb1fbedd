# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors in air that they have stirred, and in descents that shake them."""

import numpy as np

from withheld.forms.air import Thrust


class Stirred(Thrust):
    """
    Rotors in a room, whose air they set in motion where they stay: what they leave it for is calm.

    So the thrust grows on the way and falls again where the vehicle lingers. Recirculation in
    closed rooms: D. Weitsman, J. H. Stephenson, N. S. Zawodny, Journal of the Acoustical Society
    of America 148(3), 2020. Climbing costs thrust evenly.
    """

    TIME, REACH = 1.5, 0.8          # s, in which air is stirred; m, in which it is left

    def begin(self, rng):
        """Start after a hover."""
        self._stirred, self._speed = 1.0, 0.0

    def gain(self, now):
        """Return the factors."""
        self._speed = float(np.linalg.norm(now.air))
        turn = np.maximum(now.speeds / self.hover, 0.2)
        climb = np.clip(now.hubs()[:, 2] / (self.induced * turn), -3.0, 3.0)
        return 1.0 + self.size * (0.03 * (1.0 - self._stirred) - 0.02 * climb)

    def after(self, step, rotation, acceleration):
        """Stir or leave it."""
        stirs, leaves = 1.0 / self.TIME, self._speed / self.REACH
        rate = stirs + leaves
        self._stirred += (1.0 - np.exp(-rate * step)) * (stirs / rate - self._stirred)


class Buffeted(Thrust):
    """
    Rotors that a descent shakes: what they sent down comes up in clouds, each rotor by itself.

    The thrust of rotors that sink fluctuates, slowly and by much: M. D. Betzina, Tiltrotor
    descent aerodynamics: a small-scale experimental investigation of vortex ring state, American
    Helicopter Society 57th Annual Forum, 2001. Climbs cost thrust and level flight adds some.
    """

    SHAKES, SINKS = 0.004, 0.15     # of the thrust; of the induced velocity, where it is most
    WAVES = 5

    def begin(self, rng):
        """Draw the frequencies, rad/s, and the phases of eight rotors at most."""
        self.rates = 2.0 * np.pi * rng.uniform(0.6, 2.5, (8, self.WAVES))
        self.phases = rng.uniform(0.0, 2.0 * np.pi, (8, self.WAVES))

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        waves = np.sqrt(2.0 / self.WAVES) * np.sum(
            np.sin(self.rates * now.time + self.phases), axis=1)[:len(turn)]
        sinks = np.maximum(-z, 0.0) / self.SINKS
        across = np.minimum(x * x + y * y, 4.0)
        shakes = self.SHAKES * sinks * np.exp(1.0 - sinks - across) * waves
        return 1.0 + self.size * (shakes + 0.006 * across - 0.03 * np.clip(z, -3.0, 3.0))
