# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Cameras on stabilisers that follow the heading."""

import numpy as np

from withheld.forms.body import Coupled


class Stabilised(Coupled):
    """
    A camera below on a stabiliser, which follows the heading of the body smoothly.

    Small turns of the heading leave the camera where it looks; beyond a dead band it comes along,
    as fast as it is behind. The arms of the stabiliser turn with the body, and so does the camera
    for what it hangs below about the other axes. J. M. Hilkert, Inertially stabilized platform
    technology, IEEE Control Systems Magazine 28(1), 2008; the follow mode is that of the manuals
    of such stabilisers.
    """

    ARMS, TIME = 0.4, 0.02          # of the inertia about z; s, in which they are taken along
    DEAD, FOLLOWS = 0.06, 5.0       # rad; 1/s
    MOTOR = 0.04                    # s, in which its motor has the speed that is asked for
    FINE = 0.005                    # s, the steps

    def begin(self, rng):
        """Start at rest, looking ahead."""
        self._turning, self._rate = np.zeros(3), np.zeros(3)
        self._behind, self._looks = 0.0, 0.0

    def wrench(self, now):
        """Return the moment of the arms and of the motor of the heading."""
        self._rate = now.rate
        moment = self.loads * (self._turning - now.rate) / self.TIME
        moment[2] = self.ARMS * moment[2] - (1.0 - self.ARMS) * self.loads[2] * self._turns()
        return np.zeros(3), moment

    def after(self, step, rotation, acceleration):
        """Take the arms along, and let the camera follow."""
        self._turning = self._rate + np.exp(-step / self.TIME) * (self._turning - self._rate)
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._looks += step / count * self._turns()
            self._behind += step / count * (float(self._rate[2]) - self._looks)

    def _turns(self):
        """Return the slope of the rate about z of the camera, rad/s^2."""
        beyond = self._behind - float(np.clip(self._behind, -self.DEAD, self.DEAD))
        return (self.FOLLOWS * beyond - self._looks) / self.MOTOR
