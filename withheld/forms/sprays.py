# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect over water from which the wake takes spray."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.air import Ground


class Sprayed(Ground):
    """
    Water from which strong rotors that are near tear spray: it comes up and weighs on the blades.

    A jet only dents the water until it is strong enough, and tears drops off from there on: F. R.
    Cheslak, J. A. Nicholls, M. Sichel, Cavities formed on liquid surfaces by impinging gaseous
    jets, Journal of Fluid Mechanics 36(1), 1969. It takes its time, and flight leaves it behind.
    """

    GAIN, FADES = 0.15, 0.6         # of the thrust; per radius
    JET, TEARS = 0.45, 0.25         # per radius; of the jet's pressure in hover, close above
    TAKES, TIME = 0.25, 0.5         # of the thrust, for all of that pressure; s
    BEHIND = 0.6                    # of the induced velocity: half of it is left behind

    def __init__(self, size, params, rng):
        """Take what speeds are measured by."""
        super().__init__(size, params, rng)
        self.hover, self.count = hover_speed(params), params['num_rotors']

    def begin(self, rng):
        """Start without spray."""
        self._spray, self._goal = np.zeros(self.count), np.zeros(self.count)

    def law(self, heights, now):
        """Return the gain at size 1."""
        presses = np.minimum(now.speeds / self.hover, 2.0) ** 2 * np.exp(-self.JET * heights)
        square = (now.air[0] ** 2 + now.air[1] ** 2) / (self.BEHIND * self.induced) ** 2
        self._goal = np.maximum(presses - self.TEARS, 0.0) / (1.0 + square)
        return self.GAIN * np.exp(-self.FADES * heights) - self.TAKES * self._spray

    def after(self, step, rotation, acceleration):
        """Let it come up and fall."""
        self._spray = self._spray + (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._spray)
