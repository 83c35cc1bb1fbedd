# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a hose that hangs down, and of a scanner that spins."""

import numpy as np

from withheld.forms.air import Drag


class Hose(Drag):
    """
    A body with a hose to the ground, of which there is the more in the air, the higher it flies.

    Drag of cylinders across the flow: S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 3. The
    hose is light.
    """

    OWN, HOSE, LENGTH = 0.3, 0.8, 4.0       # of the coefficient: the body, a m of hose; m

    def law(self, now):
        """Return what the coefficient is of."""
        hangs = float(np.clip(np.mean(now.heights), 0.0, self.LENGTH))
        across = now.air - now.rotation[2] @ now.air * now.rotation[2]
        return (self.OWN * np.linalg.norm(now.air) * now.air
                + self.HOSE * hangs * np.linalg.norm(across) * across)


class Spinning(Drag):
    """
    A body with a scanner that spins in the flow, which pushes it across its way.

    The force of Magnus goes with the speed and the spin, beside a drag with the square: S. F.
    Hoerner, H. V. Borst, Fluid-Dynamic Lift, 1985, on cylinders that turn.
    """

    beside = ('unknown',)       # a push across is no drag
    SPIN = 0.7                  # m/s, at which drag and push would be equal

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, _ = now.air
        return np.linalg.norm(now.air) * now.air + self.SPIN * np.array([-y, x, 0.0])
