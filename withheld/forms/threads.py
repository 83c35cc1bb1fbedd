# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A rotor with a thread around its shaft, and one whose controller only the flight cools."""

import numpy as np

from withheld.forms.body import Fault


class Wound(Fault):
    """
    A hair or a thread that one rotor has taken in and winds around its shaft, where it rubs.

    Its friction is the same at every speed. It grows by an equal share with every turn, as a rope
    on a capstan holds (L. Euler, Memoires de l'Academie de Berlin 18, 1769), until all of the
    thread is wound up. As small vehicles over carpets have it in practice.
    """

    OWN, MORE = 0.3, 1.4            # of the mean loss, at first; more, when all is wound up
    HALF, GROWS = (4.0, 12.0), 1.2  # s in hover: until half of that; in which it grows e times
    SLOWEST = 0.5                   # of the speed in hover: below, it takes no larger a share

    def begin(self, rng):
        """Draw when half of it rubs."""
        self._wound, self._turn = -rng.uniform(*self.HALF), 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(np.clip(now.speeds[self.rotor] / self.hover, 0.0, 2.0))
        rubs = self.OWN + self.MORE / (1.0 + np.exp(-self._wound / self.GROWS))
        return self.losing(now, lambda turn: rubs / max(turn, self.SLOWEST) ** 2)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Wind it up."""
        self._wound += step * self._turn


class Uncooled(Fault):
    """
    A controller of one motor that sits badly: it gets hot in hover, and only flight cools it.

    What it lacks goes with its heat, as the resistance of its transistors; heat comes with the
    square of the torque, and goes at rest, and with the root of the speed: F. P. Incropera, D. P.
    DeWitt, Fundamentals of Heat and Mass Transfer, 1996, on plates in a laminar flow.
    """

    OWN, TIME = 0.2, 3.0        # of the mean loss, cold; s
    REST, BLOWN = 0.6, 0.8      # of what goes: at rest, at 1 m/s on top
    FIRST = 0.5                 # of the usual heat

    def begin(self, rng):
        """Start lukewarm."""
        self._heat, self._load, self._cools = self.FIRST, 1.0, self.REST

    def gain(self, now):
        """Return the factors."""
        self._load = float(np.clip(now.speeds[self.rotor] / self.hover, 0.2, 1.5)) ** 4
        self._cools = self.REST + self.BLOWN * np.sqrt(np.linalg.norm(now.air))
        return self.losing(now, lambda turn: self.OWN + self._heat)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it heat and cool."""
        goal = self._load / self._cools
        self._heat = goal + np.exp(-step * self._cools / self.TIME) * (self._heat - goal)
