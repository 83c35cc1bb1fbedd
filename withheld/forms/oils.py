# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that oil takes along."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class Oiled(LoosePropellers):
    """
    Propellers behind a coupling of plates in silicone oil, which always slips a little.

    The oil is thinner where it is sheared faster, so that the torque grows less than the slip: R.
    B. Bird, R. C. Armstrong, O. Hassager, Dynamics of Polymeric Liquids, 1987. As such couplings
    keep the beat of an engine from its propeller in practice.
    """

    SLOWS = 1.5                 # 1/s, of the drag at the speed of hover
    SLIP, THINS = 0.06, 0.7     # of the speed, in hover; power of the slip

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        slip = (self._hubs - self._blades) / (self.SLIP * self.hover)
        torque = np.sign(slip) * np.abs(slip) ** self.THINS
        return self.SLOWS * self.hover * (torque - (self._blades / self.hover) ** 2)
