# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind over a layer of calm air, and below another vehicle."""

import numpy as np

from withheld.forms.air import Wind


class Layered(Wind):
    """
    Cold air that lies calm on the ground, and wind above it; between them waves run along.

    A layer of shear by a hyperbolic tangent: P. G. Drazin, The stability of a shear layer in an
    unbounded heterogeneous inviscid fluid, Journal of Fluid Mechanics 4, 1958.
    """

    BELOW, ABOVE = 0.5, 1.5             # of the mean
    HEIGHT, DEEP, RISES = 1.0, 0.3, 0.3         # m, each: of the layer, its half, its waves
    LENGTH, PERIOD = 6.0, 5.0           # m, s, of the waves

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        speed = float(np.linalg.norm(self.mean))
        if not speed:
            return np.zeros(3)
        on = position @ self.mean / speed
        wave = np.sin(2.0 * np.pi * (on / self.LENGTH - time / self.PERIOD) + self.phase)
        above = 0.5 * (1.0 + np.tanh(
            (position[2] - self.HEIGHT - self.RISES * wave) / self.DEEP))
        return (self.BELOW + (self.ABOVE - self.BELOW) * above) * self.mean


class Overflown(Wind):
    """
    A steady wind, and the wake of another vehicle, which circles above and sends it down.

    With Gauss's curve across: K. P. Jain, T. Fortmuller, J. Byun, S. A. Makiharju, M. W. Mueller,
    Modeling of aerodynamic disturbances for proximity flight of multirotors, ICUAS 2019.
    """

    CIRCLES, AROUND = 0.8, 9.0          # m, of the circle; s, once around
    WIDE, SINKS = 0.6, 1.2              # m; of the mean

    def __init__(self, size, params, rng):
        """Draw which way it goes around, and about what."""
        super().__init__(size, params, rng)
        self.rate = 2.0 * np.pi / self.AROUND * rng.choice([-1.0, 1.0])
        self.place = rng.uniform(-0.4, 0.4, 2)
        self.sinks = self.SINKS * float(np.linalg.norm(self.mean))

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        angle = self.rate * time + self.phase
        there = self.place + self.CIRCLES * np.array([np.cos(angle), np.sin(angle)])
        away = position[:2] - there
        return self.mean - np.array(
            [0.0, 0.0, self.sinks * np.exp(-(away @ away) / self.WIDE ** 2)])
