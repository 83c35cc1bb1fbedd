# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A plate of markers with play, and a gyroscope that takes vibration for a slow turn."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.forms.body import Bias, Tilt


class Playing(Tilt):
    """
    A plate of markers that sits askew, and with play: it stays behind until the body takes it on.

    So its tilt depends on which way the body turned last. The operator of play: M. A.
    Krasnoselskii, A. V. Pokrovskii, Systems with Hysteresis, 1989.
    """

    PLAY = 0.005        # rad to either side, per size

    def begin(self, rng):
        """Start in the middle."""
        self._behind, self._last = np.zeros(3), None

    def measured(self, time, state, thrust):
        """Return what is said."""
        step = 0.0 if self._last is None else time - self._last
        most, self._last = self.PLAY * self.size, time
        self._behind = np.clip(self._behind + step * state[10:], -most, most)
        out = self.tilted(state)[0]
        out[6:10] = (Rotation.from_quat(out[6:10]) * Rotation.from_rotvec(
            -self._behind)).as_quat()
        return out


class Aliased(Bias):
    """
    A gyroscope whose samples meet the vibration of the rotors at nearly the same phase each time.

    So the bias swings, slowly while the rotors turn at one speed and faster at another: aliasing
    (A. V. Oppenheim, R. W. Schafer, Discrete-Time Signal Processing, 2010, chapter 4).
    """

    HOVERS, MORE = 0.15, 12.0       # Hz, in hover; what twice the speed adds
    SWING = 0.7                     # of the bias, either way

    def begin(self, rng):
        """Draw the phases of the axes."""
        self._phases, self._last = rng.uniform(0.0, 2.0 * np.pi, 3), None

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        step = 0.0 if self._last is None else time - self._last
        turn, self._last = np.sqrt(np.clip(thrust, 0.0, 4.0)), time
        self._phases = self._phases + 2.0 * np.pi * step * (
            self.HOVERS + self.MORE * (turn - 1.0))
        return 1.0 + self.SWING * np.sin(self._phases)
