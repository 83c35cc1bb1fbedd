# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag that takes its time, goes with the arms, or folds away."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.air import Drag


class Trailing(Drag):
    """
    In-plane force of rotors, most of which comes of their wake and waits until that is skewed.

    A wake answers a change of the velocity within some radii of its own way (D. M. Pitt, D. A.
    Peters, Theoretical prediction of dynamic-inflow derivatives, Vertica 5, 1981).
    """

    SHARE, RADII = 0.6, 10.0        # what waits; of the wake's way until it has answered

    def __init__(self, size, params, rng):
        """Set the time that it takes, s, in hover."""
        super().__init__(size, params, rng)
        self.time = self.RADII * params['rotor_radius'] / induced_velocity(params)

    def begin(self, rng):
        """Start with a wake that has answered."""
        self._slow, self._now = None, np.zeros(3)

    def law(self, now):
        """Return what the coefficient is of."""
        self._now = np.array([now.air[0], now.air[1], 0.0])
        slow = self._now if self._slow is None else self._slow
        turn = float(np.mean(now.speeds)) / self.hover
        return turn * ((1.0 - self.SHARE) * self._now + self.SHARE * slow)

    def after(self, step, rotation, acceleration):
        """Let the wake follow."""
        slow = self._now if self._slow is None else self._slow
        self._slow = slow + (1.0 - np.exp(-step / self.time)) * (self._now - slow)


class Arms(Drag):
    """
    Drag of round arms, which feel of the air only what flows across them.

    The cross-flow principle: S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 3. Arms reach from
    the centre to the rotors.
    """

    def __init__(self, size, params, rng):
        """Take the directions (n, 3) of the arms."""
        super().__init__(size, params, rng)
        places = np.array(list(params['rotor_pos'].values())) * [1.0, 1.0, 0.0]
        self.arms = places / np.linalg.norm(places, axis=1, keepdims=True)

    def law(self, now):
        """Return what the coefficient is of."""
        across = now.air - (self.arms @ now.air)[:, None] * self.arms
        return 1.6 * np.mean(np.linalg.norm(across, axis=1, keepdims=True) * across, axis=0)


class Retracting(Drag):
    """
    A body whose landing gear is retracted on the way and takes a good half of the drag with it.

    Gears are much of the drag of a body that is smooth otherwise (S. F. Hoerner, Fluid-Dynamic
    Drag, 1965, chapter 13). What the legs move of the mass is little.
    """

    LASTS, BEFORE, AFTER = 3.0, 1.4, 0.6        # s; of the mean drag

    def begin(self, rng):
        """Draw when it begins, s."""
        self.when = rng.uniform(4.0, 12.0)

    def law(self, now):
        """Return what the coefficient is of."""
        done = np.clip((now.time - self.when) / self.LASTS, 0.0, 1.0)
        share = self.BEFORE + (self.AFTER - self.BEFORE) * done
        speed = np.linalg.norm(now.air)
        return share * speed * now.air * [1.0, 1.0, 1.2]
