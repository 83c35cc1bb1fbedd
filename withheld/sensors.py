# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is measured of the states: where the sensors sit, and noise."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class Noise:
    """Standard deviations: position m, velocity m/s, attitude rad, rate rad/s; correlation s."""

    position: float = 0.001
    velocity: float = 0.01
    attitude: float = 0.003
    rate: float = 0.01
    correlation: float = 0.0
    bias: float = 0.0

    def sizes(self):
        """Return the deviations of the 12 errors."""
        return np.repeat([self.position, self.velocity, self.attitude, self.rate], 3)

    def draw(self, count, step, rng):
        """Return errors (count, 12) at samples `step` s apart."""
        white = rng.normal(size=(count, 12))
        if self.correlation:
            # Half of the variance is coloured, the rest stays white.
            keep = np.exp(-step / self.correlation)
            slow = np.empty_like(white)
            slow[0] = rng.normal(size=12)
            for k in range(1, count):
                slow[k] = keep * slow[k - 1] + np.sqrt(1.0 - keep ** 2) * rng.normal(size=12)
            white = np.sqrt(0.5) * (white + slow)
        return self.sizes() * (white + self.bias * rng.normal(size=12))


def declared(states, centre, tilt, bias):
    """
    Return what sensors without noise measure (N, 13) of states (N, 13) of the centre of mass.

    Args: centre (3,) m of mass from the body origin; tilt (3,) rad roll, pitch, yaw of the frame
    whose attitude is measured; bias (3,) rad/s of the rate.
    """
    rotation, rate = Rotation.from_quat(states[:, 6:10]), states[:, 10:]
    out = states.copy()
    out[:, :3] -= rotation.apply(np.tile(centre, (len(states), 1)))
    out[:, 3:6] -= rotation.apply(np.cross(rate, centre))
    out[:, 6:10] = (rotation * Rotation.from_euler('ZYX', tilt[::-1])).as_quat()
    out[:, 10:] += bias
    return out


def moved(states, change):
    """Return states (N, 13) moved by errors (N, 12)."""
    out = states.copy()
    out[:, :6] += change[:, :6]
    out[:, 6:10] = (Rotation.from_quat(states[:, 6:10])
                    * Rotation.from_rotvec(change[:, 6:9])).as_quat()
    out[:, 10:] += change[:, 9:]
    return out
