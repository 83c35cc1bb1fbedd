# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude that a filter pulls to level, and a gyroscope that the air cools."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Bias, signs, Tilt


class Levelled(Tilt):
    """
    An attitude of a filter whose accelerometer errs, and in which it believes too much.

    In flight an accelerometer feels hardly anything but the thrust, so that it shows level in
    every lean, and the filter goes there slowly: P. Martin, E. Salaun, The true role of
    accelerometer feedback in quadrotor control, ICRA 2010.
    """

    PULLS, MOST = 0.06, 0.5         # 1/s, per size; 1/s

    def begin(self, rng):
        """Start with what the accelerometer errs by."""
        self._off, self._last = np.zeros(2), None

    def measured(self, time, state, thrust):
        """Return what is said."""
        step = 0.0 if self._last is None else time - self._last
        pulls, self._last = min(self.PULLS * self.size, self.MOST), time
        # What is up, in the body: how far it leans about x and y.
        up = Rotation.from_quat(state[6:10]).as_matrix()[2]
        lean = np.array([up[1], -up[0]])
        self._off = self._off - (1.0 - np.exp(-pulls * step)) * (lean + self._off)
        out = self.tilted(state)[0]
        out[6:10] = (Rotation.from_quat(out[6:10])
                     * Rotation.from_rotvec([*self._off, 0.0])).as_quat()
        return out


class Cooled(Bias):
    """
    A gyroscope that is warm at rest, and that the air cools the more, the faster the flight is.

    What a flow takes of the heat goes with the root of its speed: L. V. King, On the convection
    of heat from small cylinders in a stream of fluid, Philosophical Transactions of the Royal
    Society A 214, 1914. Each axis answers by a coefficient of its own.
    """

    TIME, SWING = 2.0, 0.9          # s; of the bias, at most, at rest and at 4 m/s

    def __init__(self, size, params, rng):
        """Draw the coefficients."""
        super().__init__(size, params, rng)
        self.by_axis = self.SWING * rng.uniform(0.6, 1.0, 3) * signs(rng, 3)

    def begin(self, rng):
        """Start warm."""
        self._cooled, self._last = 0.0, None

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        step = 0.0 if self._last is None else time - self._last
        goal, self._last = np.sqrt(np.linalg.norm(state[3:6])), time
        self._cooled += (1.0 - np.exp(-step / self.TIME)) * (goal - self._cooled)
        return super().measured(time, state, thrust)

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        return 1.0 + self.by_axis * (1.0 - self._cooled)
