# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground that is the roof of a house."""

import numpy as np

from withheld.forms.air import Ground


class Gabled(Ground):
    """
    A roof with a ridge, above which a vehicle looks for loose tiles: it falls off to both sides.

    Each rotor feels where its wake meets the roof, which flight leaves behind: further down, or up
    by the ridge. There the wake is split, and little of it is stopped. As roofs are inspected in
    practice; each rotor by itself and by the height as of P. J. Sanchez-Cuevas, G. Heredia, A.
    Ollero, Characterization of the aerodynamic ground effect and its influence in multirotor
    control, International Journal of Aerospace Engineering 2017.
    """

    GAINS, FADES = 0.14, 0.6        # of the thrust; per radius
    PITCH = np.deg2rad(30.0)
    TRAILS, STEEPEST = 0.5, 1.5     # of the flow, over the induced velocity; of the wake
    SPLITS, ASIDE = 0.6, 0.3        # of the gain, on the ridge; m: of the ridge from the middle

    def __init__(self, size, params, rng):
        """Draw where the ridge is, and which way it goes."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.across = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.ridge = rng.uniform(-self.ASIDE, self.ASIDE)

    def law(self, heights, now):
        """Return the gain at size 1."""
        places = now.position + now.places @ now.rotation.T
        flow = float(now.rotation @ now.air @ self.across) / self.induced
        trails = heights * np.clip(self.TRAILS * flow, -self.STEEPEST, self.STEEPEST)
        away = (places @ self.across - self.ridge) / self.radius - trails
        # A disk over the ridge has the mean of both sides below it.
        falls = np.tan(self.PITCH) * (np.sqrt(away ** 2 + 0.25) - 0.5)
        split = 1.0 - self.SPLITS * np.exp(-away ** 2)
        return self.GAINS * split * np.exp(
            -self.FADES * (heights + falls) * np.cos(self.PITCH))
