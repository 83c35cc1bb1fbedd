# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is measured of the states: where the sensors sit, and noise."""

from dataclasses import dataclass

import numpy as np

from withheld.constants import cross


@dataclass(frozen=True)
class Noise:
    """
    Standard deviations: position m, velocity m/s, attitude rad, rate rad/s; correlation s.

    bias: of each flight, over the deviation; freedom: of Student's distribution, where errors
    have longer tails than the normal one.
    """

    position: float = 0.001
    velocity: float = 0.01
    attitude: float = 0.003
    rate: float = 0.01
    correlation: float = 0.0
    bias: float = 0.0
    freedom: float | None = None

    def sizes(self):
        """Return the deviations of the 12 errors."""
        return np.repeat([self.position, self.velocity, self.attitude, self.rate], 3)

    def draw(self, count, step, rng):
        """Return errors (count, 12) at samples `step` s apart."""
        white = rng.normal(size=(count, 12))
        if self.freedom:
            # Of unit variance, too.
            chi = rng.chisquare(self.freedom, (count, 12))
            white *= np.sqrt((self.freedom - 2.0) / chi)
        if self.correlation:
            # Half of the variance is coloured, the rest stays white.
            keep = np.exp(-step / self.correlation)
            slow = np.empty_like(white)
            slow[0] = rng.normal(size=12)
            for k in range(1, count):
                slow[k] = keep * slow[k - 1] + np.sqrt(1.0 - keep ** 2) * rng.normal(size=12)
            white = np.sqrt(0.5) * (white + slow)
        return self.sizes() * (white + self.bias * rng.normal(size=12))


def noise_of(part, rng):
    """
    Return the Noise of a case.

    In development always the same, normal and white; in the evaluation each deviation is drawn,
    and the errors have longer tails.
    """
    if part == 'development':
        return Noise()
    scale = np.exp(rng.uniform(-0.5, 0.5, 4))
    one = Noise()
    return Noise(one.position * scale[0], one.velocity * scale[1], one.attitude * scale[2],
                 one.rate * scale[3], freedom=5.0)


def product(one, other):
    """Return the product (4,) of two quaternions x, y, z, w."""
    a, b, c, d = one.tolist()
    x, y, z, w = other.tolist()
    return np.array([d * x + a * w + b * z - c * y, d * y - a * z + b * w + c * x,
                     d * z + a * y - b * x + c * w, d * w - a * x - b * y - c * z])


def declared(state, rotation, centre, tilt, bias):
    """
    Return what sensors without noise measure (13,) of a state (13,) of the centre of mass.

    Args: rotation (3, 3) of the state; centre (3,) m of mass from the body origin; tilt (4,), the
    quaternion from the body to the frame whose attitude is measured; bias (3,) rad/s of the rate.
    """
    out = state.copy()
    out[:3] -= rotation @ centre
    out[3:6] -= rotation @ cross(state[10:], centre)
    out[6:10] = product(state[6:10], tilt)
    out[10:] += bias
    return out


def moved(state, change):
    """Return a state (13,) moved by errors (12,)."""
    out = state.copy()
    out[:6] += change[:6]
    angle = np.sqrt(change[6:9] @ change[6:9])
    axis = change[6:9] * (np.sin(0.5 * angle) / angle if angle else 0.5)
    out[6:10] = product(state[6:10], np.array([*axis, np.cos(0.5 * angle)]))
    out[10:] += change[9:]
    return out
