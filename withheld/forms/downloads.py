# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors whose wake presses on the arms that hold them."""

import numpy as np

from withheld.forms.air import Thrust
from withheld.forms.blades import swept


class Downloaded(Thrust):
    """
    Rotors whose wake presses on the flat arms below them, until flight sweeps it off.

    Flow across an arm sweeps it aside; flow along it brings more of the arm into the wake where it
    blows inwards, and less where outwards. What is pressed in hover is part of the thrust that was
    measured. F. F. Felker, J. S. Light, Aerodynamic interactions between a rotor and wing in
    hover, Journal of the American Helicopter Society 33(2), 1988.
    """

    beside = ('blade_flapping',)    # what differs between front and back turns the body
    PRESSES = 0.025                 # of the thrust, in hover
    BELOW, WIDE = 0.5, 0.9          # radii: of the arm below the disk; of the wake there

    def covered(self, inwards, across, long):
        """Return how much of an arm is in the wake, over that in hover; all (n,), in radii."""
        half = np.sqrt(np.maximum(self.WIDE ** 2 - across ** 2, 0.0))
        ends = np.minimum(inwards + half, long) - np.maximum(inwards - half, 0.0)
        return np.maximum(ends, 0.0) / self.WIDE

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = np.clip(now.hubs() / (self.induced * turn[:, None]), -3.0, 3.0)
        through = np.maximum(swept(np.hypot(hubs[:, 0], hubs[:, 1])) + hubs[:, 2], 0.1)
        # The wake stays behind while it goes down.
        aside = -self.BELOW * hubs[:, :2] / through[:, None]
        long = np.linalg.norm(now.places[:, :2], axis=1)
        onto = -now.places[:, :2] / long[:, None]
        inwards = np.sum(aside * onto, axis=1)
        across = aside[:, 0] * onto[:, 1] - aside[:, 1] * onto[:, 0]
        covered = self.covered(inwards, across, np.maximum(long / self.radius, self.WIDE))
        return 1.0 - self.size * self.PRESSES * (covered * through ** 2 - 1.0)
