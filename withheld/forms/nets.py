# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a net that hangs below."""

import numpy as np

from withheld.forms.air import Drag


class Netted(Drag):
    """
    A body with a net below it for catching others: the faster it flies, the more the net leans.

    Then it lets the flow by, and lifts. A bar pulls it down, so that it leans where its weight
    and what presses across it are even; flow along it does nearly nothing. G. Loeland, Current
    forces on, and water flow through and around, floating fish farms, Aquaculture International
    1, 1993, on nets at an angle. As vehicles that hunt others have it in practice. That it weighs
    is in the file, and it hangs from the middle, so that it does not turn the body.
    """

    OWN, NET, ALONG = 0.4, 1.4, 0.1     # of the coefficient: the body; across the net; along it
    EVEN = 3.0                          # m/s, at which it drags by its weight, upright

    def __init__(self, size, params, rng):
        """Draw which way the net looks."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, np.pi)
        self.looks = np.array([np.cos(angle), np.sin(angle), 0.0])

    def leans(self, through):
        """Return the sine of its lean in a level flow: sin over cos^2 as the flow presses."""
        press = (through / self.EVEN) ** 2
        return 2.0 * press / (1.0 + np.sqrt(1.0 + 4.0 * press ** 2)) * np.sign(through)

    def law(self, now):
        """Return what the coefficient is of."""
        up = now.rotation[2]
        level = self.looks - (self.looks @ up) * up
        level = level / np.linalg.norm(level)
        sine = self.leans(float(level @ now.air))
        normal = np.sqrt(1.0 - sine ** 2) * level - sine * up
        across = float(normal @ now.air)
        along = now.air - across * normal
        return (self.OWN * np.linalg.norm(now.air) * now.air + self.NET * abs(across) * across
                * normal + self.ALONG * np.linalg.norm(along) * along)
