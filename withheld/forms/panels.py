# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A panel that keeps pointing at its station, and light panels that have to turn the air."""

import numpy as np

from withheld.forms.air import Drag
from withheld.forms.body import Coupled


class Pointing(Drag):
    """
    A body with a flat aerial that keeps pointing at a station, however the body turns.

    Flow onto its face pushes along its normal, flow along it does not: S. F. Hoerner,
    Fluid-Dynamic Drag, 1965, chapter 3, on plates. As aerials that follow their station do in
    practice.
    """

    OWN, FACE = 0.4, 1.2        # of the coefficient: all around; onto the face
    FAR = (1.8, 2.5)            # m, of the station from the middle

    def __init__(self, size, params, rng):
        """Draw where the station is."""
        super().__init__(size, params, rng)
        angle, far = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(*self.FAR)
        self.station = far * np.array([np.cos(angle), np.sin(angle)])

    def law(self, now):
        """Return what the coefficient is of."""
        away = self.station - now.position[:2]
        normal = now.rotation.T @ [*away / max(float(np.linalg.norm(away)), 1e-6), 0.0]
        onto = float(normal @ now.air)
        return self.OWN * np.linalg.norm(now.air) * now.air + self.FACE * abs(onto) * onto * normal


class Panelled(Coupled):
    """
    Large light panels, which have to turn the air around them along and to part it.

    One goes with what the rate changes by, the other with the square of the rate. J. R. Morison,
    M. P. O'Brien, J. W. Johnson, S. A. Schaaf, The force exerted by surface waves on piles,
    Journal of Petroleum Technology 2(5), 1950.
    """

    TIME, PARTS = 0.02, 2.5     # s, in which air is taken along; 1/rad, of the square of the rate

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the air."""
        self._rate = now.rate
        along = (self._turning - now.rate) / self.TIME
        return np.zeros(3), self.loads * (along - self.PARTS * np.abs(now.rate) * now.rate)

    def after(self, step, rotation, acceleration):
        """Take it along."""
        self._turning = self._rate + np.exp(-step / self.TIME) * (self._turning - self._rate)
