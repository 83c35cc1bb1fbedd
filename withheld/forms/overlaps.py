# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors that overlap, and rotors whose motors speed up where their load falls."""

import numpy as np

from withheld.forms.air import Thrust


class Overlapping(Thrust):
    """
    Rotors that overlap: those of one spin sit lower, in the wake of the others, until that leaves.

    Level flight sweeps it off, and more so on the side from which the air comes: what is ahead is
    in clean air. Rotors that overlap: W. Z. Stepniewski, C. N. Keys, Rotary-Wing Aerodynamics,
    1984. In the wake a climb costs less.
    """

    beside = ('blade_flapping',)
    SWEPT, AHEAD, LESS = 0.4, 0.6, 0.4      # of the induced velocity; shares: by side, of a climb

    def __init__(self, size, params, rng):
        """Take which ones sit lower."""
        super().__init__(size, params, rng)
        self.lower = np.asarray(params['rotor_directions']) < 0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        across = np.hypot(hubs[:, 0], hubs[:, 1])
        away = np.linalg.norm(now.places[:, :2], axis=1)
        ahead = np.sum(now.places[:, :2] * hubs[:, :2], axis=1) / np.maximum(
            away * across, 1e-9)
        stays = np.exp(-(across / self.SWEPT) ** 2)
        lower = self.lower * (1.0 - stays) * (1.0 + self.AHEAD * ahead)
        climb = np.clip(hubs[:, 2], -3.0, 3.0) * (1.0 - self.LESS * self.lower * stays)
        return 1.0 + self.size * (0.02 * lower - 0.03 * climb)


class Unloaded(Thrust):
    """
    Rotors without a control of their speed, which speed up where the flow takes load off them.

    So a climb takes thrust at once, and most of it comes back as the motor speeds up; level
    flight adds some. Torque over the flow: R. Gill, R. D'Andrea, Computationally efficient force
    and moment models for propellers in UAV forward flight applications, Drones 3(4), 2019.
    """

    TIME, LEVEL = 0.3, 0.4          # s; what level flight unloads, of what a climb does

    def begin(self, rng):
        """Start in hover."""
        self._slow, self._now = 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        climb = np.clip(z, -3.0, 3.0)
        self._now = climb + self.LEVEL * np.minimum(x * x + y * y, 4.0)
        return 1.0 + self.size * (0.035 * self._slow - 0.05 * climb)

    def after(self, step, rotation, acceleration):
        """Let the motors follow."""
        self._slow = self._slow + (1.0 - np.exp(-step / self.TIME)) * (self._now - self._slow)
