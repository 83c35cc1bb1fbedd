# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Controllers of motors with two sets of gains, or with an integral that is emptied."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class Scheduled(Motor):
    """
    A speed controller with gentle gains for slow rotors and keen ones for fast rotors.

    It changes over at a higher speed on the way up than on the way down, so that it does not
    chatter. W. J. Rugh, J. S. Shamma, Research on gain scheduling, Automatica 36(10), 2000.
    """

    GENTLE, KEEN = 0.6, 2.4     # of the rate
    UP, DOWN = 1.04, 0.96       # of the speed in hover, at which it changes over

    def __init__(self, size, params, rng):
        """Set the mean time constant, and start with the gentle ones."""
        self.parameters = {'time': TIME * size}
        self.hover = hover_speed(params)
        self._keen = False

    def turn(self, speeds, command, step):
        """Return the speeds."""
        turn = speeds / self.hover
        self._keen = (turn > self.UP) | (self._keen & (turn > self.DOWN))
        rate = np.where(self._keen, self.KEEN, self.GENTLE)
        return towards(speeds, command, self.parameters['time'] / rate, step)


class Resetting(Motor):
    """
    A speed controller whose integral is emptied as soon as nothing is missing: no overshoot.

    So the end of a step is as fast as its middle. J. C. Clegg, A nonlinear integrator for
    servomechanisms, Transactions of the AIEE 77(2), 1958.
    """

    DAMPING = 0.3       # as it would be without

    def __init__(self, size, params, rng):
        """Set the mean delay, and the frequency, rad/s, that it takes."""
        self.parameters = {'time': TIME * size}
        z = self.DAMPING
        # What a step of 1 misses until it is there, over its time.
        share = np.exp(-z * np.arccos(z) / np.sqrt(1.0 - z * z))
        self.rate = share / (TIME * size) if size else np.inf
        self._sum, self._side = 0.0, 0.0

    def turn(self, speeds, command, step):
        """Return the speeds, by the solution for a held command."""
        if not np.isfinite(self.rate):
            return command
        e, d = command - speeds, self.DAMPING * self.rate
        side = np.sign(e)
        x = np.where(side == self._side, self._sum, 0.0)
        w = np.sqrt(self.rate ** 2 - d ** 2)
        c, s, f = np.cos(w * step), np.sin(w * step), np.exp(-d * step)
        missing = f * (e * c - (d * e + x) / w * s)
        there = missing * side <= 0.0
        self._sum = np.where(there, 0.0, f * (x * c + (self.rate ** 2 * e + d * x) / w * s))
        self._side = np.where(there, 0.0, side)
        return np.where(there, command, command - missing)
