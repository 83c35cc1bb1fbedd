# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors behind nets, and rotors that move one column of air."""

import numpy as np

from withheld.forms.air import Thrust
from withheld.forms.blades import swept


class Screened(Thrust):
    """
    Rotors behind nets that keep fingers out: these take pressure with the square of the flow.

    So a climb costs the more, the faster it is, and level flight, in which less is sucked in, adds
    some. Screens: I. E. Idelchik, Handbook of Hydraulic Resistance, 1986, chapter 8.
    """

    TAKES = 0.03        # of the thrust, in hover

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        flow = np.clip(swept(np.hypot(x, y)) + z, -3.0, 3.0)
        return 1.0 + self.TAKES * self.size * (1.0 - flow * np.abs(flow))


class Columned(Thrust):
    """
    Rotors close to each other, which move one column of air: it follows what they do together.

    So what a climb takes comes back after a while, as the column follows, and what a roll does
    not; level flight leaves the column behind. States of the flow above: D. A. Peters, C. J. He,
    Finite state induced flow models, part II, Journal of Aircraft 32(2), 1995.
    """

    TAKES, COMES, LEVEL = 0.05, 0.7, 0.02   # of the thrust; of it, in hover; of the thrust
    TIME = 0.5          # s

    def begin(self, rng):
        """Start in hover."""
        self._slow, self._now = 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        climb, square = np.clip(z, -3.0, 3.0), np.minimum(x * x + y * y, 9.0)
        self._now = float(np.mean(climb))
        stays = 1.0 / (1.0 + 2.0 * float(np.mean(square)))
        return 1.0 + self.size * (self.LEVEL * square / (1.0 + square) - self.TAKES * (
            climb - self.COMES * stays * self._slow))

    def after(self, step, rotation, acceleration):
        """Let the column follow."""
        self._slow += (1.0 - np.exp(-step / self.TIME)) * (self._now - self._slow)
