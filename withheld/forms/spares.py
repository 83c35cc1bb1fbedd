# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers of another pitch, from the drawer."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.body import Fault


class Spare(Fault):
    """
    A spare propeller of less pitch on one motor: it lacks little at rest, and more in a climb.

    At rest the blades of more pitch are near their stall, so that less pitch costs little; the
    thrust falls to nothing at an advance ratio that goes with the pitch. J. B. Brandt, M. S.
    Selig, Propeller performance data at low Reynolds numbers, AIAA 2011-1255. It takes still less
    torque.
    """

    STEEP, MOST = 3.0, 4.0      # of the loss: by the climb over the induced velocity; at most
    TORQUE = 1.5                # of the loss

    def __init__(self, size, params, rng):
        """Set the induced velocity in hover, m/s."""
        super().__init__(size, params, rng)
        self.induced = induced_velocity(params)

    def gain(self, now):
        """Return the factors."""
        climbs = float(now.hubs()[self.rotor, 2]) / self.induced
        return self.losing(now, lambda turn: float(np.clip(
            1.0 + self.STEEP * climbs / turn, 0.0, self.MOST)))

    def torque(self, now):
        """Return the factors."""
        return 1.0 - self.TORQUE * (1.0 - self.gain(now))
