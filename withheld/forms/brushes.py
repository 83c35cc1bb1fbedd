# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors with brushes, which have a share of the voltage and nobody who minds their speed."""

import numpy as np

from withheld.actuators import Battery


class OpenLoop(Battery):
    """
    Small motors with brushes, which get a share of the voltage whatever speed comes of it.

    A voltage is what the speed induces and what the current takes in the resistance, which goes
    with its square: so fast rotors lose less of a sag than slow ones, and those with worn brushes
    less than others. As a Crazyflie has it; J. Foerster, System Identification of the Crazyflie
    2.0 Nano Quadrocopter, ETH Zurich, 2015.
    """

    recorded = False
    RESISTS, FALLS = 0.014, 0.02    # of the voltage, in hover; of it, in 30 s
    TAKES, SPREAD = 0.5, 0.25       # of a motor's voltage, in hover, by the current; either way

    def __init__(self, size, params, rng):
        """Draw how worn the brushes are."""
        super().__init__(0.0)
        self.size, self._taken = size, 0.0
        self.takes = self.TAKES + self.SPREAD * rng.uniform(-1.0, 1.0, params['num_rotors'])
        self.parameters = {'resistance': self.RESISTS * size, 'falls': self.FALLS * size}

    def share(self, speeds):
        """Return the shares (n,) of the voltage that speeds (n,) ask for, over those in hover."""
        return (1.0 - self.takes) * speeds + self.takes * speeds ** 2

    def drain(self, time, step, speeds):
        """Go on: a current goes with the square of the speed, for its share of the time."""
        load = float(np.mean(self.share(speeds) * speeds ** 2))
        self._taken += load * step
        self.ratio = 1.0 - self.size * (self.RESISTS * load + self.FALLS * self._taken / 30.0)

    def gain(self, speeds):
        """Return the factors (n,): the squares of the speeds that come of the voltage."""
        speeds = np.maximum(speeds, 0.05)
        linear, given = 1.0 - self.takes, max(self.ratio, 0.0) * self.share(speeds)
        turns = (np.sqrt(linear ** 2 + 4.0 * self.takes * given) - linear) / (2.0 * self.takes)
        return (turns / speeds) ** 2
