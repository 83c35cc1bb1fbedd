# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors above vanes that take the swirl out, and rotors that lean along their turn."""

import numpy as np

from withheld.forms.air import Thrust


class Vaned(Thrust):
    """
    Rotors above vanes, which turn the swirl into thrust as long as it meets them as in hover.

    A climb or a descent changes its angle, and they stall. Y. Wang, Q. Li, G. Eitelberg, L. L. M.
    Veldhuis, M. Kotsonis, Design and numerical investigation of swirl recovery vanes for the
    Fokker 29 propeller, Chinese Journal of Aeronautics 27(5), 2014.
    """

    ADDS, WIDE = 0.03, 0.12         # of the thrust, in hover; of the induced velocity
    TAKES, LEVEL = 0.02, 0.006      # of the thrust, in hover: for a climb, for fast level flight

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        square, off = x * x + y * y, (z / self.WIDE) ** 2
        return 1.0 + self.size * (self.LEVEL * square / (1.0 + square) - self.TAKES * np.clip(
            z, -3.0, 3.0) - self.ADDS * off / (1.0 + off))


class Canted(Thrust):
    """
    Rotors that lean along their turn, so that they can turn the body by their thrust as well.

    Flow from a side then climbs through some and sinks through others. G. Jiang, R. Voyles,
    Hexrotor UAV platform enabling dextrous interaction with structures - flight test, IEEE
    International Symposium on Safety, Security, and Rescue Robotics 2013.
    """

    beside = ('blade_flapping',)
    LEAN = 0.2                      # rad
    TAKES, LEVEL = 0.03, 0.006      # of the thrust, in hover: for a climb, for level flight

    def __init__(self, size, params, rng):
        """Take which way they turn."""
        super().__init__(size, params, rng)
        self.spins = np.asarray(params['rotor_directions'])

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        out = now.places * [1.0, 1.0, 0.0]
        onto = np.cross([0.0, 0.0, 1.0], out) / np.linalg.norm(out, axis=1, keepdims=True)
        along = hubs[:, 2] + self.LEAN * self.spins * np.sum(onto * hubs, axis=1)
        across = np.minimum(hubs[:, 0] ** 2 + hubs[:, 1] ** 2, 4.0)
        return 1.0 + self.size * (self.LEVEL * across - self.TAKES * np.clip(along, -3.0, 3.0))
