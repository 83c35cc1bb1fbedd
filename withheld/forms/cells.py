# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Batteries near their end, and controllers that run out of their voltage."""

import numpy as np

from withheld.actuators import Battery


class Rundown(Battery):
    """
    A cell near its end, which polarises the more the less charge is left, and fast at high load.

    Polarisation: C. M. Shepherd, Journal of the Electrochemical Society 112, 1965; charge taken
    with a power of the load: W. Peukert, Elektrotechnische Zeitschrift 20, 1897.
    """

    recorded = False
    LASTS, PEUKERT, LEAST = 28.0, 1.15, 0.08    # s in hover; a power; share of the charge

    def __init__(self, size, params, rng):
        """Set how much it polarises."""
        super().__init__(0.0, 1.8)
        self.size, self._left = size, 1.0
        self.parameters = {'polarisation': 0.008 * size, 'charge': self.LASTS}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._left = max(self._left - step / self.LASTS * load ** self.PEUKERT, self.LEAST)
        self.ratio = 1.0 - 0.008 * self.size * load * (1.0 / self._left - 1.0)


class Headroom(Battery):
    """
    Speed controllers that keep the speed while the voltage lets them: fast rotors fall short.

    That controlled speed hides the voltage up to a limit, which falls with the battery: M.
    Bangura, R. Mahony, Thrust control for multirotor aerial vehicles, IEEE Transactions on
    Robotics 33(2), 2017.
    """

    recorded = False
    FIRST, WIDE = 0.95, 0.1     # of the speed in hover: where it begins, and within how much

    def __init__(self, size, params, rng):
        """Set what a rotor loses that is so much too fast."""
        super().__init__(0.0)
        self.size, self.spent = size, 0.0
        self.parameters = {'loss': 0.006 * size}

    def drain(self, time, step, speeds):
        """Go on."""
        self.spent = 0.3 + time / 20.0
        self.ratio = 1.0 - 0.01 * self.size * self.spent

    def gain(self, speeds):
        """Return the factors on the thrust of rotors at speeds (n,) of those in hover."""
        above = np.logaddexp(0.0, np.clip((speeds - self.FIRST) / self.WIDE, -20.0, 10.0))
        return np.maximum(1.0 - 0.006 * self.size * self.spent * above, 0.2)
