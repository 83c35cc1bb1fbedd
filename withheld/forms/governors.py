# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors of variable pitch that one engine drives, whose speed a governor keeps."""

import numpy as np

from withheld.forms.air import Thrust
from withheld.forms.blades import swept


class Drooping(Thrust):
    """
    Rotors of variable pitch on one petrol engine, which a climb slows down, all of them together.

    The throttle is mixed with the pitch, so that a load alone slows nothing down; what the flow
    takes of the power, a governor finds out by the speed, and makes up for by and by. So it is
    changes of the flow that count, beside what it takes from the blades. T. Pang, K. Peng, F. Lin,
    B. M. Chen, Towards long-endurance flight: design and implementation of a variable-pitch
    gasoline-engine quadrotor, IEEE International Conference on Control and Automation 2016.
    """

    TAKES, DROOPS = 0.012, 0.03     # per induced velocity: of the thrust; of the speed
    ENGINE, GOVERNS = 0.25, 1.5     # s, of the engine by itself; of the governor's integral
    LEAST = 0.3                     # of the speed

    def begin(self, rng):
        """Start with the speed that it is to have."""
        self._asks, self._droop, self._opens = 0.0, 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        flow = np.clip(z, -3.0, 3.0) + swept(np.hypot(x, y)) - 1.0
        # Of the power: the thrust times what goes through, over that in hover.
        self._asks = float(np.mean(turn ** 3 * flow))
        speed = max(1.0 - self.size * self._droop, self.LEAST)
        return (1.0 - self.size * self.TAKES * flow) * speed ** 2

    def after(self, step, rotation, acceleration):
        """Let the engine slow down, and the governor open the throttle."""
        goal = self.DROOPS * self._asks - self._opens
        self._droop += (1.0 - np.exp(-step / self.ENGINE)) * (goal - self._droop)
        self._opens += step / self.GOVERNS * self._droop
