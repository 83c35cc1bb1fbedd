# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground that is grass, and ground on which crates stand about."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.air import Ground


class Grass(Ground):
    """
    Tall grass, which the wake bends down, so that the ground is further away from strong rotors.

    It takes its time to bend and to rise again. Plants in the wind: J. Finnigan, Turbulence in
    plant canopies, Annual Review of Fluid Mechanics 32, 2000.
    """

    DEEP, TIME = 1.2, 0.4       # radii, by which hover bends it; s

    def __init__(self, size, params, rng):
        """Take the speed of hover."""
        super().__init__(size, params, rng)
        self.hover = hover_speed(params)

    def begin(self, rng):
        """Start with grass as it is in hover."""
        self._bent, self._now = 1.0, 1.0

    def law(self, heights, now):
        """Return the gain at size 1."""
        near = 1.0 / (1.0 + (heights / 2.0) ** 2)       # so far down the wake is still one
        self._now = np.clip(now.speeds / self.hover, 0.2, 1.6) ** 2 * near
        return 0.4 / (0.5 + heights + self.DEEP * self._bent) ** 2

    def after(self, step, rotation, acceleration):
        """Let it bend or rise."""
        self._bent = self._bent + (1.0 - np.exp(-step / self.TIME)) * (self._now - self._bent)


class Crates(Ground):
    """
    A floor on which crates stand about, so that now this and now that rotor is nearer to it.

    As in workshops in practice; each rotor feels what is below it.
    """

    COUNT, AROUND = 24, 1.8     # crates; m to either side
    HIGH = 1.2                  # radii, of the highest

    def __init__(self, size, params, rng):
        """Draw where they stand, how wide they are, m, and how high, radii."""
        super().__init__(size, params, rng)
        self.stand = rng.uniform(-self.AROUND, self.AROUND, (self.COUNT, 2))
        self.wide = rng.uniform(0.15, 0.35, self.COUNT)
        self.high = self.HIGH * rng.uniform(0.4, 1.0, self.COUNT)

    def law(self, heights, now):
        """Return the gain at size 1."""
        places = (now.position + now.places @ now.rotation.T)[:, None, :2]
        away = np.max(np.abs(places - self.stand), axis=2)
        # The wake of a rotor is not on a crate all at once.
        over = 0.5 * (1.0 + np.tanh((self.wide - away) / (0.5 * self.radius)))
        left = np.maximum(heights - np.max(self.high * over, axis=1), 0.5)
        return 0.04 / (1.0 + (left / 1.2) ** 3)
