# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A motor with shorted turns, and a rotor whose blades stall and stay so."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.body import Fault


class Shorted(Fault):
    """
    A motor some of whose turns are shorted: a current goes around in them, and brakes the motor.

    The brake grows with the speed up to where the inductance of these turns holds the current
    down, while what the propeller takes grows with the square; and as they heat, they resist
    more. A. Gandhi, T. Corrigan, L. Parsa, Recent advances in modeling and online detection of
    stator interturn faults in electrical motors, IEEE Transactions on Industrial Electronics
    58(5), 2011.
    """

    PEAK, RESISTS = 1.2, 0.8    # of the speed in hover, where cold turns brake most; by heat
    TIME = 3.0                  # s

    def begin(self, rng):
        """Start cold."""
        self._heat, self._turn = 0.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(np.clip(now.speeds[self.rotor] / self.hover, 0.2, 2.0))
        usual = self.brakes(1.0, 1.0)
        return self.losing(now, lambda turn: self.brakes(turn, self._heat) / usual / turn ** 2)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let the turns heat by what they brake, which is that of hover in the end."""
        power = self._turn * self.brakes(self._turn, self._heat) / self.brakes(1.0, 1.0)
        self._heat = power + np.exp(-step / self.TIME) * (self._heat - power)

    def brakes(self, turn, heat):
        """Return the brake at a speed over that in hover, of the greatest."""
        ratio = turn / (self.PEAK * (1.0 + self.RESISTS * heat))
        return 2.0 * ratio / (1.0 + ratio ** 2)


class Burst(Fault):
    """
    A rotor with dents in its blades: where the air meets them steeply, the flow parts from them.

    It comes back only where the air meets them much flatter again. So a descent or fast flight
    weakens the rotor, and a climb heals it. The loop of small wings about their stall: T. J.
    Mueller, The influence of laminar separation and transition on low Reynolds number airfoil
    hysteresis, Journal of Aircraft 22(9), 1985. The torque grows by a part of it.
    """

    PARTS, HEALS, TIME = 0.1, 0.0, 0.08     # of the inflow in hover, that is missing; s
    LOSSES, TORQUE = (0.3, 1.7), 0.3        # of the mean loss: before, after; of the loss

    def __init__(self, size, params, rng):
        """Set the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def begin(self, rng):
        """Start with a flow that holds."""
        self._goal, self._parted, self._steep = 0.0, 0.0, 0.0

    def gain(self, now):
        """Return the factors."""
        turn = max(float(now.speeds[self.rotor]) / self.hover, 0.2)
        x, y, z = (now.hubs()[self.rotor] / (turn * self.induced)).tolist()
        # What goes through the disk is the climb and the induced velocity, less in level flight.
        self._steep = 1.0 - z - (1.0 + x * x + y * y) ** -0.5
        loss = self.LOSSES[0] + (self.LOSSES[1] - self.LOSSES[0]) * self._parted
        return self.losing(now, lambda turn: loss)

    def torque(self, now):
        """Return the factors."""
        return 1.0 + self.TORQUE * (1.0 - self.gain(now))

    def after(self, step, rotation, acceleration):
        """Let the flow part or come back."""
        if self._steep > self.PARTS or self._steep < self.HEALS:
            self._goal = float(self._steep > self.PARTS)
        self._parted += (1.0 - np.exp(-step / self.TIME)) * (self._goal - self._parted)
