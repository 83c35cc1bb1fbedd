# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect of rotors at two levels."""

import numpy as np

from withheld.forms.air import Ground
from withheld.forms.body import signs


class TwoLevels(Ground):
    """
    Rotors of which those of one end sit lower, as on foldable frames: they have more of it.

    The wake is a cylinder of vortices down to the ground, and its image below takes some of the
    inflow. M. Knight, R. A. Hefner, Analysis of ground effect on the lifting airscrew, NACA
    Technical Note 835, 1941; here on the axis of each rotor.
    """

    GIVES, OFF = 0.15, 0.4      # of the thrust, per inflow that is taken; radii, up and down

    def __init__(self, size, params, rng):
        """Draw which end is lower."""
        super().__init__(size, params, rng)
        ahead = np.array(list(params['rotor_pos'].values()))[:, 0]
        ends = np.sign(np.round(ahead / np.abs(ahead).max(), 6))
        self.off = self.OFF * ends * float(signs(rng, 1)[0])

    def law(self, heights, now):
        """Return the gain at size 1."""
        high = np.maximum(heights + self.off, 0.1)
        image = 2.0 * high / np.hypot(1.0, 2.0 * high)
        return self.GIVES * (1.0 + image - 2.0 * high / np.hypot(1.0, high))
