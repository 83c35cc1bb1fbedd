# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that differ between front and back."""

import numpy as np

from withheld.forms.body import signs
from withheld.forms.clutches import LoosePropellers


class Unmatched(LoosePropellers):
    """
    Propellers of three blades in front and of two behind, or the other way around.

    Both give the thrust of the file, but those of three blades have more inertia, so that the
    reactions of the two no longer cancel as the body rolls: a roll turns the heading, too. The
    inertia goes with the number of blades, and is measured on two strings: J. P. Den Hartog,
    Mechanics, 1948. Their shafts give a little.
    """

    MORE, TIME = 0.4, 0.01      # of the inertia, either way; s, in which the propellers follow

    def __init__(self, size, params, rng):
        """Draw which are heavier."""
        super().__init__(size, params, rng)
        ahead = np.array(list(params['rotor_pos'].values()))[:, 0]
        ahead = np.round(ahead / np.abs(ahead).max(), 6)
        self.spins = self.spins * (1.0 + self.MORE * signs(rng, 1)[0] * np.sign(ahead))

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        return (self._hubs - self._blades) / self.TIME
