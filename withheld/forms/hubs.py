# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Hubs that slip beyond a torque, moments of hubs, and hubs that bump against their stops."""

import numpy as np

from withheld.constants import arm_length, hover_speed
from withheld.forms.clutches import LoosePropellers
from withheld.influence import Influence


class SlipperClutch(LoosePropellers):
    """
    Propellers behind a clutch that slips beyond a torque, of which their drag takes most already.

    So they speed up slowly and are slowed down fast. Clutches of that kind: Shigley's Mechanical
    Engineering Design, 2011, chapter 16; on propellers they save the gear in practice.
    """

    TIME, SLOWS = 0.015, 1.5        # s, below the limit; 1/s, of the drag at the speed of hover
    HOLDS = 1.3                     # of the torque in hover

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        drag = np.minimum((self._blades / self.hover) ** 2, self.HOLDS)
        least, most = (self.SLOWS * self.hover * (side * self.HOLDS - drag)
                       for side in (-1.0, 1.0))
        return np.clip((self._hubs - self._blades) / self.TIME, least, most)


class HubMoment(Influence):
    """Moment of rotors that lean back in the wind, each by the velocity across it."""

    def __init__(self, size, params, rng):
        """Set the moment per velocity."""
        self.moment = 0.002 * size * params['mass'] * arm_length(params)
        self.parameters = {'coefficient': self.moment}
        self.hover = hover_speed(params)

    def wrench(self, now):
        """Return the moment of all rotors."""
        turn, hubs = np.maximum(now.speeds / self.hover, 0.2), now.hubs()
        across = np.hypot(hubs[:, 0], hubs[:, 1])
        share = self.moment / len(turn) * self.per_velocity(across, turn)
        return np.zeros(3), np.array([-share @ hubs[:, 1], share @ hubs[:, 0], 0.0])


class Bumping(HubMoment):
    """
    Propellers on hinges with stops: their disks tilt freely at first, and then bump and push.

    Hardly a moment below a speed, and a steep one beyond it, for each rotor: that stops are met in
    fast flight is in R. W. Prouty, Helicopter Performance, Stability, and Control, 1986.
    """

    FREE, SOFT = 1.2, 0.1       # m/s, at the speed of hover; of the moment, without a bump
    STEEP = 2.2                 # of the moment, beyond

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the usual one at the speed of hover."""
        # The tilt goes with the velocity over that of the blades.
        beyond = np.maximum(1.0 - self.FREE * turn / np.maximum(across, 1e-9), 0.0)
        return turn * (self.SOFT + self.STEEP * beyond)
