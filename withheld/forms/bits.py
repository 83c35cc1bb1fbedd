# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rates in coarse steps."""

import numpy as np

from withheld.influence import Influence


class CutOff(Influence):
    """
    Rates that are cut off to the step below, not rounded, before they are smoothed.

    As a shift of bits does, which rounds towards less, also below zero: so each axis is off by
    half a step on average, by nothing at a step, and by a whole one just below the next. B.
    Widrow, I. Kollar, Quantization Noise, 2008.
    """

    def __init__(self, size, params, rng):
        """Set the step, rad/s."""
        self.step = 2.0 * 0.03 * size / np.sqrt(3.0)
        self.parameters = dict.fromkeys('xyz', -0.5 * self.step)

    def measured(self, time, state, thrust):
        """Return what is left of them."""
        out = state.copy()
        if self.step:
            out[10:] = self.step * np.floor(state[10:] / self.step)
        return out
