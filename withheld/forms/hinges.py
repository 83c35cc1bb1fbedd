# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of propellers whose hinges stick."""

import numpy as np

from withheld.forms.hubs import HubMoment


class Sticking(HubMoment):
    """
    Propellers on worn hinges that stick: their disks lean on once the flow has changed enough.

    So they lean less than they would as the flow grows, and more as it falls. Dry friction: F.
    Al-Bender, J. Swevers, Characterization of friction force dynamics, IEEE Control Systems
    Magazine 28(6), 2008.
    """

    LEANS, STICKS = 1.3, 0.5        # of the moment; m/s, either way

    def begin(self, rng):
        """Start upright."""
        self._leans, self._air = np.zeros(2), np.zeros(2)

    def wrench(self, now):
        """Return the moment of all rotors."""
        self._air = now.air[:2]
        x, y = self.LEANS * self.moment * float(np.mean(now.speeds)) / self.hover * self._leans
        return np.zeros(3), np.array([-y, x, 0.0])

    def after(self, step, rotation, acceleration):
        """Let them lean."""
        off = self._leans - self._air
        far = float(np.linalg.norm(off))
        self._leans = self._air + off * min(1.0, self.STICKS / max(far, 1e-9))
