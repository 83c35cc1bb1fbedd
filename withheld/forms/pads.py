# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect above a pad that drives around, and above a sheet that gives and swings."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.air import Ground


class Driven(Ground):
    """
    A pad on a car that drives to and fro below: above it the ground is nearer.

    As vehicles land on moving cars in practice; each rotor feels what is below it.
    """

    HIGH, HALF = 2.0, 0.5           # radii; m, of the pad, either way
    WAY, PERIOD = 1.0, 9.0          # m, either way; s

    def __init__(self, size, params, rng):
        """Draw which way it drives."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([[np.cos(angle), np.sin(angle), 0.0],
                              [-np.sin(angle), np.cos(angle), 0.0]])

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def law(self, heights, now):
        """Return the gain at size 1."""
        car = self.WAY * np.sin(2.0 * np.pi * now.time / self.PERIOD + self.phase)
        away = (now.position + now.places @ now.rotation.T) @ self.onto.T - [car, 0.0]
        over = np.prod(0.5 * (1.0 + np.tanh((self.HALF - np.abs(away)) / self.radius)), axis=1)
        return 0.12 * np.exp(-0.6 * np.maximum(heights - self.HIGH * over, 0.5))


class Membrane(Ground):
    """
    A sheet, as of a tent or over a pool, which the wake presses down and lets swing up again.

    So the ground is further away from strong rotors that are near, and swings after them. A mass
    on a spring with a damper (J. P. Den Hartog, Mechanical Vibrations, 1956).
    """

    GIVES, FADES = 4.0, 0.5                         # radii, close above, in hover; per radius
    FREQUENCY, DAMPING = 2.0 * np.pi * 0.9, 0.15    # rad/s; of the critical one
    FINE = 0.01                                     # s, the steps

    def __init__(self, size, params, rng):
        """Take what speeds are measured by."""
        super().__init__(size, params, rng)
        self.hover = hover_speed(params)

    def begin(self, rng):
        """Start at rest."""
        self._deep, self._sinks, self._goal = 0.0, 0.0, 0.0

    def law(self, heights, now):
        """Return the gain at size 1."""
        heights = np.maximum(heights + self._deep, 0.5)
        load = float(np.mean((now.speeds / self.hover) ** 2 * np.exp(-self.FADES * heights)))
        self._goal = self.GIVES * load
        return 0.12 * np.exp(-0.7 * heights)

    def after(self, step, rotation, acceleration):
        """Let it swing."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            pull = self.FREQUENCY * (self.FREQUENCY * (self._goal - self._deep)
                                     - 2.0 * self.DAMPING * self._sinks)
            self._sinks += step / count * pull
            self._deep += step / count * self._sinks
