# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude of a camera whose place on the body is estimated in flight."""

from withheld.forms.body import Tilt


class Aligning(Tilt):
    """
    A camera with a gyroscope that sits askew, and that estimates in flight how it sits.

    Only turns tell: as they add up, what is unknown of the tilt shrinks as with any estimate, fast
    at first and ever more slowly, to what remains by the errors of the lens. J. Kelly, G. S.
    Sukhatme, Visual-inertial sensor fusion: localization, mapping and sensor-to-sensor
    self-calibration, International Journal of Robotics Research 30(1), 2011.
    """

    REMAINS, UNKNOWN = 0.5, 1.5     # of the mean: for good; at the start, beside
    TELLS = 2.0                     # rad^2/s: the turns, squared and added up, that halve it

    def begin(self, rng):
        """Start without a turn."""
        self._turned, self._last = 0.0, None

    def measured(self, time, state, thrust):
        """Return what is said."""
        step = 0.0 if self._last is None else time - self._last
        self._turned, self._last = self._turned + step * float(state[10:] @ state[10:]), time
        left = self.UNKNOWN / (1.0 + self._turned / self.TELLS)
        return self.tilted(state, self.REMAINS + left)[0]
