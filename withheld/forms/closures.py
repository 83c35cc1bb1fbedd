# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude that drifts until a place is seen again, and a gyroscope with a slope of heat."""

import numpy as np

from withheld.forms.body import Bias, signs, Tilt


class Closing(Tilt):
    """
    An attitude from pictures, whose tilt grows with the way flown until a place is known again.

    Then all is put right at once but for what the map itself is tilted by. D. Scaramuzza, F.
    Fraundorfer, Visual odometry, IEEE Robotics and Automation Magazine 18(4), 2011.
    """

    MAP, DRIFTS = 0.45, 0.37        # of the mean: always; per m
    WAYS, COUNT = (1.5, 4.0), 400   # m between known places; far more than a flight has

    def begin(self, rng):
        """Draw after which ways, m, a place is known."""
        self.known = np.cumsum(rng.uniform(*self.WAYS, self.COUNT))
        self._way, self._last = 0.0, None

    def measured(self, time, state, thrust):
        """Return what is said."""
        step = 0.0 if self._last is None else time - self._last
        self._way, self._last = self._way + step * float(np.linalg.norm(state[3:6])), time
        count = int(np.searchsorted(self.known, self._way, side='right'))
        since = self._way - (self.known[count - 1] if count else 0.0)
        return self.tilted(state, self.MAP + self.DRIFTS * since)[0]


class Graded(Bias):
    """
    A coil of fibre whose bias goes with the slope of the temperature through it.

    So it is off while the coil warms, and as the heat of the motors changes, and not as it is
    warm throughout. D. M. Shupe, Thermally induced nonreciprocity in the fiber-optic
    interferometer, Applied Optics 19(5), 1980. Each axis answers by a coefficient of its own.
    """

    OWN, MORE = 0.7, 1.2            # of the bias: always; by the slope
    SHELL, COIL = 0.8, 8.0          # s

    def __init__(self, size, params, rng):
        """Draw the coefficients."""
        super().__init__(size, params, rng)
        self.by_axis = self.MORE * rng.uniform(0.6, 1.0, 3) * signs(rng, 3)

    def begin(self, rng):
        """Start cold."""
        self._shell, self._coil, self._last = 0.0, 0.0, None

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        step = 0.0 if self._last is None else time - self._last
        heat, self._last = float(np.clip(thrust, 0.0, 3.0)) ** 1.5, time
        self._shell += (1.0 - np.exp(-step / self.SHELL)) * (heat - self._shell)
        self._coil += (1.0 - np.exp(-step / self.COIL)) * (self._shell - self._coil)
        return super().measured(time, state, thrust)

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        return self.OWN + self.by_axis * (self._shell - self._coil)
