# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers whose blades swing behind their hubs, and propellers whose axes lean."""

import numpy as np

from withheld.forms.body import signs
from withheld.forms.clutches import LoosePropellers, PartlyLoosePropellers


class Swinging(PartlyLoosePropellers):
    """
    Folding propellers, whose blades swing to and fro on upright hinges close to the axis.

    What pulls them straight goes with the square of the speed, and so does their drag: they lag
    by the same angle at all speeds, and swing about it, the faster, the faster they turn. W.
    Johnson, Helicopter Theory, 1980, chapter 12; damped by the friction of their hinges.
    """

    OWN = 0.3                                       # of the inertia, of bell and hub
    FREQUENCY, DAMPING = 2.0 * np.pi * 8.0, 0.2     # rad/s, at hover's speed; of the critical one

    def begin(self, rng):
        """Start with blades at rest on their hinges."""
        super().begin(rng)
        self._lag = 0.0

    def _follow(self, step):
        super()._follow(step)
        self._lag = self._lag + step * (self._hubs - self._blades)

    def _slope(self):
        """Return the slopes (n,) of the speeds of the blades, rad/s^2."""
        rate = self.FREQUENCY * self._blades / self.hover
        return rate * (rate * self._lag + 2.0 * self.DAMPING * (self._hubs - self._blades))


class Leaning(LoosePropellers):
    """
    Rotors that lean outwards or inwards, as on arms that go up: their momentum leans as well.

    So a change of their speeds turns the body about all axes, and a turn about the vertical takes
    a moment, too, where they are not equally fast. H. Goldstein, Classical Mechanics, 1980,
    chapter 5. What the lean does to the thrust is in the file. Their shafts give a little.
    """

    LEANS, TIME = 0.2, 0.01     # rad; s, in which the propellers follow

    def __init__(self, size, params, rng):
        """Draw whereto they lean."""
        super().__init__(size, params, rng)
        out = np.array(list(params['rotor_pos'].values())) * [1.0, 1.0, 0.0]
        out /= np.linalg.norm(out, axis=1)[:, None]
        lean = self.LEANS * signs(rng, 1)[0]
        self.axes = np.sin(lean) * out + np.cos(lean) * np.array([0.0, 0.0, 1.0])

    def wrench(self, now):
        """Return the moment of their momentum, and of its change."""
        super().wrench(now)
        momentum, change = ((self.spins * one) @ self.axes for one in (
            self._blades, self._slope()))
        return np.zeros(3), self.inertia * (change + np.cross(now.rate, momentum))

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        return (self._hubs - self._blades) / self.TIME
