# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed controllers whose integral winds up."""

import numpy as np

from withheld.actuators import Motor
from withheld.forms.motors import TIME


class WoundUp(Motor):
    """
    A speed controller whose integral goes on while its voltage is at the end: then it overshoots.

    A small step is a lag of the first order, since the integral has the time of the motor. K. J.
    Astrom, L. Rundqwist, Integrator windup and how to avoid it, American Control Conference 1989.
    """

    GAIN = 6.0          # V of the speed that it stands for, over what is missing
    FINE = 0.0005       # s, the steps at most

    def __init__(self, size, params, rng):
        """Set the time constant of small steps, and the speed of the full voltage, rad/s."""
        # The gap grows faster than the lag.
        self.parameters = {'time': 0.7 * TIME * size ** 0.75}
        self.full = params['rotor_speed_max']
        self._integral = None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time']
        if not time:
            return command
        integral = speeds if self._integral is None else self._integral
        count = int(np.ceil(step / min(self.FINE, 0.2 * time) - 1e-9))
        share = step / count / (self.GAIN * time)
        for _ in range(count):
            missing = self.GAIN * (command - speeds)
            voltage = np.clip(integral + missing, 0.0, self.full)
            speeds = speeds + share * (voltage - speeds)
            integral = integral + share * missing
        self._integral = integral
        return speeds
