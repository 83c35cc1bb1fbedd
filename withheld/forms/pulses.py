# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of commands as pulses, one rotor's after the other's."""

import numpy as np

from withheld.actuators import Line
from withheld.constants import hover_speed
from withheld.forms.motors import TIME


class PulseTrain(Line):
    """
    Commands as the lengths of pulses, all on one wire: frames begin by a clock of the sender.

    A rotor has its command as its pulse ends, behind those of the rotors before it, and a fast
    rotor's pulse takes longer: so the last one's delay says how fast all of them are to be. As
    receivers of remote controls have it in practice (pulse-position modulation, frames of 22.5 ms
    of eight pulses of 1 ms to 2 ms), here at the pace that the delay takes.
    """

    FRAME, SHORTEST, LONGER = 22.5, 1.0, 1.0    # ms: of a frame; of a pulse; at the top speed

    def __init__(self, size, params, rng):
        """Set the mean delay, which is that in hover."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.full, hover = params['rotor_speed_max'], hover_speed(params)
        pulse = self.SHORTEST + self.LONGER * hover / self.full
        mean = 0.5 * self.FRAME + 0.5 * (params['num_rotors'] + 1) * pulse
        self.unit = self.delay / mean           # s, of what is a millisecond at the usual pace
        self._lengths = pulse * np.ones(params['num_rotors'])

    def begin(self, rng):
        """Draw when frames begin."""
        self.first = rng.uniform(0.0, self.FRAME)

    def taken(self, time):
        """Return when what is given at a time goes into a frame, s."""
        return time + (self.first * self.unit - time) % (self.FRAME * self.unit)

    def waits(self, time):
        """Return the delays (n,) of one command."""
        if not self.delay:
            return 0.0
        return self.taken(time) - time + self.unit * np.cumsum(self._lengths)

    def pass_on(self, time, command, step):
        """Return what fills the step, [(duration s, command (n,))]."""
        if self.delay:
            share = np.clip(command / self.full, 0.0, 1.0)
            self._lengths = self.SHORTEST + self.LONGER * share
            # What no frame has taken up is forgotten.
            self._waiting = [one for one in self._waiting
                             if self.taken(float(np.min(one[1]))) <= time]
        return super().pass_on(time, command, step)
