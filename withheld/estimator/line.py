# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Commands that the controller gives more seldom than the sensors are read."""


class Seldom:
    """
    A line that is given a command only every so many steps, as the controller gives it.

    Reality.hold hands the same command over in each step of the IMU; a delay that differs from
    command to command must not be drawn again for it.
    """

    def __init__(self, line, every):
        """Take the line and the number of steps."""
        self.line, self.every, self._calls, self._parts = line, every, 0, []

    def pass_on(self, time, command, step):
        """Return [(duration s, command (n,))] that fill the step."""
        if self._calls % self.every == 0:
            self._parts = self.line.pass_on(time, command, self.every * step)
        self._calls += 1
        out, rest = [], step
        while self._parts and rest > 1e-9:
            (duration, held), *after = self._parts
            now = min(duration, rest)
            out.append((now, held))
            rest -= now
            self._parts = after if duration - now < 1e-9 else [(duration - now, held), *after]
        return out
