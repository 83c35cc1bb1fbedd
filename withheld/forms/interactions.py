# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of rotors of which those behind fly in the wake of those ahead."""

import numpy as np

from withheld.constants import arm_length, induced_velocity
from withheld.forms.hubs import HubMoment


class Interfering(HubMoment):
    """
    Rotors that lean back, and of which those behind sink in the wake of those ahead.

    That takes from their moment, most at a speed at which the wake leans onto those behind and by
    how the rotors stand; in faster flight it passes below. D. Misiorowski, F. Gandhi, A. A.
    Oberai, Computational study on rotor interactional effects for a quadcopter in edgewise
    flight, AIAA Journal 57(12), 2019.
    """

    LEANS, TAKES, MOST = 1.6, 1.3, 0.35     # of the moment; likewise; of the induced velocity

    def __init__(self, size, params, rng):
        """Set the speed at which the rotors behind sink most, m/s."""
        super().__init__(size, params, rng)
        self.most, self.radius = self.MOST * induced_velocity(params), params['rotor_radius']
        self.arm = arm_length(params)

    def sinking(self, places, onto):
        """Return where the rotors sink that are behind as the body goes onto (2,), in arms."""
        apart = places[None, :, :2] - places[:, None, :2]       # of [this, other]
        ahead = np.maximum(apart @ onto, 0.0)
        beside = apart @ np.array([-onto[1], onto[0]])
        sinks = np.sum(ahead / (ahead + self.radius) * np.exp(-(beside / self.radius) ** 2),
                       axis=1)
        return 2.0 / len(places) * sinks @ places[:, :2] / self.arm

    def wrench(self, now):
        """Return the moment of all rotors."""
        air = now.air[:2]
        fast = float(np.linalg.norm(air))
        share = fast / self.most
        takes = self.TAKES * self.most * 2.0 * share / (1.0 + share ** 2)
        x, y = self.LEANS * air + takes * self.sinking(now.places, air / max(fast, 1e-9))
        turn = float(np.mean(now.speeds)) / self.hover
        return np.zeros(3), self.moment * turn * np.array([-y, x, 0.0])
