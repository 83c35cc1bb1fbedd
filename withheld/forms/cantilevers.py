# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers at the ends of arms that bend up under their thrust."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class BentUp(LoosePropellers):
    """
    Rotors on thin arms that bend up under the thrust, so that axes and momentum lean inwards.

    The end of a beam leans in proportion to its load, and so does the axis with the square of the
    speed: so a change of speed turns the momentum beside changing it, which rolls and pitches the
    body. S. Timoshenko, Strength of Materials, 1955, chapter 5; arms of plastic and of thin tube
    bend as far. What the lean does to the thrust is in the file. Their shafts give a little.
    """

    LEANS, MOST, TIME = 0.1, 3.0, 0.01  # rad, in hover; of it; s, in which propellers follow

    def __init__(self, size, params, rng):
        """Set the ways inwards."""
        super().__init__(size, params, rng)
        inwards = -np.array(list(params['rotor_pos'].values())) * [1.0, 1.0, 0.0]
        self.inwards = inwards / np.linalg.norm(inwards, axis=1)[:, None]

    def wrench(self, now):
        """Return the moment of their momentum, and of its change."""
        super().wrench(now)
        blades, slope = self._blades, self._slope()
        loads = (blades / self.hover) ** 2
        lean, gives = self.LEANS * np.minimum(loads, self.MOST), loads < self.MOST
        leaning = 2.0 * self.LEANS * blades * slope / self.hover ** 2 * gives
        up, sine, cosine = np.array([0.0, 0.0, 1.0]), np.sin(lean)[:, None], np.cos(lean)[:, None]
        axes, across = cosine * up + sine * self.inwards, cosine * self.inwards - sine * up
        momentum = (self.spins * blades) @ axes
        change = (self.spins * slope) @ axes + (self.spins * blades * leaning) @ across
        return np.zeros(3), self.inertia * (change + np.cross(now.rate, momentum))

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        return (self._hubs - self._blades) / self.TIME
