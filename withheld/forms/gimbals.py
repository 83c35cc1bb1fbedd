# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A centre of mass that goes with a camera, which is held level."""

import numpy as np

from withheld.forms.body import Centre, signs


class Gimballed(Centre):
    """
    A heavy camera that its gimbal holds level, and whose own centre is not where its axes meet.

    It is below them, or above as where bridges are looked at: as the body leans, the camera goes
    aside in it, up to the end of its travel. Cameras have to be balanced on their gimbals because
    of that: J. M. Hilkert, Inertially stabilized platform technology, IEEE Control Systems
    Magazine 28(1), 2008.
    """

    SWINGS, LEAN = 0.7, 0.3     # of the mean's distance, at a lean of this sine
    MOST = 0.6                  # the sine of the lean at the end of its travel

    def __init__(self, size, params, rng):
        """Draw whether it is below or above."""
        super().__init__(size, params, rng)
        self.below = float(signs(rng, 1)[0])

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        down = -now.rotation[2, :2]     # of what is down in the world, along the body's x and y
        down = down * min(1.0, self.MOST / max(float(np.linalg.norm(down)), 1e-9))
        far = self.SWINGS * float(np.linalg.norm(self.centre[:2])) / self.LEAN
        x, y = self.below * far * down
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])
