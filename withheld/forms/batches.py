# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands from cameras that see nothing but changes."""

import numpy as np

from withheld.actuators import Line
from withheld.constants import hover_speed
from withheld.forms.motors import TIME


class Batched(Line):
    """
    Commands from a camera of events, which are reckoned with as soon as there are enough of them.

    The faster the vehicle turns, the more events there are: so commands are late in calm flight
    and early in lively flight. H. Rebecq, T. Horstschaefer, D. Scaramuzza, Real-time
    visual-inertial odometry for event cameras using keyframe-based nonlinear optimization,
    BMVC 2017, whose windows are of a number of events. How fast it turns is what the commands
    differ by, summed up, and it fades as controllers have it.
    """

    OWN = 0.35                          # of the mean delay: what is always the same
    CALM, MOST = 0.4, 3.0               # of the usual pace of events: at rest, and at most
    USUAL, FADES = 0.002, 0.25          # s, of what differs over the command in hover; s

    def __init__(self, size, params, rng):
        """Set the delay, which is the mean one at the usual pace."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.hover = hover_speed(params)
        self.full = 2.0 * (1.0 - self.OWN) * self.delay     # s, in which a batch is full then

    def begin(self, rng):
        """Draw how much of a batch there is at first."""
        self._filled, self._since, self._pace, self._turns = rng.uniform(), 0.0, 1.0, 0.0

    def waits(self, time):
        """Return the delay of one command, at the pace of the moment."""
        if not self.delay:
            return 0.0
        filled = self._filled + (time - self._since) * self._pace / self.full
        return self.OWN * self.delay + (1.0 - filled % 1.0) * self.full / self._pace

    def pass_on(self, time, command, step):
        """Return what fills the step, [(duration s, command (n,))]."""
        if self.delay:
            self._filled += (time - self._since) * self._pace / self.full
            apart = (command - np.mean(command)) / self.hover
            keep = np.exp(-step / self.FADES)
            self._turns = keep * self._turns + (1.0 - keep) * self.FADES * apart
            lively = float(np.sqrt(np.mean(np.square(self._turns)))) / self.USUAL
            self._since, self._pace = time, min(self.CALM + (1.0 - self.CALM) * lively, self.MOST)
        return super().pass_on(time, command, step)
