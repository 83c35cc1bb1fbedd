# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rods that hum in the flow."""

import numpy as np

from withheld.forms.air import Drag


class Humming(Drag):
    """
    A body with upright rods that hum: vortices shake them in a band of speeds, where they drag.

    There the vortices part as fast as the rods swing, and a rod that swings is as good as a
    broader one. Slower and faster they are still; it takes a while to begin and to end. J. K.
    Vandiver, Drag coefficients of long flexible cylinders, Offshore Technology Conference 4490,
    1983; R. D. Blevins, Flow-Induced Vibration, 1990, chapter 3. As aerials and masts for
    instruments do in practice. Only the flow across a rod counts.
    """

    OWN, RODS, MORE = 0.3, 0.8, 1.5     # of the coefficient: body, rods; of these, as they hum
    POWER = 0.65                        # of the amplitude, in the drag
    LOCKS, BAND = (1.2, 2.4), 0.25      # m/s, where they hum most; of that, the band
    TAKES = 0.4                         # s

    def __init__(self, size, params, rng):
        """Draw the speed."""
        super().__init__(size, params, rng)
        self.locks = rng.uniform(*self.LOCKS)

    def begin(self, rng):
        """Begin with rods that are still."""
        self._hums, self._flow = 0.0, 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        across = now.air * [1.0, 1.0, 0.0]
        self._flow = float(np.hypot(across[0], across[1]))
        rods = self.RODS * (1.0 + self.MORE * self._hums ** self.POWER)
        return self.OWN * np.linalg.norm(now.air) * now.air + rods * self._flow * across

    def after(self, step, rotation, acceleration):
        """Let them begin to hum, or end."""
        goal = np.exp(-((self._flow / self.locks - 1.0) / self.BAND) ** 2)
        self._hums += (1.0 - np.exp(-step / self.TAKES)) * (goal - self._hums)
