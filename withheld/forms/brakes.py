# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors that are braked only in large steps, or whose load comes later than their speed."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class LateBrake(Motor):
    """
    A controller that brakes a motor only where it is much too fast, and lets it coast otherwise.

    Once it brakes, it goes on until nothing is missing. Controllers that choose between coasting
    and braking do so by a threshold in practice; that braking costs power, so that it is avoided
    for small changes: A. Franchi, A. Mallet, ICRA 2017, as in escs.py.
    """

    BRAKES, LEAVES = 0.04, 0.004        # of the speed in hover, what is too much, and the end
    SLOWING = 1.2       # 1/s, of a propeller alone at the speed of hover, for size 1

    def __init__(self, size, params, rng):
        """Set the time constant of what is driven or braked, and how slowly the rest falls."""
        grown = size ** 0.7     # the gap grows faster than the lag
        self.parameters = {'time': 0.7 * TIME * grown}
        self.hover, self._brakes = hover_speed(params), False
        self.slowing = self.SLOWING / (grown * self.hover) if size else np.inf

    def turn(self, speeds, command, step):
        """Return the speeds."""
        above = (speeds - command) / self.hover
        self._brakes = (above > self.BRAKES) | (self._brakes & (above > self.LEAVES))
        driven = towards(speeds, command, self.parameters['time'], step)
        coasts = np.maximum(driven, speeds / (1.0 + self.slowing * step * speeds))
        return np.where(self._brakes, driven, coasts)


class LoadedLate(Motor):
    """
    Motors on a voltage, whose propellers meet their load only as the inflow comes: they overshoot.

    Without a control of the speed it is the torque that decides it, and this follows the inflow
    (P. J. Carpenter, B. Fridovich, NACA TN 3044, 1953): a zero beside two real poles, so that
    the speed creeps back without a swing.
    """

    OVER = 0.2          # of a step, how much more there would be without the load that is late
    FAST, SLOW = 1.8, 4.0       # times the mean time

    def __init__(self, size, params, rng):
        """Set the mean time of what is missing, of which motor and inflow take some times."""
        self.parameters = {'time': 0.6 * TIME * size}
        self._load = None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time']
        if not time:
            return command
        before = speeds if self._load is None else self._load
        self._load = towards(before, command, self.SLOW * time, step)
        goal = command + self.OVER * (command - 0.5 * (before + self._load))
        return towards(speeds, goal, self.FAST * time, step)
