# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors behind an autopilot that smooths one axis of what it asks for, and not the others."""

import numpy as np

from withheld.actuators import Motor
from withheld.forms.motors import TIME, towards


class Smoothed(Motor):
    """
    Motors with a lag, behind a low pass of what their speeds have of a pattern.

    SLOWER: times the lag of the motors, the low pass; pattern_of(params): of 1 and -1, (n,).
    """

    def __init__(self, size, params, rng):
        """Set both times."""
        self.parameters = {'time': TIME * size, 'smooths': self.SLOWER * TIME * size}
        self.pattern = self.pattern_of(params)
        self._share = None

    def share(self, speeds):
        """Return what the speeds (n,) have of the pattern, rad/s."""
        return float(self.pattern @ speeds) / len(self.pattern)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        if not self.parameters['time']:
            return command
        asked = self.share(command)
        before = self.share(speeds) if self._share is None else self._share
        self._share = float(towards(before, asked, self.parameters['smooths'], step))
        late = 0.5 * (before + self._share) - asked
        return towards(speeds, command + late * self.pattern, self.parameters['time'], step)


class YawSmoothed(Smoothed):
    """
    Motors with a lag, behind a low pass of the yaw torque alone.

    Roll, pitch and thrust pass it by, so that the rotors of one spin come late against those of
    the other. PX4 has it (MC_YAW_TQ_CUTOFF, 2 Hz as delivered), since yaw needs large
    changes of the speed, which shake motors and frame.
    """

    SLOWER = 3.5        # 80 ms beside 23 ms

    def pattern_of(self, params):
        """Return the spins (n,)."""
        return np.asarray(params['rotor_directions'], float)


class ThrottleSmoothed(Smoothed):
    """
    Motors with a lag, behind a low pass of the thrust of all together.

    What turns the body passes it by. ArduPilot's control of the altitude has it, at 2 Hz
    (POSCONTROL_THROTTLE_CUTOFF_FREQ_HZ).
    """

    SLOWER = 2.0        # 80 ms beside 40 ms, of large propellers

    def pattern_of(self, params):
        """Return ones (n,)."""
        return np.ones(params['num_rotors'])
