# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Thrust of propellers by their chart."""

import numpy as np

from withheld.forms.air import Thrust


class Charted(Thrust):
    """
    A propeller by its chart: thrust falls over the advance ratio, first gently, then steeply.

    By a straight line and the square, of which a descent has the line alone; propellers for slow
    flight are so: J. B. Brandt, M. S. Selig, Propeller performance data at low Reynolds numbers,
    AIAA 2011-1255. Flow from the side adds pressure at the blades, and so does its chart count
    less: Y. Leng, H. Yoo, T. Jardin, M. Bronz, J.-M. Moschetta, Aerodynamic modeling of propeller
    forces and moments at high angle of incidence, AIAA 2019-1332.
    """

    SHARE = 0.4                 # of what the chart has
    NONE, LINE = 0.65, 0.25     # advance ratio without thrust; of the fall until there
    SIDE = 1.5                  # of the square of the flow from the side over the tips' speed

    def chart(self, ratio):
        """Return thrust over that at rest."""
        part = ratio / self.NONE
        return 1.0 - self.LINE * part - (1.0 - self.LINE) * np.maximum(part, 0.0) ** 2

    def gain(self, now):
        """Return the factors."""
        tips = self.radius * np.maximum(now.speeds, 0.2 * self.hover)
        x, y, z = (now.hubs() / tips[:, None]).T
        pressure = 1.0 + self.SIDE * (x ** 2 + y ** 2)
        thrust = pressure * self.chart(np.pi * np.clip(z, -0.2, 0.2) / np.sqrt(pressure))
        return 1.0 + self.size * self.SHARE * (thrust - 1.0)
