# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A tether that a winch on the ground keeps taut."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Tethered(Influence):
    """
    A light tether that a winch on the ground, far below, keeps taut by the same pull everywhere.

    So it pulls down and, beside the winch, back to above it, and has no inertia. It rubs where it
    leaves the winch, the more, the more it leans: by Euler's law of a rope around a post, the pull
    is more while it is paid out, and less while it is taken in. M. Tognon, A. Franchi, Theory and
    Applications for Control of Aerial Robots in Physical Interaction Through Tethers, 2020.
    """

    beside = ('unknown',)           # what it pulls aside, and by rubbing, is no weight
    DEEP, ASIDE = 5.0, 0.4          # m: of the winch below where heights begin; aside, at most
    RUBS, BENT = 0.3, 0.6           # of friction; rad, by which it is bent where it is upright
    SLOW = 0.05                     # m/s, of the tether, below which it rubs less

    def __init__(self, size, params, rng):
        """Draw where the winch is, and set the mass whose weight it pulls by."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.winch = np.array([*rng.uniform(-self.ASIDE, self.ASIDE, 2), -self.DEEP])

    def wrench(self, now):
        """Return the pull to the winch."""
        away = now.position - self.winch
        along = away / max(float(np.linalg.norm(away)), 1e-3)
        bent = self.BENT + float(np.arccos(np.clip(along[2], -1.0, 1.0)))
        paid = float(np.tanh(along @ now.velocity / self.SLOW))
        pull = self.parameters['mass'] * GRAVITY * np.exp(self.RUBS * bent * paid)
        return -pull * now.rotation.T @ along, np.zeros(3)
