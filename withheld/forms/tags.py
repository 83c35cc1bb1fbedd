# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude from tags on the floor."""

import numpy as np

from withheld.forms.body import Tilt


class Tagged(Tilt):
    """
    A camera that sits askew and looks at tags on the floor, which do not lie quite flat.

    The tag below says how the body leans, and each is curled or lies on another tile; a filter
    smooths the change from one to the next. E. Olson, AprilTag: a robust and flexible visual
    fiducial system, ICRA 2011; robots fly over floors of them in practice. Places are of other
    sensors.
    """

    APART, COUNT = 0.5, 16          # m; along either side of a floor that is laid again and again
    SWING, TIME = 0.9, 0.15         # of the mean tilt, at most, about each axis; s

    def __init__(self, size, params, rng):
        """Lay the tags."""
        super().__init__(size, params, rng)
        self.floor = 1.0 + self.SWING * rng.uniform(-1.0, 1.0, (self.COUNT, self.COUNT, 3))

    def begin(self, rng):
        """Start without a tag."""
        self._shares, self._last = None, 0.0

    def measured(self, time, state, thrust):
        """Return what is said."""
        row, column = (np.floor(state[:2] / self.APART).astype(int) % self.COUNT).tolist()
        tag = self.floor[row, column]
        if self._shares is None:
            self._shares = tag
        keep = np.exp(-max(time - self._last, 0.0) / self.TIME)
        self._shares, self._last = tag + keep * (self._shares - tag), time
        return self.tilted(state, self._shares)[0]
