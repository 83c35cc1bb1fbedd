# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Stabilisers of cameras that are switched off."""

import numpy as np

from withheld.forms.body import HeldBehind


class SwitchedOff(HeldBehind):
    """
    A camera on a stabiliser without power, held by the magnets of its motors and a flat cable.

    The magnets hold it in one of many notches, like a spring that gives way beyond a moment, so
    that a hard turn takes it a few notches on. The cogging of motors with permanent magnets: J. R.
    Hendershot, T. J. E. Miller, Design of Brushless Permanent-Magnet Machines, 2010. As flown to
    save the battery, or where the stabiliser has failed.
    """

    NOTCHES = 84                            # around: of twelve slots and fourteen poles
    FREQUENCY, DAMPING = 2.0 * np.pi * 2.5, 0.1     # rad/s, in a notch; of the critical one
    CABLE = 2.0 * np.pi * 0.6               # rad/s, without the notches
    FINE = 0.0025       # s, the steps

    def turns(self):
        """Return the slope (3,) of the camera's rate, rad/s^2."""
        notch = self.FREQUENCY ** 2 / self.NOTCHES * np.sin(self.NOTCHES * self._behind)
        damper = 2.0 * self.DAMPING * self.FREQUENCY * (self._rate - self._turning)
        return notch + damper + self.CABLE ** 2 * self._behind
