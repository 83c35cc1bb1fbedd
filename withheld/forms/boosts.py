# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors whose controller lets the throttle lead."""

import numpy as np

from withheld.actuators import Motor
from withheld.forms.motors import TIME, towards


class Boosted(Motor):
    """
    Motors behind an autopilot that adds what is fast in the throttle to it once more.

    So that all together they come sooner, and swing past by a little; what turns the body has the
    whole lag of the motors. What is more than the whole throttle is lost. As firmware for racing
    has it in practice (the throttle boost of Betaflight, of a half and 15 Hz).
    """

    BOOST, SLOW = 0.8, 0.9      # of what is fast in the mean command; of the time, of the filter

    def __init__(self, size, params, rng):
        """Set the time constant, which is the mean delay of what differs among the rotors."""
        self.parameters = {'time': TIME * size}
        self.full, self._slow = params['rotor_speed_max'], None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time']
        if not time:
            return command
        mean = float(np.mean(command))
        before = float(np.mean(speeds)) if self._slow is None else self._slow
        self._slow = float(towards(before, mean, self.SLOW * time, step))
        # On average over the step.
        fast = (before - self._slow) * self.SLOW * time / step
        goal = np.clip(command - self.BOOST * fast, 0.0, np.maximum(self.full, command))
        return towards(speeds, goal, time, step)
