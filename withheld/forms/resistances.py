# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Batteries that have aged, and are near the most that they can give."""

import numpy as np

from withheld.actuators import Battery


class Faltering(Battery):
    """
    An old pack near the most power that it can give: the more it sags, the more it has to give.

    For controllers take a power, whatever the voltage: less of that is more current, which takes
    more of it again, up to half of it; the charge goes with the current. A. Emadi, A.
    Khaligh, C. H. Rivetta, G. A. Williamson, Constant power loads and negative impedance
    instability in automotive systems, IEEE Transactions on Vehicular Technology 55(4), 2006.
    """

    recorded = False
    RESISTS, FALLS = 0.12, 0.1      # of the voltage, by the current of hover: at once; in 30 s
    SHARE = 0.1                     # of the fall that is beyond what the controllers make up for

    def __init__(self, size, params, rng):
        """Start with what is left."""
        super().__init__(0.0, 1.8)
        self.size, self._open = size, 1.0
        self.parameters = {'resistance': self.RESISTS * self.SHARE * size}

    def voltage(self, load):
        """Return it for a power, over that in hover, or half of it where that is too much."""
        rest = max(self._open ** 2 - 4.0 * self.RESISTS * load, 0.0)
        return 0.5 * (self._open + np.sqrt(rest))

    def drain(self, time, step, speeds):
        """Go on: it has a current of its voltage over the resistance at most."""
        voltage = float(self.voltage(float(np.mean(speeds ** 3))))
        current = (self._open - voltage) / self.RESISTS
        self._open = max(self._open - step / 30.0 * self.FALLS * current, 0.5)
        self.ratio = 1.0 - self.size * self.SHARE * (1.0 - voltage)
