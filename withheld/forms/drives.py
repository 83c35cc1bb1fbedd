# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors whose current is limited, and motors of which one is slower than the others."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME, towards


class CurrentLimited(Motor):
    """
    A lag of the first order whose torque is limited, as its controller limits the current.

    The limit is a little above what the top speed takes. The propeller's own torque helps to slow
    it and leaves less to drive it, the more so the faster it turns. Drives with a limit of the
    current inside the loop of the speed: R. Krishnan, Permanent Magnet Synchronous and Brushless
    DC Motor Drives, 2010.
    """

    DRIVES = 8.0        # 1/s, of the speed in hover, what is left there at the limit, for size 1
    LIMIT = 1.1         # of the torque at the top speed

    def __init__(self, size, params, rng):
        """Set the time constant of small changes, the limit, and what the propeller slows by."""
        grown = size ** 0.7     # the gap grows faster than the lag
        self.parameters = {'time': 0.7 * TIME * grown}
        self.hover = hover_speed(params)
        # Of the torque in hover; and what that slows the propeller by, rad/s^2.
        self.limit = self.LIMIT * (params['rotor_speed_max'] / self.hover) ** 2
        self.slowing = (self.DRIVES * self.hover / (self.limit - 1.0) / grown if size
                        else np.inf)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        driven = towards(speeds, command, self.parameters['time'], step)
        if not np.isfinite(self.slowing):
            return driven
        drag = (speeds / self.hover) ** 2
        least, most = (step * self.slowing * (sign * self.limit - drag) for sign in (-1.0, 1.0))
        return np.clip(driven, speeds + least, speeds + most)


class OneSlow(Motor):
    """
    One motor that is slower than the others, as with a heavier propeller or another controller.

    A time constant goes with the inertia over the slope of the torque (S. Bouabdallah, Design and
    control of quadrotors, EPFL, 2007).
    """

    SLOW = 2.2          # times the mean time of all

    def __init__(self, size, params, rng):
        """Draw which one."""
        count = params['num_rotors']
        self.parameters = {'time': TIME * size}
        self.times = np.full(count, TIME * size * (count - self.SLOW) / (count - 1.0))
        self.times[int(rng.integers(count))] = TIME * size * self.SLOW

    def turn(self, speeds, command, step):
        """Return the speeds."""
        return towards(speeds, command, self.times, step)
