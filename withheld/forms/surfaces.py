# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground that gives and takes by the height, and ground that answers the way up and down."""

import numpy as np

from withheld.forms.air import Ground


class Dipping(Ground):
    """
    A gain close to the ground, and a loss above, where rotors take in what the ground sends up.

    Between rotors the wakes meet and rise: D. A. Griffiths, J. G. Leishman, A study of dual-rotor
    interference and ground effect using a free-vortex wake model, American Helicopter Society
    58th Annual Forum, 2002.
    """

    WHERE, WIDE = 3.5, 1.2      # radii

    def law(self, heights, now):
        """Return the gain at size 1."""
        loss = np.exp(-((heights - self.WHERE) / self.WIDE) ** 2)
        return 0.25 * np.exp(-0.9 * heights) - 0.03 * loss


class Squeezed(Ground):
    """
    Air that a descent presses out from under the rotors, so that it holds more, and a climb less.

    The squeeze film of bearings: B. J. Hamrock, Fundamentals of Fluid Film Lubrication, 1994.
    """

    PRESSES = 4.0       # change with the speed of the climb over the induced velocity

    def law(self, heights, now):
        """Return the gain at size 1."""
        climb = float(np.clip(self.PRESSES * now.velocity[2] / self.induced, -1.5, 1.0))
        return 0.12 * np.exp(-0.7 * heights) * (1.0 - climb)
