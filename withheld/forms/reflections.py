# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude from satellites, whose signals the ground reflects."""

import numpy as np

from withheld.forms.body import Tilt


class Reflected(Tilt):
    """
    Pitch and heading from two aerials for satellites, whose signals the ground sends up as well.

    What comes from the ground adds to each signal or takes from it, in turn as the height changes
    by half a wave over the sine of the satellite's elevation. Roll is of other sensors. Y.
    Georgiadou, A. Kleusberg, On carrier signal multipath effects in relative GPS positioning,
    Manuscripta Geodaetica 13, 1988.
    """

    WAVE, COUNT = 0.1903, 3             # m, of the carrier; satellites
    LOW, SWING = (0.15, 0.5), 0.35      # rad, their elevations; of the mean tilt, of each

    def begin(self, rng):
        """Draw where the satellites are, and their phases for heading and pitch."""
        elevations = rng.uniform(*self.LOW, self.COUNT)
        self.waves = 4.0 * np.pi * np.sin(elevations) / self.WAVE       # rad per m
        self.phases = rng.uniform(0.0, 2.0 * np.pi, (2, self.COUNT))

    def measured(self, time, state, thrust):
        """Return what is said."""
        swings = self.SWING * np.sin(self.waves * state[2] + self.phases).sum(axis=1)
        return self.tilted(state, 1.0 + np.array([*swings, 0.0]))[0]
