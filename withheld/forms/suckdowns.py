# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Ground effect of a wide flat body around its rotors."""

import numpy as np

from withheld.constants import arm_length
from withheld.forms.air import Ground


class SuckedDown(Ground):
    """
    A wide plate around the rotors, as of a closed airframe, which near ground is sucked down.

    What flows off along the ground takes air out from under the plate, by more than the ground
    gives the rotors unless that is close; flight leaves both behind. L. A. Wyatt, Static tests of
    ground effect on planforms fitted with a centrally-located round lifting jet, Aeronautical
    Research Council CP 749, 1964; the rotors by I. C. Cheeseman, W. E. Bennett, The effect of the
    ground on a helicopter rotor in forward flight, ARC R&M 3021, 1955.
    """

    SUCKS, POWER = 0.012, 2.3       # of the thrust; of the height over what the plate is wider by
    BEYOND, LEAST = 2.0, 2.0        # radii: of the plate around hubs; wider than the jet, least
    MOST = 0.2                      # of the thrust: what comes back between rotors limits it

    def __init__(self, size, params, rng):
        """Set by how much the plate is wider than a jet as large as all disks, radii."""
        super().__init__(size, params, rng)
        plate = 2.0 * (arm_length(params) / self.radius + self.BEYOND)
        self.wider = max(plate - 2.0 * np.sqrt(params['num_rotors']), self.LEAST)

    def law(self, heights, now):
        """Return the gain at size 1."""
        square = (now.air[0] ** 2 + now.air[1] ** 2) / self.induced ** 2
        image = (0.25 / heights) ** 2 / (1.0 + square)
        sucks = self.SUCKS * (float(np.mean(heights)) / self.wider) ** -self.POWER
        sucks /= (1.0 + sucks / self.MOST) * (1.0 + square)
        return image / (1.0 - image) - sucks
