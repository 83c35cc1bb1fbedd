# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed controllers that nobody has calibrated."""

import numpy as np

from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.influence import Influence


class Uncalibrated(Influence):
    """
    Speed controllers whose dead zone is not as the autopilot has it, nor the same for all.

    Full throttle is full throttle; from there the speed falls in a straight line, but to another
    end, so that thrust is off by the more, the slower a rotor turns. As documentation of ArduPilot
    and PX4 describes what the calibration of such controllers is for.
    """

    beside = ('com_offset',)
    ZONE, APART = 0.012, 0.2        # of the hover speed; of that, by which they differ at most
    LEAST, SLOWEST = 1.3, 0.3       # of the hover speed: of full throttle; where it is no more

    def __init__(self, size, params, rng):
        """Draw the ends."""
        self.hover = hover_speed(params)
        self.full = max(params['rotor_speed_max'] / self.hover, self.LEAST)
        count = params['num_rotors']
        self.zones = self.ZONE * size * float(signs(rng, 1)[0]) * (
            1.0 + self.APART * rng.uniform(-1.0, 1.0, count))
        self.parameters = {'zone': float(np.mean(self.zones))}

    def gain(self, now):
        """Return the factors."""
        turn = np.clip(now.speeds / self.hover, self.SLOWEST, self.full)
        true = np.maximum(turn - self.zones, 0.0) * self.full / (self.full - self.zones)
        return (true / turn) ** 2
