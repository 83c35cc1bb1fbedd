# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground over which vortices pass, and a cushion that is blown back."""

import numpy as np

from withheld.forms.air import Ground
from withheld.forms.radios import wandering


class Restless(Ground):
    """
    Ground over which vortices stay and pair: each rotor has now more of it and now less.

    Flight sweeps them away, so that it is steady then. T. E. Lee, J. G. Leishman, M. Ramasamy,
    Fluid dynamics of interacting blade tip vortices with a ground plane, Journal of the American
    Helicopter Society 55(2), 2010.
    """

    TIME, DEPTH, MOST = 0.4, 0.7, 4.0       # s; of the logarithm of the gain; of its mean
    SWEPT = 0.5                             # of the induced velocity: half of it is steady
    EVERY, COUNT = 0.02, 6000               # s; far more steps than a flight has

    def __init__(self, size, params, rng):
        """Take how many rotors there are."""
        super().__init__(size, params, rng)
        self.count = params['num_rotors']

    def begin(self, rng):
        """Draw how it wanders, below each rotor."""
        self.levels = np.column_stack([
            wandering(rng, self.TIME / self.EVERY, self.DEPTH, self.MOST, self.COUNT)
            for _ in range(self.count)])

    def law(self, heights, now):
        """Return the gain at size 1."""
        level = self.levels[min(int(now.time / self.EVERY), self.COUNT - 1)]
        square = (now.air[0] ** 2 + now.air[1] ** 2) / (self.SWEPT * self.induced) ** 2
        return 0.14 * np.exp(-0.9 * heights) * (1.0 + (level - 1.0) / (1.0 + square))


class BlownBack(Ground):
    """
    One cushion below all rotors, which flight leaves behind: rotors at the back have more of it.

    It stays behind by what is flown while the wake goes down, and in fast flight it is gone. As
    dust below vehicles shows in practice.
    """

    beside = ('blade_flapping',)
    WIDE = 2.2          # radii, of the cushion, by Gauss's curve

    def law(self, heights, now):
        """Return the gain at size 1."""
        places = now.places[:, :2] / self.radius
        behind = -np.mean(heights) * now.air[:2] / self.induced
        away = np.sum((places - behind) ** 2, axis=1) - np.sum(places ** 2, axis=1)
        return 0.12 * np.exp(-0.8 * heights - 0.5 * away / self.WIDE ** 2)
