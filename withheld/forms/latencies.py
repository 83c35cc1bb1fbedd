# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands over a wireless network."""

import numpy as np

from withheld.forms.motors import Jitter


class LongTailed(Jitter):
    """
    Commands from a computer on the ground over Wi-Fi: mostly soon, and some very late.

    Each is as late as chance has it, by a logarithm that is normal on top of the least; what a
    later one overtakes is lost, as where nobody asks for what is missing (best effort in ROS 2).
    C. Pei and others, WiFi can be the weakest link of round trip network latency in the wild,
    INFOCOM 2016.
    """

    LEAST, SPREAD = 0.45, 0.9       # of the mean delay; of the logarithm of the rest

    def waits(self, time):
        """Return the delay of one command."""
        late = np.exp(self.SPREAD * self._rng.normal() - 0.5 * self.SPREAD ** 2)
        return self.delay * (self.LEAST + (1.0 - self.LEAST) * late)
