# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind soft belts, and motors whose field is weakened above a speed."""

import numpy as np
from scipy.linalg import expm

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class Linear(Motor):
    """
    Rotors by a linear law of three states, of which one starts with the speed and one with none.

    The law is a matrix, `_slopes`, of what is beside the speed, of the speed, and of a third one;
    the first two are less what is commanded.
    """

    def __init__(self, size, params, rng):
        """Set the mean time."""
        self.parameters = {'time': TIME * size}
        self._beside, self._third, self._passes = None, 0.0, {}

    def turn(self, speeds, command, step):
        """Return the speeds, by the solution for a held command."""
        if not self.parameters['time']:
            return command
        beside = speeds if self._beside is None else self._beside
        off = np.array([beside - command, speeds - command, self._third + 0.0 * speeds])
        off = self._passed(step) @ off
        self._beside, self._third = command + off[0], off[2]
        return command + off[1]

    def _passed(self, step):
        """Return what a step makes of the states (3, 3)."""
        key = round(step, 9)
        if key not in self._passes:
            self._passes[key] = expm(step * np.array(self._slopes(self.parameters['time'])))
        return self._passes[key]

    def _slopes(self, time):
        """Return the slopes (3, 3) of the states, by the states, of a mean time."""
        raise NotImplementedError


class Belted(Linear):
    """
    Propellers that are driven by soft belts: they come after their motors, and swing past them.

    A belt pulls with its stretch and with what it stretches by in a second; the controllers hold
    the motors themselves. G. Ellis, R. D. Lorenz, Resonant load control methods for industrial
    servo drives, IEEE Industry Applications Society Annual Meeting, 2000. As quadrotors with one
    motor have it in practice. The mean time is that of the motors: a belt adds none.
    """

    RATE, DAMPING = 1.6, 0.15   # over the time of the motor, of belt and propeller; of critical

    def _slopes(self, time):
        """Return the slopes (3, 3) of motor, propeller and stretch."""
        rate = self.RATE / time
        damps = 2.0 * self.DAMPING * rate
        return [[-1.0 / time, 0.0, 0.0], [damps, -damps, rate ** 2], [1.0, -1.0, 0.0]]


class FieldWeakened(Motor):
    """
    Motors whose controllers weaken the field above a speed, since the voltage ends there.

    The flux then falls with the speed, and the time constant grows with its square: inertia times
    resistance over the square of the flux. S. Morimoto, Y. Takeda, T. Hirasa, K. Taniguchi,
    Expansion of operating limits for permanent magnet motor by current vector control considering
    inverter capacity, IEEE Transactions on Industry Applications 26(5), 1990.
    """

    CORNER = 0.9        # of the speed in hover
    LEAST = 0.75        # of the mean time, with the whole field
    FINE = 0.001        # s, the steps

    def __init__(self, size, params, rng):
        """Set the mean time."""
        self.parameters = {'time': TIME * size}
        self.corner = self.CORNER * hover_speed(params)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        least = self.LEAST * self.parameters['time']
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            time = least * np.maximum(speeds / self.corner, 1.0) ** 2
            speeds = towards(speeds, command, time, step / count)
        return speeds
