# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertia of a gel, which thins as it is sheared and sets again at rest."""

import numpy as np

from withheld.forms.body import Coupled


class Thixotropic(Coupled):
    """
    A tank of paint or gel, which the walls hold firmly at rest and loosely where it is sheared.

    Shear breaks its structure down, and rest builds it up again in a second or so, so that the
    first turn after a calm takes all of it along. H. A. Barnes, Thixotropy - a review, Journal of
    Non-Newtonian Fluid Mechanics 70, 1997.
    """

    FIRM, LOOSE = 0.02, 0.25        # s, in which it comes along: with all structure, with none
    SETS, BREAKS = 1.0, 0.1         # s; rad, by which a shear takes all but one part in e

    def begin(self, rng):
        """Start at rest, and set."""
        self._turning, self._rate, self._set = np.zeros(3), np.zeros(3), 1.0

    def wrench(self, now):
        """Return the moment of the gel."""
        self._rate = now.rate
        return np.zeros(3), self.loads * self._grips() * (self._turning - now.rate)

    def after(self, step, rotation, acceleration):
        """Let it follow, and let its structure break and build."""
        slips = float(np.linalg.norm(self._turning - self._rate))
        self._turning = self._rate + np.exp(-step * self._grips()) * (self._turning - self._rate)
        both = 1.0 / self.SETS + slips / self.BREAKS
        goal = 1.0 / self.SETS / both
        self._set = goal + np.exp(-step * both) * (self._set - goal)

    def _grips(self):
        """Return how fast it comes along, 1/s."""
        return self._set / self.FIRM + (1.0 - self._set) / self.LOOSE
