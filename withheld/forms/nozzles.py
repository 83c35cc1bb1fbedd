# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fans deep in ducts, which blow through nozzles."""

import numpy as np

from withheld.forms.air import Thrust


class Nozzled(Thrust):
    """
    Fans of many blades in long ducts with nozzles, whose jets the duct alone makes as wide as it.

    So level flight gives no lift as it does to free rotors: it takes some, once the flow parts
    from the lip of the inlet. A climb takes the momentum that the air already has, and helps the
    fan by its pressure. A fan by its characteristic: B. W. McCormick, Aerodynamics of V/STOL
    Flight, 1967, chapter 9; as of vehicles with electric ducted fans.
    """

    SHARE = 0.1             # of what theory has
    NOZZLE = 0.8            # of the disk: its area
    FALLS, LOSES = 1.5, 0.3     # of the pressure, by the flow; of the jet's: what the duct takes
    CLINGS, LIP = 0.1, 6.0  # of the jet's velocity: across, at which it parts; of the pressure
    LEAST = 0.2             # of the pressures' sum

    def jet(self, climb, across):
        """Return the velocity (n,) of the jet, all over that in hover."""
        parted = np.maximum(across - self.CLINGS, 0.0)
        more = (climb * np.abs(climb) - self.LIP * parted ** 2) / (1.0 + self.LOSES)
        total = np.maximum(1.0 + self.FALLS + more, self.LEAST)
        return 0.5 * (np.sqrt(self.FALLS ** 2 + 4.0 * total) - self.FALLS)

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        jet = self.induced * np.sqrt(2.0 / self.NOZZLE)
        x, y, z = (now.hubs() / (jet * turn[:, None])).T
        climb = np.clip(z, -1.0, 1.5)
        leaves = self.jet(climb, np.minimum(np.hypot(x, y), 2.0))
        return 1.0 + self.size * self.SHARE * (leaves * (leaves - climb) - 1.0)
