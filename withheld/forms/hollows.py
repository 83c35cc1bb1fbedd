# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Loose snow that is blown away, and air that goes up between rotors now here and now there."""

import numpy as np

from withheld.forms.air import Ground


class Scoured(Ground):
    """
    Loose snow, in which low flight leaves hollows: there the ground is further away from then on.

    B. Johnson, J. G. Leishman, A. Sydney, Investigation of sediment entrainment using dual-phase,
    high-speed particle image velocimetry, Journal of the American Helicopter Society 55(4), 2010.
    """

    DEEPEST, TIME = 2.5, 1.2            # radii; s, in which it is half gone close to the ground
    FADES, CELL, CELLS = 0.4, 0.3, 40   # of the height in radii; m; as many cells either way

    def begin(self, rng):
        """Start with snow that nobody has flown over."""
        self._depths = np.zeros((self.CELLS, self.CELLS))
        self._near, self._blows = self._corners(np.zeros(2)), 0.0

    def law(self, heights, now):
        """Return the gain at size 1."""
        self._near = self._corners(now.position[:2])
        rows, columns, shares = self._near
        heights = heights + float(shares @ self._depths[rows, columns])
        self._blows = float(np.exp(-self.FADES * np.mean(heights)))
        return 0.12 * np.exp(-0.7 * heights)

    def after(self, step, rotation, acceleration):
        """Blow it away."""
        rows, columns, shares = self._near
        goes = (1.0 - np.exp(-step * self._blows / self.TIME)) * shares
        self._depths[rows, columns] += goes * (self.DEEPEST - self._depths[rows, columns])

    def _corners(self, place):
        """Return rows (4,), columns (4,) of the cells around a place, and their shares (4,)."""
        at = np.clip(place / self.CELL + 0.5 * self.CELLS, 0.0, self.CELLS - 1.001)
        row, column = at.astype(int)
        x, y = at - (row, column)
        return (row + np.array([0, 0, 1, 1]), column + np.array([0, 1, 0, 1]),
                np.array([(1 - x) * (1 - y), (1 - x) * y, x * (1 - y), x * y]))


class Switching(Ground):
    """
    Ground from which air goes up between the rotors and into those of one side, now of the other.

    These lose what the others gain; in flight it is left behind. H. N. J. Dekker, D. Ragni, W. J.
    Baars, F. Scarano, M. Tuinstra, Aerodynamic interactions of side-by-side rotors in ground
    proximity, AIAA Journal 60(7), 2022.
    """

    STAYS, TURNS, COUNT = 0.9, 0.1, 400     # s on average; s; far more changes than a flight has
    DEPTH, SWEPT = 0.7, 0.4                 # of the gain; of the induced velocity, half of it

    def __init__(self, size, params, rng):
        """Draw which sides these are."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([np.cos(angle), np.sin(angle)])

    def begin(self, rng):
        """Draw when it changes over, s."""
        self.times = np.cumsum(rng.exponential(self.STAYS, self.COUNT))
        self._side, self._time = 0.0, 0.0

    def law(self, heights, now):
        """Return the gain at size 1."""
        self._time = now.time
        places = now.places[:, :2] @ self.onto
        sides = places / np.max(np.abs(places))
        calm = 1.0 / (1.0 + (now.air[0] ** 2 + now.air[1] ** 2) / (
            self.SWEPT * self.induced) ** 2)
        return 0.12 * np.exp(-0.8 * heights) * (1.0 + self.DEPTH * calm * self._side * sides)

    def after(self, step, rotation, acceleration):
        """Let it change over."""
        goal = (-1.0, 1.0)[int(np.searchsorted(self.times, self._time)) % 2]
        self._side += (1.0 - np.exp(-step / self.TURNS)) * (goal - self._side)
