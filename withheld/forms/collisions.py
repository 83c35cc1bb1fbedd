# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground on which the wakes of neighbouring rotors collide."""

import numpy as np

from withheld.forms.air import Ground


class Colliding(Ground):
    """
    Wakes that collide on the ground between rotors and go up there, nearer to the weaker rotor.

    This takes them in, and loses the more, the stronger its neighbours are: near ground the turn
    of the body by its thrust is more than elsewhere. Where jets along a wall have the same
    momentum, which falls by the way, they collide: D. R. Kotansky, L. W. Glaze, The effects of
    ground wall-jet characteristics on fountain upwash flow formation and development, ONR Report
    CR212-216-1F, 1980.
    """

    GAINS, FADES = 0.2, 0.7         # of the thrust; per radius: what the ground gives
    TAKES, RISES = 0.07, 0.35       # of the thrust; per radius: what comes up takes
    NEAR = 5.0                      # of the logarithm of that, by the way over the distance
    LEAST = 0.2                     # of the thrust
    BESIDE = 1.2                    # of the least distance: neighbours

    def __init__(self, size, params, rng):
        """Take the neighbours of each."""
        super().__init__(size, params, rng)
        level = np.array(list(params['rotor_pos'].values()))[:, :2]
        away = np.linalg.norm(level[:, None] - level[None], axis=2)
        np.fill_diagonal(away, np.inf)
        beside = away < self.BESIDE * np.min(away, axis=1, keepdims=True)
        self.beside_each = beside / np.sum(beside, axis=1, keepdims=True)

    def meets(self, speeds):
        """Return where wakes collide (n, n): the way from the first over the distance."""
        jets = np.maximum(speeds, 1.0) ** 2
        return jets[:, None] / (jets[:, None] + jets[None])

    def gain(self, now):
        """Return the factors, of which none turns the thrust about."""
        return np.maximum(super().gain(now), self.LEAST)

    def law(self, heights, now):
        """Return the gain at size 1."""
        square = (now.air[0] ** 2 + now.air[1] ** 2) / self.induced ** 2
        comes = np.exp(self.NEAR * (0.5 - self.meets(now.speeds)))
        taken = np.sum(self.beside_each * comes, axis=1) * np.exp(-self.RISES * np.mean(heights))
        return (self.GAINS * np.exp(-self.FADES * heights) - self.TAKES * taken) / (1.0 + square)
