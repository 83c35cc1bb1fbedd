# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A gyroscope beside a transmitter."""

import numpy as np

from withheld.forms.body import Bias


class Transmitting(Bias):
    """
    A gyroscope beside the transmitter of the pictures, which sends as strongly as the way asks.

    The circuits of the gyroscope rectify what gets into them, so that the bias goes with the
    power: R. E. Richardson, Modeling of low-level rectification RFI in bipolar circuitry, IEEE
    Transactions on Electromagnetic Compatibility 21(4), 1979. The power goes with the square of
    the distance to who watches, in steps of 3 dB, as such transmitters have it in practice.
    """

    OWN, MIDDLE = 0.3, 3.0          # of the bias, always; m, where there is all of it
    AWAY, HIGH = (2.5, 3.5), 1.5    # m, of who watches: from the middle of the field; over ground
    KEEPS, MOST = 0.75, 3.0         # steps: by which it has to be wrong; from the middle one

    def begin(self, rng):
        """Draw where somebody watches."""
        angle = rng.uniform(0.0, 2.0 * np.pi)
        far = rng.uniform(*self.AWAY)
        self.place = np.array([far * np.cos(angle), far * np.sin(angle), self.HIGH])
        self._level = None

    def share(self, time, thrust):
        """Return the share of the bias."""
        return self.OWN + (1.0 - self.OWN) * 2.0 ** self._level

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        far = max(float(np.linalg.norm(state[:3] - self.place)), 1e-3)
        asked = float(np.clip(2.0 * np.log2(far / self.MIDDLE), -self.MOST, self.MOST))
        if self._level is None or abs(asked - self._level) > self.KEEPS:
            self._level = float(round(asked))
        return super().measured(time, state, thrust)
