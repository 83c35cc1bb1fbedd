# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of rotors with heavy, stiff blades."""

import numpy as np

from withheld.forms.hubs import HubMoment


class Circling(HubMoment):
    """
    Rotors with stiff and heavy blades, whose disks come to lean in circles, against their spin.

    Their blades swing a little faster than once in a turn, and air damps heavy blades little, so
    that a disk goes around where it will lean, slowly as seen from the body. To the side, rotors
    of either spin cancel. The regressing mode of flapping: W. Johnson, Helicopter Theory, 1980,
    chapter 12.
    """

    AROUND, TIME = 2.0 * np.pi * 2.2, 0.12      # rad/s; s, in which it fades; at hover's speed

    def __init__(self, size, params, rng):
        """Take the spins."""
        super().__init__(size, params, rng)
        self.spins = np.asarray(params['rotor_directions'], dtype=float)

    def begin(self, rng):
        """Start with disks that have settled."""
        self._disks = None

    def wrench(self, now):
        """Return the moment of all rotors."""
        self._turn, hubs = np.maximum(now.speeds / self.hover, 0.2), now.hubs()
        # Leaning back, and across by what the spin decides: a complex number.
        self._settled = (hubs[:, 0] + 1j * hubs[:, 1]) * (
            1.0 + 1j * self.spins * self.AROUND * self.TIME)
        if self._disks is None:
            self._disks = self._settled
        lean = self.moment / len(self._turn) * (self._turn @ self._disks)
        return np.zeros(3), np.array([-lean.imag, lean.real, 0.0])

    def after(self, step, rotation, acceleration):
        """Let the disks circle on."""
        rates = self._turn * (1j * self.spins * self.AROUND - 1.0 / self.TIME)
        self._disks = self._settled + np.exp(step * rates) * (self._disks - self._settled)
