# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of two pods of which one flies in the wake of the other, and of a radiator with flaps."""

import numpy as np

from withheld.forms.air import Drag


class Tandem(Drag):
    """
    Two blunt pods beside each other, of which the rear one saves its drag in the front one's wake.

    So drag is least along the line from one to the other, either way. S. F. Hoerner, Fluid-Dynamic
    Drag, 1965, chapter 8, on disks in tandem. What turns the body is left out: they are near it.
    """

    ONE, SAVES = 0.7, 0.9       # of the coefficient, of each; of the rear one's drag, at most
    APART, WIDE = 2.0, 0.9      # widths of a pod: from one to the other; of the wake, there

    def __init__(self, size, params, rng):
        """Draw the line on which they are, close to level."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        line = np.array([np.cos(angle), np.sin(angle), rng.uniform(-0.2, 0.2)])
        self.line = line / np.linalg.norm(line)

    def law(self, now):
        """Return what the coefficient is of."""
        speed = float(np.linalg.norm(now.air))
        along = float(self.line @ now.air) / max(speed, 1e-9)
        aside = self.APART * np.sqrt(max(1.0 - along ** 2, 0.0))
        saved = self.SAVES * np.exp(-(aside / self.WIDE) ** 2)
        return self.ONE * (2.0 - saved) * speed * now.air


class Radiating(Drag):
    """
    A body with an engine whose radiator looks ahead, behind flaps that a thermostat opens.

    They open as it has become hot and shut as it has become cold, by what the rotors take; open,
    the air that goes through drags. S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 9, on the
    drag of cooling.
    """

    OWN, OPEN = 0.6, 1.3            # of the coefficient: all around; more ahead, behind open flaps
    OPENS, SHUTS = 1.1, 0.9         # of the heat that it has
    COOLS, HEATS = (0.7, 1.4), 4.0  # of the load in hover, shut and open; s
    MOVES = 0.3                     # s, of the flaps

    def begin(self, rng):
        """Draw how warm it is at first."""
        self._heat, self._opens = rng.uniform(self.SHUTS, self.OPENS), bool(rng.integers(2))
        self._flaps, self._load = float(self._opens), 1.0

    def law(self, now):
        """Return what the coefficient is of."""
        self._load = float(np.mean((now.speeds / self.hover) ** 3))
        ahead = np.array([abs(now.air[0]) * now.air[0], 0.0, 0.0])
        return (self.OWN * np.linalg.norm(now.air) * now.air
                + self.OPEN * self._flaps * ahead)

    def after(self, step, rotation, acceleration):
        """Let it heat and cool, and the flaps move."""
        cools = self.COOLS[int(self._opens)]
        self._heat += (1.0 - np.exp(-cools * step / self.HEATS)) * (
            min(self._load, 3.0) / cools - self._heat)
        self._opens = self._heat > (self.SHUTS if self._opens else self.OPENS)
        self._flaps += (1.0 - np.exp(-step / self.MOVES)) * (self._opens - self._flaps)
