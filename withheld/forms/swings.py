# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What swings as the body turns: a battery in a sling, and a board of sensors on gel."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Centre, Tilt


class Swing:
    """
    How far a body is turned from what hangs on it by a spring with a damper, about each axis.

    angle (3,) rad; J. P. Den Hartog, Mechanical Vibrations, 1956, section 2.
    """

    FINE = 0.005        # s, the steps

    def __init__(self, frequency, damping):
        """Start at rest; frequency rad/s, damping of the critical one."""
        self.frequency, self.damping = frequency, damping
        self.angle, self.turning = np.zeros(3), np.zeros(3)

    def go(self, rate, step):
        """Go on by a step in which the body turns with a rate (3,) rad/s."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            h = step / count
            self.turning = self.turning + h * self.frequency * (
                self.frequency * self.angle + 2.0 * self.damping * (rate - self.turning))
            self.angle = self.angle + h * (rate - self.turning)


class Swaying(Centre):
    """
    A battery in a sling below, off the centre: it stays behind as the body turns, and sways.

    Its pull is not that of a battery that is fixed until it hangs straight again.
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 1.2, 0.2         # rad/s; of the critical one
    SWAYS = 6.0         # of the mean offset, by a rad

    def begin(self, rng):
        """Start at rest."""
        self._swing, self._rate = Swing(self.FREQUENCY, self.DAMPING), np.zeros(3)

    def wrench(self, now):
        """Return the moment of what it pulls by beside the mean."""
        self._rate = now.rate
        away = self.SWAYS * float(np.linalg.norm(self.centre[:2]))
        roll, pitch, _ = -away * np.clip(self._swing.angle, -0.5, 0.5)
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([roll, pitch, 0.0])

    def after(self, step, rotation, acceleration):
        """Let it sway."""
        self._swing.go(self._rate, step)


class Rocking(Tilt):
    """
    A board of sensors that sits askew on gel, and rocks after every turn of the body.

    Its gyroscope measures that it rocks, too.
    """

    FREQUENCY, DAMPING = 2.0 * np.pi * 2.5, 0.2         # rad/s; of the critical one
    ROCKS = 0.4         # of the swing, per size

    def begin(self, rng):
        """Start at rest."""
        self._swing, self._last = Swing(self.FREQUENCY, self.DAMPING), None

    def measured(self, time, state, thrust):
        """Return what the board says."""
        self._swing.go(state[10:], 0.0 if self._last is None else time - self._last)
        self._last, share = time, -self.ROCKS * self.size
        out = self.tilted(state)[0]
        rocks = Rotation.from_rotvec(share * self._swing.angle)
        out[6:10] = (Rotation.from_quat(out[6:10]) * rocks).as_quat()
        out[10:] += share * (state[10:] - self._swing.turning)
        return out
