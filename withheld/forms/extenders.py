# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A pack with an engine beside that starts and stops."""

import numpy as np

from withheld.actuators import Battery


class Extended(Battery):
    """
    A pack with a small engine beside that charges it, from when it is low until it is full again.

    Its starter takes some at first. The control like a thermostat's: J. R. Bumby, I. Forster,
    Optimisation and control of a hybrid electric car, IEE Proceedings D 134(6), 1987.
    """

    recorded = False
    RESISTS, FALLS = 0.012, 0.06    # of the voltage: in hover; of it, in 30 s
    LOW, FULL = 0.22, 0.08          # of the charge of 30 s in hover, that is taken
    GIVES, TIME = 1.8, 0.8          # of the power in hover; s, until it gives most of it
    STARTER, CRANKS = 0.4, 0.6      # of the power in hover; s

    def __init__(self, size, params, rng):
        """Start with a full pack, and the engine off."""
        super().__init__(0.0, 1.8)
        self.size, self._taken, self._since, self._gives = size, 0.0, None, 0.0
        self.parameters = {'resistance': self.RESISTS * size, 'falls': self.FALLS * size}

    def drain(self, time, step, speeds):
        """Go on."""
        if self._since is None and self._taken > self.LOW:
            self._since = time
        elif self._since is not None and self._taken < self.FULL:
            self._since = None
        cranks = self._since is not None and time - self._since < self.CRANKS
        goal = self.GIVES * float(self._since is not None and not cranks)
        self._gives += (1.0 - np.exp(-step / self.TIME)) * (goal - self._gives)
        load = float(np.mean(speeds ** 3)) + self.STARTER * cranks - self._gives
        self._taken = max(self._taken + load * step / 30.0, 0.0)
        self.ratio = 1.0 - self.size * (self.RESISTS * load + self.FALLS * self._taken)
