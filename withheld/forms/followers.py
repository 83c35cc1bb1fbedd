# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cameras whose stabilisers follow the body about all axes."""

import numpy as np

from withheld.forms.body import HeldBehind


class FollowsAll(HeldBehind):
    """
    A heavy camera for the pilot on a stabiliser that follows the body about all three axes.

    Its motors pull it to where the body looks, as springs do, and hold against how fast it turns
    itself by its own gyroscope, not against how fast it turns in its frame: so a long turn takes
    it along, a short one does not, and it hardly swings. A damper to the sky: D. Karnopp, M. J.
    Crosby, R. A. Harwood, Vibration control using semi-active force generators, Journal of
    Engineering for Industry 96(2), 1974; the mode is that of the manuals of such stabilisers.
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 2.0, 0.6     # rad/s; of the critical one

    def turns(self):
        """Return the slope (3,) of the camera's rate, rad/s^2."""
        return self.FREQUENCY * (
            self.FREQUENCY * self._behind - 2.0 * self.DAMPING * self._turning)
