# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind in and over a crop, and cold air that runs down a slope."""

import numpy as np

from withheld.forms.air import Wind


class Canopy(Wind):
    """
    Wind in a crop and over it: calm near the ground, and sweeps that come at once and then fade.

    By an exponential below its tops and a logarithm above, with ramps in time: M. R. Raupach, J.
    J. Finnigan, Y. Brunet, Coherent eddies and turbulence in vegetation canopies: the
    mixing-layer analogy, Boundary-Layer Meteorology 78, 1996.
    """

    HIGH, FADES, TOPS = 0.9, 1.8, 0.8       # m; of the height, downwards; of the mean, at the tops
    SHIFT, ROUGH = 0.65, 0.1                # of its height
    EVERY, LEAST, COUNT = 2.0, 1.0, 200     # s, on average beyond the least; far more than needed
    SWEEPS, SINKS = 0.4, 0.2                # of the wind there, either way; of it, down or up

    def begin(self, rng):
        """Draw when sweeps come, s."""
        apart = self.LEAST + rng.exponential(self.EVERY, self.COUNT)
        self.times = np.cumsum(apart) - rng.uniform(0.0, 1.0) * apart[0] - apart[0]

    def wind(self, time, position):
        """Return the velocity of the air."""
        last = int(np.searchsorted(self.times, time, 'right')) - 1
        ramp = 1.0 - 2.0 * (time - self.times[last]) / (self.times[last + 1] - self.times[last])
        level = self.TOPS * self.profile(max(position[2], 0.0) / self.HIGH)
        sinks = self.SINKS * ramp * level * float(np.linalg.norm(self.mean))
        return level * (1.0 + self.SWEEPS * ramp) * self.mean - [0.0, 0.0, sinks]

    def profile(self, height):
        """Return the wind at a height of that of the crop, over the wind at its tops."""
        if height < 1.0:
            return np.exp(-self.FADES * (1.0 - height))
        return np.log((height - self.SHIFT) / self.ROUGH) / np.log(
            (1.0 - self.SHIFT) / self.ROUGH)


class Katabatic(Wind):
    """
    Cold air that runs down a slope at night: fastest near the ground, nothing higher up.

    It comes in pulses. The profile is that of L. Prandtl, Fuehrer durch die Stroemungslehre, 1942.
    """

    DEEP, FASTEST, STEEP = 1.1, 1.5, 0.12     # m; of the mean; of the way, down
    PULSES, PERIOD = 0.3, 9.0               # of the wind there, either way; s

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        height = max(position[2], 0.0) / self.DEEP
        peak = np.exp(-0.25 * np.pi) * np.sin(0.25 * np.pi)
        pulse = 1.0 + self.PULSES * np.sin(2.0 * np.pi * time / self.PERIOD + self.phase)
        along = self.mean - [0.0, 0.0, self.STEEP * float(np.linalg.norm(self.mean))]
        return self.FASTEST / peak * np.exp(-height) * np.sin(height) * pulse * along
