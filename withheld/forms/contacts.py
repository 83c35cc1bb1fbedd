# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Contacts that vibration opens."""

import numpy as np

from withheld.actuators import Battery


class Chattering(Battery):
    """
    A battery in a bay with spring contacts, which chatter where rotors turn at their resonance.

    Vibration takes from the force on the contacts, and their resistance grows with its inverse
    root (R. Holm, Electric Contacts, 1967); so there is a speed of the rotors at which the voltage
    falls most. As of packs that slide in.
    """

    recorded = False
    RESISTS, FALLS = 0.007, 0.008   # of the voltage, by the load of hover; in 30 s
    TAKES, WIDE = 0.9, 0.06        # of the force, all rotors at it; of the hover speed
    FROM, TO = 0.9, 1.1             # of the hover speed: the resonance

    def __init__(self, size, params, rng):
        """Draw the speed of the resonance."""
        super().__init__(0.0, 1.8)
        self.size, self._taken = size, 0.0
        self.resonance = rng.uniform(self.FROM, self.TO)
        self.parameters = {'resistance': self.RESISTS * size, 'resonance': self.resonance}

    def resists(self, speeds):
        """Return the resistance over that at rest."""
        shaken = 1.0 / (1.0 + ((speeds - self.resonance) / self.WIDE) ** 2)
        return (1.0 - self.TAKES * float(np.mean(shaken))) ** -0.5

    def drain(self, time, step, speeds):
        """Go on."""
        load = float(np.mean(speeds ** 3))
        self._taken += load * step
        self.ratio = 1.0 - self.size * (
            self.RESISTS * self.resists(speeds) * load + self.FALLS * self._taken / 30.0)
