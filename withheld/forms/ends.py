# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors of which those of one end are of another kind."""

import numpy as np

from withheld.actuators import Motor
from withheld.forms.body import signs
from withheld.forms.motors import TIME, towards


class UnlikeEnds(Motor):
    """
    Motors of which those of one end were replaced by larger ones, which are slower.

    So thrust that all are asked for tips the body at first, until the slow end is there, too. As
    after a crash, when the same kind is sold out; a time constant is the inertia times the
    resistance over the square of the torque per current, as data sheets of motors have it.
    """

    APART = 0.4         # of the mean time, by which either end is slower or faster

    def __init__(self, size, params, rng):
        """Draw which end is slow."""
        ahead = np.array(list(params['rotor_pos'].values()))[:, 0]
        ends = np.sign(np.round(ahead / np.abs(ahead).max(), 6))
        self.parameters = {'time': TIME * size}
        self.times = TIME * size * (1.0 + self.APART * float(signs(rng, 1)[0]) * ends)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        return towards(speeds, command, self.times, step)
