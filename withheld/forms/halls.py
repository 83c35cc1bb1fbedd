# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust in a hall with warm air above cold air."""

import numpy as np

from withheld.influence import Influence


class Stratified(Influence):
    """
    A hall with warm air below its roof, which is thinner, and cold air that sways below.

    Thrust goes with the density. J. S. Turner, Buoyancy Effects in Fluids, 1973, on how such
    layers lie and sway.
    """

    BELOW, ABOVE = 0.4, 1.6         # of the mean loss
    HEIGHT, DEEP = 0.9, 0.3         # m, each: where the one ends, within how much
    SWAYS, PERIOD = 0.3, 7.0        # m, at the walls; s
    WIDE = 6.0                      # m, of the hall

    def __init__(self, size, params, rng):
        """Set the mean loss, and draw which way it sways."""
        self.share = -0.007 * size
        self.parameters = {'share': self.share}
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.onto = np.array([np.cos(angle), np.sin(angle)])
        self.off = rng.uniform(-1.0, 1.0)

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def gain(self, now):
        """Return the factors."""
        # Half a wave stands between the walls.
        place = np.sin(np.pi * (now.position[:2] @ self.onto - self.off) / self.WIDE)
        sway = self.SWAYS * place * np.cos(2.0 * np.pi * now.time / self.PERIOD + self.phase)
        above = 0.5 * (1.0 + np.tanh((now.heights - self.HEIGHT - sway) / self.DEEP))
        return 1.0 + self.share * (self.BELOW + (self.ABOVE - self.BELOW) * above)
