# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Water with waves below, and a wake that a lean sends aside."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.forms.air import Ground


class Waves(Ground):
    """
    Water with waves, whose crests come nearer to the rotors than their troughs.

    Waves on deep water, which run as fast as their length lets them: H. Lamb, Hydrodynamics, 1932,
    chapter 9.
    """

    HIGH, LENGTH = 0.1, 1.6         # m, from the middle to a crest; m

    def __init__(self, size, params, rng):
        """Draw which way they run."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.number = 2.0 * np.pi / self.LENGTH
        self.runs = self.number * np.array([np.cos(angle), np.sin(angle), 0.0])

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def law(self, heights, now):
        """Return the gain at size 1."""
        places = now.position + now.places @ now.rotation.T
        rises = self.HIGH / self.radius * np.sin(
            places @ self.runs - np.sqrt(GRAVITY * self.number) * now.time + self.phase)
        return 0.4 / (1.0 + np.maximum(heights - rises, 0.5)) ** 2


class Leaning(Ground):
    """
    A cushion of air that is lost as the vehicle leans, since its wake meets the ground aside.

    That less of it comes back to rotors that are not level with the ground: J. Milluzzo, A.
    Martinez, S. Drayton, S. Davids, Experimental investigation of rotors hovering above inclined
    surfaces, Journal of the American Helicopter Society 66(3), 2021.
    """

    LEANS = 0.25        # rad, by which two thirds are lost

    def law(self, heights, now):
        """Return the gain at size 1."""
        lean = now.rotation[2, 0] ** 2 + now.rotation[2, 1] ** 2
        return 0.4 * np.exp(-lean / self.LEANS ** 2) / (0.6 + heights) ** 1.4
