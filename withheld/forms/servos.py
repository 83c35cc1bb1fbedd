# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors of variable pitch, whose servos are slow."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME


class Servoed(Motor):
    """
    Rotors of one speed whose blades are pitched by servos: these swing, and are only so fast.

    So it is the thrust that follows, and large changes take long. A servo holds a position and
    has a top rate: M. Cutler, J. P. How, Analysis and control of a variable-pitch quadrotor for
    agile flight, ASME Journal of Dynamic Systems, Measurement, and Control 137(10), 2015. What
    the blades do stands here as the speed that would give their thrust.
    """

    DAMPING = 0.6       # of critical
    FASTEST = 0.2       # of the thrust in hover, per mean time
    FINE = 0.001        # s, the steps

    def __init__(self, size, params, rng):
        """Set the mean time of a small change."""
        self.parameters = {'time': TIME * size}
        self.hover, self._slope = hover_speed(params), 0.0

    def turn(self, speeds, command, step):
        """Return the speeds, in each fine step by the solution for a held command."""
        time = self.parameters['time']
        if not time:
            return command
        thrust, goal = (speeds / self.hover) ** 2, (command / self.hover) ** 2
        rate, most = 2.0 * self.DAMPING / time, self.FASTEST / time
        damps = self.DAMPING * rate
        swings = np.sqrt(rate ** 2 - damps ** 2)
        count = int(np.ceil(step / self.FINE - 1e-9))
        fine = step / count
        fades = np.exp(-damps * fine)
        c, s = fades * np.cos(swings * fine), fades * np.sin(swings * fine) / swings
        for _ in range(count):
            off, v = thrust - goal, self._slope
            goes = off * c + (v + damps * off) * s - off
            thrust = thrust + np.clip(goes, -most * fine, most * fine)
            self._slope = np.clip(v * c - (damps * v + rate ** 2 * off) * s, -most, most)
        return self.hover * np.sqrt(np.maximum(thrust, 0.0))
