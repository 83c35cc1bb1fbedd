# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Air that moves in one place more than in another, or from some time on."""

import numpy as np

from withheld.forms.air import Wind


class Plume(Wind):
    """
    A steady wind, and warm air that rises in a column beside it.

    The velocity over a source falls off by Gauss's curve (B. R. Morton, G. Taylor, J. S. Turner,
    Proceedings of the Royal Society A 234, 1956).
    """

    def __init__(self, size, params, rng):
        """Draw where the column is, and how wide."""
        super().__init__(size, params, rng)
        self.place, self.width = rng.uniform(-0.6, 0.6, 2), rng.uniform(0.6, 1.0)
        self.rising = np.array([0.0, 0.0, 0.8 * np.linalg.norm(self.mean)])

    def wind(self, time, position):
        """Return the velocity of the air."""
        away = np.sum((position[:2] - self.place) ** 2) / self.width ** 2
        return self.mean + np.exp(-away) * self.rising


class Front(Wind):
    """
    A front that passes once in a flight: the wind freshens and veers within some seconds.

    In time it is the 1 - cosine of MIL-F-8785C, held.
    """

    LASTS, BY, VEERS = 4.0, 0.4, 0.35       # s; of the mean and rad, before and after

    def begin(self, rng):
        """Draw when it comes, s."""
        self.when = rng.uniform(4.0, 12.0)

    def wind(self, time, position):
        """Return the velocity of the air."""
        passed = np.clip((time - self.when) / self.LASTS, 0.0, 1.0)
        side = -np.cos(np.pi * passed)
        c, s = np.cos(self.VEERS * side), np.sin(self.VEERS * side)
        x, y, z = (1.0 + self.BY * side) * self.mean
        return np.array([c * x - s * y, s * x + c * y, z])
