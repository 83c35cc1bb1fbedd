# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Engines whose throttle has play in its linkage."""

import numpy as np

from withheld.actuators import Battery


class Surging(Battery):
    """
    A petrol engine with a generator, which hunts: the linkage of its throttle has play.

    The governor moves it through that again and again, so that the speed, and with it the voltage,
    never comes to rest, whatever the load does. Limit cycles by play: A. Gelb, W. E. Vander Velde,
    Multiple-Input Describing Functions and Nonlinear System Design, 1968.
    """

    recorded = False
    RESISTS, SWINGS = 0.014, 0.018      # of the voltage: by the load of hover; by the speed
    INERTIA = 0.12                      # s, by the power of hover
    GAIN, INTEGRAL = 0.67, 7.7          # of the governor; 1/s
    PLAY = 0.25                         # of the power of hover, either way
    FINE = 0.005                        # s, the steps

    def __init__(self, size, params, rng):
        """Set what the load takes."""
        super().__init__(0.0, 1.8)
        self.size = size
        self.parameters = {'resistance': self.RESISTS * size, 'swings': self.SWINGS * size}

    def begin(self, rng):
        """Draw where in its play the throttle is."""
        self._speed, self._sum = 0.0, 0.0
        self._gives = 1.0 + self.PLAY * rng.uniform(-1.0, 1.0)

    def drain(self, time, step, speeds):
        """Go on; the speed is over the one that it should be, less that."""
        load = float(np.mean(speeds ** 3))
        count = int(np.ceil(step / self.FINE - 1e-9))
        fine = step / count
        for _ in range(count):
            self._speed += fine / self.INERTIA * (self._gives - load)
            self._sum += fine * self._speed
            asks = 1.0 - self.GAIN * self._speed - self.INTEGRAL * self._sum
            self._gives = min(max(self._gives, asks - self.PLAY), asks + self.PLAY)
        self.ratio = 1.0 - self.size * (self.RESISTS * load - self.SWINGS * self._speed)
