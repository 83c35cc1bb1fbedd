# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines over pulleys."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Balanced(Influence):
    """
    A safety line over a pulley, with a counterweight at its other end, as indoors over a stand.

    It takes from the weight what it adds to what has to be moved up and down; the pulley rubs. Its
    trolley runs along above. G. Atwood, A Treatise on the Rectilinear Motion and Rotation of
    Bodies, 1784.
    """

    RUBS, SLOW = 0.06, 0.1      # of the line's pull; m/s, at which most of it rubs

    def __init__(self, size, params, rng):
        """Set the mass that the vehicle seems to lack."""
        self.parameters = {'mass': -0.007 * size * params['mass']}

    def begin(self, rng):
        """Start at rest."""
        self._rises = 0.0

    def wrench(self, now):
        """Return the pull of the line, which is upright."""
        pull = max(GRAVITY - self._rises, 0.0)      # the line is slack beyond
        pull *= 1.0 - self.RUBS * np.tanh(float(now.velocity[2]) / self.SLOW)
        return -self.parameters['mass'] * pull * now.rotation[2], np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Take notice of how the counterweight falls."""
        self._rises = float(acceleration[2])
