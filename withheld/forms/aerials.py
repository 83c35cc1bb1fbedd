# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A rotor whose motor is commutated too early or too late, and one in the wake of an aerial."""

import numpy as np

from withheld.forms.body import Fault


class Mistimed(Fault):
    """
    A motor whose controller switches its phases at the right angle at one speed alone.

    The angle that it is off by goes with the speed, and what that takes of the torque with its
    square. J. C. Gamazo-Real, E. Vazquez-Sanchez, J. Gomez-Gil, Position and speed control of
    brushless DC motors using sensorless techniques and application trends, Sensors 10(7), 2010.
    """

    LEAST, MORE = 0.4, 25.0     # of the mean loss: at that speed; per square of what is off
    OFF, MOST = 0.12, 0.35      # of the speed in hover: off hover; what counts, at most

    def __init__(self, size, params, rng):
        """Draw whether it is right below hover or above."""
        super().__init__(size, params, rng)
        self.right = 1.0 + self.OFF * float(rng.choice([-1.0, 1.0]))

    def gain(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: self.LEAST + self.MORE * min(
            abs(turn - self.right), self.MOST) ** 2)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)


class Masked(Fault):
    """
    An aerial that a crash has bent to before one rotor, which loses most in its wake.

    So the loss depends on where the flow comes from, and there is some of it in hover. Wakes of
    rods: H. Schlichting, Boundary-Layer Theory, 1979, chapter 24; the torque stays.
    """

    ALWAYS, MORE = 0.6, 3.0     # of the mean loss: in hover; in the middle of the wake
    WIDE, SLOW = 0.7, 0.5       # rad, to one part in e; m/s, at which half of it is there

    def __init__(self, size, params, rng):
        """Draw where it stands, seen from the rotor."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.towards = np.array([np.cos(angle), np.sin(angle)])

    def gain(self, now):
        """Return the factors."""
        air = now.hubs()[self.rotor][:2]
        fast = float(np.linalg.norm(air))
        # The flow comes from where the rotor goes.
        angle = np.arccos(np.clip(float(air @ self.towards) / max(fast, 1e-9), -1.0, 1.0))
        wake = fast / (fast + self.SLOW) * np.exp(-(angle / self.WIDE) ** 2)
        return self.losing(now, lambda turn: self.ALWAYS + self.MORE * wake)
