# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Power that comes of hydrogen or of petrol."""

import numpy as np

from withheld.actuators import Battery


class FuelCell(Battery):
    """
    A stack of fuel cells, which are flooded by the water that they make, until they are purged.

    The voltage falls with the logarithm of the load and with the load. J. Larminie, A. Dicks, Fuel
    Cell Systems Explained, 2003.
    """

    recorded = False
    LOGARITHM, RESISTS, FLOODS = 0.002, 0.002, 0.007    # of the voltage
    PURGED, SMOOTH = 6.0, 0.15      # s in hover, from purge to purge; s, that one takes

    def __init__(self, size, params, rng):
        """Set what water takes."""
        super().__init__(0.0, 1.8)
        self.size = size
        self.parameters = {'flooded': self.FLOODS * size, 'resistance': self.RESISTS * size}

    def begin(self, rng):
        """Draw how much water there is."""
        self._made = rng.uniform(0.0, 1.0)
        self._water = self._made

    def drain(self, time, step, speeds):
        """Go on."""
        load = max(float(np.mean(speeds ** 3)), 0.05)
        self._made = (self._made + load * step / self.PURGED) % 1.0
        gone = 1.0 - np.exp(-step / self.SMOOTH)
        self._water += gone * (self._made - self._water)
        self.ratio = 1.0 - self.size * (
            self.LOGARITHM * np.log1p(4.0 * load) + self.RESISTS * load
            + self.FLOODS * self._water)


class Generator(Battery):
    """
    A petrol engine with a generator, whose governor answers a load late, and swings about it.

    So a load takes more at first than in the end. A governor with a droop, by J. C. Maxwell, On
    governors, Proceedings of the Royal Society of London 16, 1868; it warms, and gives less then.
    """

    recorded = False
    INERTIA, THROTTLE = 0.5, 0.9        # s, each
    DROOP, WARMS = 0.012, 0.012         # of the voltage: in hover; in 30 s

    def __init__(self, size, params, rng):
        """Start without a load."""
        super().__init__(0.0, 1.8)
        self.size, self._slow, self._throttle = size, 0.0, 0.0
        self.parameters = {'droop': self.DROOP * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._slow += step / self.INERTIA * (load - self._throttle)
        self._throttle += step / self.THROTTLE * (self._slow - self._throttle)
        self.ratio = 1.0 - self.size * (
            self.DROOP * self._slow + self.WARMS * time / 30.0)
