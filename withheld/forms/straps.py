# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Straps that a turn flings out, and one that hangs beside a rotor."""

import numpy as np

from withheld.forms.body import Coupled, Fault


class Flung(Coupled):
    """
    Straps and cables that hang down, and that a turn of the body flings out: then they are more.

    So what has to be turned grows with the square of the rate, as the balls of a governor: J. C.
    Maxwell, On governors, Proceedings of the Royal Society of London 16, 1868.
    """

    TIME, RISES = 0.02, 0.25            # s: in which it is taken along; in which it is flung out
    LEAST, MORE, RATE = 0.4, 2.0, 1.0   # of it; of it, flung out; rad/s, that flings half of it

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate, self._share = np.zeros(3), np.zeros(3), self.LEAST

    def wrench(self, now):
        """Return the moment that takes it along."""
        self._rate = now.rate
        return np.zeros(3), self.loads * self._share / self.TIME * (self._turning - now.rate)

    def after(self, step, rotation, acceleration):
        """Let it follow, and be flung out with its momentum."""
        square = float(self._turning @ self._turning) / self.RATE ** 2
        goal = self.LEAST + self.MORE * square / (1.0 + square)
        share = self._share + (1.0 - np.exp(-step / self.RISES)) * (goal - self._share)
        turning = self._turning * self._share / share
        self._turning = self._rate + np.exp(-step / self.TIME) * (turning - self._rate)
        self._share = share


class Strapped(Fault):
    """
    A strap that came loose and hangs beside one rotor: flow from one side blows it below.

    There it takes thrust, and the flow from the other side sets the rotor free. As of straps for
    batteries in practice.
    """

    BLOWN, SMOOTH = 0.8, 0.15       # m/s, of the flow; s

    def __init__(self, size, params, rng):
        """Draw on which side it hangs."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([np.cos(angle), np.sin(angle), 0.0])

    def begin(self, rng):
        """Start with half of it below."""
        self._below, self._goal = 1.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._goal = 1.0 + float(np.tanh(-(now.air @ self.onto) / self.BLOWN))
        return self.losing(now, lambda turn: self._below)

    def after(self, step, rotation, acceleration):
        """Let it be blown."""
        self._below += (1.0 - np.exp(-step / self.SMOOTH)) * (self._goal - self._below)
