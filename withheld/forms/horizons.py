# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A horizon that vibration tilts."""

import numpy as np

from withheld.forms.body import Tilt


class Shaken(Tilt):
    """
    An autopilot whose accelerometer takes vibration for acceleration, so that the horizon leans.

    It rectifies a share of the square of the vibration, which goes with the square of the rotors'
    speed, as any unbalance does; the filter of the attitude follows in a second or two. So the
    horizon leans the more, the more thrust there has been. A. Albarbar, A. Badri, J. K. Sinha, A.
    Starr, Performance evaluation of MEMS accelerometers, Measurement 42(5), 2009. The heading
    does not come from the accelerometer.
    """

    OWN, MOST = 0.3, 3.0        # of the tilt: without vibration; of that in hover
    TIME = 1.5                  # s, of the filter

    def __init__(self, size, params, rng):
        """Leave the heading alone."""
        super().__init__(size, params, rng)
        self.angles[2] = self.parameters['yaw'] = 0.0

    def begin(self, rng):
        """Start as in hover."""
        self._shakes, self._last = 1.0, None

    def measured(self, time, state, thrust):
        """Return what is said."""
        step = 0.0 if self._last is None else time - self._last
        goal, self._last = float(np.clip(thrust * thrust, 0.0, self.MOST)), time
        self._shakes = goal + np.exp(-step / self.TIME) * (self._shakes - goal)
        return self.tilted(state, self.OWN + (1.0 - self.OWN) * self._shakes)[0]
