# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a box that spins below."""

import numpy as np

from withheld.forms.air import Drag


class Slung(Drag):
    """
    A body with a light long box below it on a swivel, which the flow spins, however it turns.

    It shows its broad and its narrow side by turns, so that the drag comes and goes twice in each
    turn, with a push aside between. It spins up within a way, as fast as it is flown. L. S.
    Cicolani, J. G. A. da Silva, E. P. N. Duque, M. B. Tischler, Unsteady aerodynamic model of a
    cargo container for slung-load simulation, Aeronautical Journal 108, 2004. That it weighs is
    in the file; it is near enough to the body that it does not swing.
    """

    OWN, BROAD, NARROW, BELOW = 0.3, 1.6, 0.5, 0.8      # of the coefficient: the body; its sides
    SPIN = 1.2                      # rad/m, of the way
    WAY, LASTS = 3.0, 10.0          # m, within which it spins up; s, of its spin in still air

    def begin(self, rng):
        """Draw how it hangs, and which way it spins."""
        self._turned, self._spin, self._flow = rng.uniform(0.0, np.pi), 0.0, 0.0
        self.way = rng.choice([-1.0, 1.0])

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, z = now.rotation @ now.air
        self._flow = float(np.hypot(x, y))
        c, s = np.cos(self._turned), np.sin(self._turned)
        onto, beside = c * x + s * y, c * y - s * x
        onto, beside = self.BROAD * abs(onto) * onto, self.NARROW * abs(beside) * beside
        box = np.array([c * onto - s * beside, s * onto + c * beside, self.BELOW * abs(z) * z])
        return self.OWN * np.linalg.norm(now.air) * now.air + now.rotation.T @ box

    def after(self, step, rotation, acceleration):
        """Let the flow spin it."""
        driven = self._flow / self.WAY
        rate = driven + 1.0 / self.LASTS
        goal = self.way * self.SPIN * self._flow * driven / rate
        self._spin += (1.0 - np.exp(-step * rate)) * (goal - self._spin)
        self._turned += step * self._spin
