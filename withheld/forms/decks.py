# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A deck that heaves and rolls below, and ground that is felt by one rotor or by all."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Ground


class Deck(Ground):
    """
    The deck of a ship, which heaves and rolls below: as it comes up, it presses air to the rotors.

    As vehicles land on boats in practice, with the periods of small ones; what a floor presses out
    as it comes nearer is the squeeze film of surfaces.py.
    """

    HEAVES, ROLLS = 0.7, 0.08       # radii; rad
    PERIODS = np.array([5.3, 7.1])  # s: of heave, of roll
    PRESSES = 0.5                   # of the gain, for a radius in a second

    def __init__(self, size, params, rng):
        """Draw about which direction it rolls."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.across = np.array([np.cos(angle), np.sin(angle), 0.0])

    def begin(self, rng):
        """Draw the phases."""
        self.phases = rng.uniform(0.0, 2.0 * np.pi, 2)

    def law(self, heights, now):
        """Return the gain at size 1."""
        rates = 2.0 * np.pi / self.PERIODS
        angles = rates * now.time + self.phases
        places = (now.rotation @ now.places.T).T @ self.across / self.radius
        sizes = np.column_stack([np.full(len(places), self.HEAVES), self.ROLLS * places])
        gap = np.maximum(heights - sizes @ np.sin(angles), 0.4)
        rises = sizes @ (rates * np.cos(angles))
        return 0.16 * np.exp(-0.8 * gap) * (1.0 + self.PRESSES * np.clip(rises, -1.5, 1.5))


class Merging(Ground):
    """
    Ground that each rotor feels by itself when it is near, and all as a large one when it is not.

    For their wakes merge on the way down, and level flight sweeps them aside by as much as they
    are on their way: A. Matus-Vargas, G. Rodriguez-Gomez, J. Martinez-Carranza, Ground effect on
    rotorcraft unmanned aerial vehicles: a review, Intelligent Service Robotics 14, 2021.
    """

    OWN, ALL, MERGE = 0.08, 0.04, 1.5       # of the thrust, each; radii, on the way down

    def __init__(self, size, params, rng):
        """Take how large the large rotor is, radii."""
        super().__init__(size, params, rng)
        self.reach = 1.0 + arm_length(params) / self.radius

    def law(self, heights, now):
        """Return the gain at size 1."""
        forward = float(np.hypot(now.air[0], now.air[1])) / self.induced
        merged = 1.0 - np.exp(-(heights / self.MERGE) ** 2)
        return (self.OWN * self._felt(heights, forward)
                + self.ALL * merged * self._felt(np.mean(heights) / self.reach, forward))

    def _felt(self, height, forward):
        # The wake has gone aside by height times forward when it meets the ground.
        return np.exp(-0.5 * height ** 2) / (1.0 + (height * forward) ** 2)
