# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that toothed belts drive."""

import numpy as np

from withheld.forms.fits import PulledPropellers


class Toothed(PulledPropellers):
    """
    Propellers behind toothed belts that have come to hang loose, and jump teeth if pulled hard.

    A belt is a spring, half as stiff once the strand that runs back is slack: a little below what
    it takes in hover. Beyond a pull it climbs out of its teeth and falls into the next ones. R.
    Perneder, I. Osborne, Handbook Timing Belts, 2012. As vehicles whose motors sit in the middle
    have it in practice.
    """

    RATE, DAMPING = 2.0 * np.pi * 10.0, 0.3
    SLACK, SOFT = 0.9, 0.5      # of the drag in hover; of the stiffness, beyond
    JUMPS, LOSES = 1.8, 0.9     # of the drag in hover: where it jumps; by how much that eases it

    def _turned(self, angles):
        """Return the pull after all has turned."""
        drag, stiff = self.SLOWS * self.hover, self.RATE ** 2
        slack, soft = self.SLACK * drag, self.SOFT * stiff
        within = np.clip(self._pull, -slack, slack)
        twist = within / stiff + (self._pull - within) / soft + angles
        within = np.clip(twist, -slack / stiff, slack / stiff)
        pull = stiff * within + soft * (twist - within)
        jumps = np.abs(pull) > self.JUMPS * drag
        return pull - jumps * np.sign(pull) * self.LOSES * drag
