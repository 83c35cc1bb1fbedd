# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Air that turns in rolls, and turbulence that the wind carries along."""

import numpy as np

from withheld.forms.air import Wind


class Rolls(Wind):
    """
    A draught, and air over a warm floor that turns in rolls: up here, down there, and between.

    As much goes up as comes down. Lord Rayleigh, On convection currents in a horizontal layer of
    fluid, Philosophical Magazine 32, 1916.
    """

    DEEP, WIDE, TURNS = 3.0, 1.8, 0.8       # m; m, of one roll; of the mean, upwards

    def __init__(self, size, params, rng):
        """Draw across which direction the rolls lie, and where."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, np.pi)
        self.across = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.place = rng.uniform(0.0, 2.0 * self.WIDE)
        self.rises = self.TURNS * float(np.linalg.norm(self.mean))

    def wind(self, time, position):
        """Return the velocity of the air."""
        on = np.pi * (position @ self.across + self.place) / self.WIDE
        up = np.pi * np.clip(position[2], 0.0, self.DEEP) / self.DEEP
        along = -self.rises * self.WIDE / self.DEEP * np.sin(on) * np.cos(up)
        return self.mean + along * self.across + np.array(
            [0.0, 0.0, self.rises * np.cos(on) * np.sin(up)])


class Carried(Wind):
    """
    Turbulence of all lengths, the longer the stronger, that the wind carries past as it is.

    Spectra near the ground: J. C. Kaimal, J. C. Wyngaard, Y. Izumi, O. R. Cote, Quarterly Journal
    of the Royal Meteorological Society 98, 1972; that it is carried past: G. I. Taylor,
    Proceedings of the Royal Society A 164, 1938.
    """

    FREQUENCIES = np.geomspace(0.03, 1.5, 24)           # Hz, at a place
    CORNER = 0.08                                       # Hz
    SHARES = np.array([0.28, 0.22, 0.12])               # of the mean, along, across, up

    def begin(self, rng):
        """Draw the phases."""
        self.phases = rng.uniform(0.0, 2.0 * np.pi, (3, len(self.FREQUENCIES)))
        power = self.FREQUENCIES * (1.0 + 1.5 * self.FREQUENCIES / self.CORNER) ** (-5.0 / 3.0)
        self.sizes = np.sqrt(2.0 * power / np.sum(power))       # of waves with unit variance

    def wind(self, time, position):
        """Return the velocity of the air."""
        speed = float(np.linalg.norm(self.mean))
        if not speed:
            return np.zeros(3)
        x, y, _ = self.mean
        late = time - position @ self.mean / speed ** 2
        waves = np.sin(2.0 * np.pi * self.FREQUENCIES * late + self.phases) @ self.sizes
        along, across, up = self.SHARES * waves
        return self.mean + np.array(
            [along * x - across * y, along * y + across * x, up * speed])
