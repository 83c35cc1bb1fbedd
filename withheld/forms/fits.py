# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that are pressed on their shafts, and propellers whose motors sit on rubber."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class PulledPropellers(LoosePropellers):
    """Propellers against whose drag something pulls, by a law of how far it is turned."""

    SLOWS = 1.5                 # 1/s, of the drag at the speed of hover
    RATE, DAMPING = 0.0, 0.0    # rad/s, where little is turned; of the critical one

    def begin(self, rng):
        """Start in step with the hubs, in balance."""
        super().begin(rng)
        self._pull = None

    def _follow(self, step):
        super()._follow(step)
        self._pull = self._turned(step * (self._hubs - self._blades))

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        drag = self.SLOWS / self.hover * self._blades ** 2
        if self._pull is None:
            self._pull = drag
        return self._pull - drag + 2.0 * self.DAMPING * self.RATE * (self._hubs - self._blades)

    def _turned(self, angles):
        """Return the pull (n,) rad/s^2 after hubs have turned past propellers, by (n,) rad."""
        raise NotImplementedError


class Pressed(PulledPropellers):
    """
    Propellers that are pressed on thin shafts, and have been taken off often: they creep on them.

    Their friction yields like a spring at first and ever more towards its limit, and what has
    crept stays so: P. R. Dahl, Solid friction damping of mechanical vibrations, AIAA Journal
    14(12), 1976. As the smallest vehicles have it in practice.
    """

    RATE, DAMPING = 2.0 * np.pi * 10.0, 0.2
    HOLDS = 2.5                 # of the drag in hover

    def _turned(self, angles):
        """Return the pull after all has turned."""
        most = self.HOLDS * self.SLOWS * self.hover
        # Towards the limit of the side to which it is turned.
        limit = most * np.sign(angles)
        return limit + (self._pull - limit) * np.exp(-self.RATE ** 2 * np.abs(angles) / most)


class Grommeted(PulledPropellers):
    """
    Motors on rubber, so that the frame does not shake, whose screws have play in their holes.

    The reaction turns the motor on its rubber, which is soft until the screws meet the walls of
    their holes: a little beyond what it takes in hover. Springs with a kink: J. P. Den Hartog,
    Mechanical Vibrations, 1956, chapter 8. As vehicles for races have it in practice.
    """

    RATE, DAMPING = 2.0 * np.pi * 10.0, 0.45
    HARD, STOP = 2.0 * np.pi * 20.0, 1.1    # rad/s, beyond the stop; of the drag in hover

    def _turned(self, angles):
        """Return the pull after all has turned."""
        stop, soft, hard = self.STOP * self.SLOWS * self.hover, self.RATE ** 2, self.HARD ** 2
        beyond = self._pull - np.clip(self._pull, -stop, stop)
        twist = (self._pull - beyond) / soft + beyond / hard + angles
        within = np.clip(twist, -stop / soft, stop / soft)
        return soft * within + hard * (twist - within)
