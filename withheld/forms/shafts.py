# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A rotor that hangs at a resonance on its way up, and one whose controller hunts."""

import numpy as np

from withheld.forms.body import Fault


class Hanging(Fault):
    """
    A bent shaft, which shakes the arm at a speed: there the motor hangs on its way up.

    All that it gives more goes into shaking, until it is enough to get past; on the way down it
    is past at once. M. Eckert, The Sommerfeld effect: theory and history of a remarkable
    resonance phenomenon, European Journal of Physics 17(5), 1996.
    """

    FIRST, MORE = 0.5, 12.0             # of the mean loss: always; of what is above that speed
    HANGS, PAST, TIME = 1.0, 1.12, 0.05     # of the speed in hover, each; s

    def begin(self, rng):
        """Start below."""
        self._past, self._hangs, self._turn = False, 1.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(now.speeds[self.rotor]) / self.hover
        more = self.MORE * self._hangs
        return self.losing(now, lambda turn: self.FIRST + more * (
            1.0 - (self.HANGS / max(turn, self.HANGS)) ** 2))

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it get past or hang again."""
        self._past = self._turn > (self.HANGS if self._past else self.PAST)
        goal = 0.0 if self._past else 1.0
        self._hangs += (1.0 - np.exp(-step / self.TIME)) * (goal - self._hangs)


class Hunting(Fault):
    """
    A motor whose controller is too keen for little load: its speed hunts there, and is calm above.

    A limit cycle that grows and dies away: A. A. Andronov, A. A. Vitt, S. E. Khaikin, Theory of
    Oscillators, 1966. It is too slow on average.
    """

    SWINGS, RATE = 1.3, 1.6             # of the mean loss, either way; Hz
    BELOW, TIME = 1.05, 0.5             # of the speed in hover, where it hunts; s

    def begin(self, rng):
        """Draw the phase, and start calm."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)
        self._hunts, self._turn = 0.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(now.speeds[self.rotor]) / self.hover
        wave = np.sin(2.0 * np.pi * self.RATE * now.time + self.phase)
        return self.losing(now, lambda turn: 1.0 + self.SWINGS * self._hunts * wave)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it grow or die away."""
        goal = float(self._turn < self.BELOW)
        self._hunts += (1.0 - np.exp(-step / self.TIME)) * (goal - self._hunts)
