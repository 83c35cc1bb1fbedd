# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What heats up: the windings of motors, a fuse of the battery, a gyroscope with a heater."""

import numpy as np

from withheld.actuators import Battery, Motor
from withheld.constants import hover_speed
from withheld.forms.body import Bias, signs
from withheld.forms.motors import TIME, towards


class HotWindings(Motor):
    """
    Motors that slow down as they heat: copper resists more then, and magnets hold less flux.

    The time constant is inertia times resistance over the square of the flux (J. R. Hendershot,
    T. J. E. Miller, Design of Brushless Permanent-Magnet Machines, 2010); the heat comes of the
    current, which goes with the square of the speed, each motor by itself.
    """

    COLD, GROWS = 0.65, 0.6     # of the mean time: without heat, and with that of hover on top
    HEATS = 5.0                 # s

    def __init__(self, size, params, rng):
        """Set the mean time."""
        self.parameters = {'time': TIME * size}
        self.hover, self._heat = hover_speed(params), 0.0

    def turn(self, speeds, command, step):
        """Return the speeds."""
        load = np.clip(speeds / self.hover, 0.0, 2.0) ** 4
        self._heat = self._heat + (1.0 - np.exp(-step / self.HEATS)) * (load - self._heat)
        time = self.parameters['time'] * (self.COLD + self.GROWS * self._heat)
        return towards(speeds, command, time, step)


class Fused(Battery):
    """
    A pack behind a fuse of filled polymer, whose resistance rises steeply as it heats.

    It cools again when the load falls. F. A. Doljack, PolySwitch PTC devices, IEEE Transactions
    on Components, Hybrids, and Manufacturing Technology 4(4), 1981.
    """

    recorded = False
    HEATS = 3.0                 # s
    TRIPS, WIDE = 1.0, 0.12     # of the heat in hover
    COLD, HOT = 0.004, 0.03     # of the voltage, at the load of hover

    def __init__(self, size, params, rng):
        """Start cold."""
        super().__init__(0.0, 1.8)
        self.size, self._heat = size, 0.0
        self.parameters = {'resistance': self.HOT * size}

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._heat += (1.0 - np.exp(-step / self.HEATS)) * (min(load, 3.0) ** 2 - self._heat)
        hot = 1.0 / (1.0 + np.exp(-(self._heat - self.TRIPS) / self.WIDE))
        self.ratio = 1.0 - self.size * load * (self.COLD + (self.HOT - self.COLD) * hot)


class Thermostat(Bias):
    """
    A gyroscope with a heater that a thermostat switches: its bias rises and falls in turn.

    Towards either end exponentially, each axis by a coefficient of its own; as autopilots heat
    their sensors in practice.
    """

    HEATING, COOLING = 2.0, 4.0         # s
    NEARS = 2.0                         # time constants in either
    SWING = 0.5                         # of the bias, either way, at most

    def __init__(self, size, params, rng):
        """Draw the coefficients."""
        super().__init__(size, params, rng)
        self.by_axis = self.SWING * rng.uniform(0.5, 1.0, 3) * signs(rng, 3)

    def begin(self, rng):
        """Draw the phase, s."""
        self.phase = rng.uniform(0.0, self.HEATING + self.COOLING)

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        rest = (time + self.phase) % (self.HEATING + self.COOLING)
        heats = rest < self.HEATING
        done = rest / self.HEATING if heats else (rest - self.HEATING) / self.COOLING
        warmth = 1.0 - 2.0 * np.expm1(-self.NEARS * done) / np.expm1(-self.NEARS)
        return 1.0 + (-warmth if heats else warmth) * self.by_axis
