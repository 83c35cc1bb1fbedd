# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors whose speed is known by a loop that is locked to their phase."""

from withheld.forms.belts import Linear


class PhaseLocked(Linear):
    """
    Motors whose controllers hold a speed that a loop locked to the phase makes out, a little late.

    A motor starts with the whole slope, is seen too late, and swings past. L. Harnefors, H.-P.
    Nee, A general algorithm for speed and position estimation of AC motors, IEEE Transactions on
    Industrial Electronics 47(1), 2000; as controllers with field orientation have it in practice
    (VESC, Mitochondrik). The mean time is that which a step misses.
    """

    RATE, DAMPING = 4.0, 1.0    # over the gain of the controller; of critical

    def _slopes(self, time):
        """Return the slopes (3, 3) of the speed as seen, the speed, and the slope as seen."""
        # Of a loop that sees it late, a step misses less by as much as it is late.
        gain = (1.0 - 2.0 * self.DAMPING / self.RATE) / time
        rate = self.RATE * gain
        return [[0.0, 0.0, 1.0], [-gain, 0.0, 0.0],
                [-rate ** 2, rate ** 2, -2.0 * self.DAMPING * rate]]
