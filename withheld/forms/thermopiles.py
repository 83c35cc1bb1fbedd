# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An attitude from the warmth of ground and sky."""

from scipy.spatial.transform import Rotation

from withheld.forms.body import signs, Tilt


class Infrared(Tilt):
    """
    Pairs of thermopiles that sit askew, and that see how warm the ground is and how cold the sky.

    Each pair takes the difference between its two sides for the lean, by how much ground and sky
    differed at first: as clouds come or go, it says too little or too much of every lean. B.
    Taylor, C. Bil, S. Watkins, G. Egan, Horizon sensing attitude stabilisation: a VMC autopilot,
    18th International UAV Systems Conference, 2003. The heading is of other sensors.
    """

    MISSES, MOST = 0.03, 0.6        # of the lean, at a size of 1; at most

    def __init__(self, size, params, rng):
        """Draw whether they say too much or too little."""
        super().__init__(size, params, rng)
        self.off = min(self.MISSES * size, self.MOST) * float(signs(rng, 1)[0])

    def measured(self, time, state, thrust):
        """Return what is said."""
        x, y, z, w = state[6:10].tolist()
        # The world's vertical in the body is how far each pair leans.
        pitch, roll = self.off * 2.0 * (w * y - x * z), self.off * 2.0 * (y * z + w * x)
        tilt = Rotation.from_euler('ZYX', self.angles[::-1] + [0.0, pitch, roll])
        out = state.copy()
        out[6:10] = (Rotation.from_quat(state[6:10]) * tilt).as_quat()
        return out
