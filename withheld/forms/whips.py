# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of soft aerials on a body."""

import numpy as np

from withheld.forms.air import Drag


class BendingAerials(Drag):
    """
    A body with soft aerials, upward and downward, which level flow bends: the faster, the more.

    What stands out falls as the velocity to the power -2/3 once they bend, so that their drag
    grows with the power 4/3: S. Alben, M. Shelley, J. Zhang, Drag reduction through self-similar
    bending of a flexible body, Nature 420, 2002. A climb flows along them; the rest of the body
    has the square. As many are above the centre as below, so that they do not turn the body.
    """

    beside = ('rotor_drag',)
    AERIALS, BODY = 0.9, 0.3        # of the coefficient
    BENDS = 1.5                     # m/s, from which on they bend

    def law(self, now):
        """Return what the coefficient is of."""
        level = now.air * [1.0, 1.0, 0.0]
        fast = float(np.linalg.norm(level))
        stands = (1.0 + (fast / self.BENDS) ** 2) ** (-1.0 / 3.0)
        return (self.AERIALS * stands * fast * level
                + self.BODY * np.linalg.norm(now.air) * now.air)
