# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An arm with a counterweight."""

import numpy as np

from withheld.forms.body import Centre


class Counterweight(Centre):
    """
    An arm that works here and there, and a battery on a rail that goes along as its counterweight.

    The battery is slower, so that the centre is off until it is there. F. Ruggiero and others, A
    multilayer control for multirotor UAVs equipped with a servo robot arm, ICRA 2015.
    """

    FAR = 1.5                       # of the mean's distance, what an arm at its end is off by
    ARM, BATTERY = 2.5, 0.6         # 1/s, of the reach
    STAYS = (1.5, 4.0)              # s, of a task
    EVERY, COUNT = 0.02, 6000       # s; far more steps than a flight has

    def begin(self, rng):
        """Draw where the arm works, and let the battery follow."""
        self.offs = np.empty((self.COUNT, 2))
        arm, battery, goal, until = np.zeros(2), np.zeros(2), np.zeros(2), 0.0
        for k in range(self.COUNT):
            if k * self.EVERY >= until:
                goal, until = rng.uniform(-0.7, 0.7, 2), until + rng.uniform(*self.STAYS)
            arm = nearer(arm, goal, self.ARM * self.EVERY)
            battery = nearer(battery, arm, self.BATTERY * self.EVERY)
            self.offs[k] = arm - battery

    def wrench(self, now):
        """Return the moment of the thrust about where the centre is, beside the mean."""
        far = self.FAR * float(np.linalg.norm(self.centre[:2]))
        x, y = far * self.offs[min(int(now.time / self.EVERY), self.COUNT - 1)]
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])


def nearer(place, goal, most):
    """Return a place (2,) that is nearer to a goal by as much as it may, or there."""
    way = goal - place
    far = float(np.hypot(way[0], way[1]))
    return goal if far <= most else place + most / far * way
