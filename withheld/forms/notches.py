# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind a notch, and motors whose controllers cut a phase off for a while."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class Notched(Motor):
    """
    Commands that pass a notch, so that a soft frame does not swing: a step comes, dips, returns.

    Notches against a resonance: G. F. Franklin, J. D. Powell, A. Emami-Naeini, Feedback Control of
    Dynamic Systems, 2002, chapter 6. A short lag of the motor is behind it.
    """

    DAMPING, OWN = 0.5, 0.1         # of the notch; of the mean time, the lag of the motor

    def __init__(self, size, params, rng):
        """Set the mean time, and where the notch is, rad/s."""
        # The gap grows faster than the lag.
        self.parameters = {'time': 0.6 * TIME * size ** 0.75}
        notch = (1.0 - self.OWN) * self.parameters['time']
        self.rate = 2.0 * self.DAMPING / notch if size else np.inf
        self._smooth, self._slope = None, 0.0

    def turn(self, speeds, command, step):
        """Return the speeds, by the solution for a held command."""
        if not np.isfinite(self.rate):
            return command
        smooth = speeds if self._smooth is None else self._smooth
        e, v, d = smooth - command, self._slope, self.DAMPING * self.rate
        w = np.sqrt(self.rate ** 2 - d ** 2)
        c, s, f = np.cos(w * step), np.sin(w * step), np.exp(-d * step)
        self._smooth = command + f * (e * c + (v + d * e) / w * s)
        self._slope = f * (v * c - (d * v + self.rate ** 2 * e) / w * s)
        goal = command - self.DAMPING / self.rate * (v + self._slope)
        return towards(speeds, goal, self.OWN * self.parameters['time'], step)


class Demagnetised(Motor):
    """
    A controller that cuts the power for a while when a coil is not rid of its current in time.

    That happens where much is missing, so that a large rise comes in pieces, and a small one or a
    fall does not. As manuals of such controllers describe what they do against it.
    """

    STEEP = 0.025               # of the speed in hover, what is missing where it happens
    DRIVES, CUTS = 0.6, 1.0     # of the time constant, each
    SLOWING = 1.5               # 1/s, of a propeller alone at the speed of hover
    FINE = 0.0005               # s, the steps

    def __init__(self, size, params, rng):
        """Set the time constant of what is driven."""
        # The gap grows faster than the lag.
        self.parameters = {'time': 0.35 * TIME * size ** 0.7}
        self.steep = self.STEEP * hover_speed(params)
        self.slowing = self.SLOWING / hover_speed(params)
        self._driven, self._left = 0.0, 0.0

    def turn(self, speeds, command, step):
        """Return the speeds."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            speeds = self._go(speeds, command, step / count)
        return speeds

    def _go(self, speeds, command, step):
        time = self.parameters['time']
        cut = np.asarray(self._left) > 1e-9
        after = np.where(cut, speeds / (1.0 + self.slowing * step * speeds),
                         towards(speeds, command, time, step))
        self._driven = np.where(cut | (command - speeds < self.steep), 0.0, self._driven + step)
        self._left = np.where(self._driven > self.DRIVES * time, self.CUTS * time,
                              np.maximum(self._left - step, 0.0))
        return after
