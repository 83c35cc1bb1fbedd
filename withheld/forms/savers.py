# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of propellers that a ring of rubber holds."""

import numpy as np

from withheld.forms.hubs import HubMoment


class Banded(HubMoment):
    """
    Propellers that a ring of rubber holds on their shafts, so that they give way in a crash.

    The ring presses a propeller onto its seat, and it pushes the body as a fixed one does, up to
    the moment at which it rocks on its edge; beyond, the rubber gives way. The thrust lifts it
    off its seat, so that this moment is less at high speed. What is pressed together and gapes:
    Shigley's Mechanical Engineering Design, 2011, chapter 8. As light vehicles for halls have it
    in practice.
    """

    ROCKS, LIFTS = 1.3, 0.6     # m/s, at the speed of hover; of that, by the thrust of hover
    SOFT, LEAST = 0.15, 0.1     # of the moment, beyond; of where it rocks in hover

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the usual one at the speed of hover."""
        usual = np.maximum(turn * across, 1e-9)
        holds = self.ROCKS * np.maximum(1.0 + self.LIFTS * (1.0 - turn ** 2), self.LEAST)
        held = np.minimum(holds / usual, 1.0)
        return turn * (held + self.SOFT * (1.0 - held))
