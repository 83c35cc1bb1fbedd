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

    bias: of each flight, over the deviation; kind: one of WHITE, how errors are distributed.
    """

    position: float = 0.001
    velocity: float = 0.01
    attitude: float = 0.003
    rate: float = 0.01
    correlation: float = 0.0
    bias: float = 0.0
    kind: str = 'normal'

    def sizes(self):
        """Return the deviations of the 12 errors."""
        return np.repeat([self.position, self.velocity, self.attitude, self.rate], 3)

    def draw(self, count, step, rng):
        """Return errors (count, 12) at samples `step` s apart."""
        white = WHITE[self.kind](count, step, rng)
        if self.correlation:
            # Half of the variance is coloured, the rest stays white.
            keep = np.exp(-step / self.correlation)
            slow = np.empty_like(white)
            slow[0] = rng.normal(size=12)
            for k in range(1, count):
                slow[k] = keep * slow[k - 1] + np.sqrt(1.0 - keep ** 2) * rng.normal(size=12)
            white = np.sqrt(0.5) * (white + slow)
        return self.sizes() * (white + self.bias * rng.normal(size=12))


def _normal(count, step, rng):
    """Return errors of the normal distribution, of unit variance as all here."""
    return rng.normal(size=(count, 12))


def _student(count, step, rng):
    """Return errors with longer tails: Student's distribution of five degrees of freedom."""
    freedom = 5.0
    return rng.normal(size=(count, 12)) * np.sqrt(
        (freedom - 2.0) / rng.chisquare(freedom, (count, 12)))


def _laplace(count, step, rng):
    """Return errors with a peak and exponential tails, as of mostly good and some bad fixes."""
    return rng.laplace(scale=np.sqrt(0.5), size=(count, 12))


def _breathing(count, step, rng):
    """Return normal errors that grow and shrink by 1.7, as more or fewer markers are seen."""
    period, phase = rng.uniform(4.0, 9.0), rng.uniform(0.0, 2.0 * np.pi)
    share = 1.7 ** np.sin(2.0 * np.pi * step * np.arange(count) / period + phase)
    share /= np.sqrt(np.mean(share ** 2))
    return share[:, None] * rng.normal(size=(count, 12))


def _uneven(count, step, rng):
    """Return normal errors that differ by axis: depth and heading are seen least well."""
    shares = np.array([0.7, 0.7, 1.6, 0.7, 0.7, 1.6, 0.8, 0.8, 1.4, 1.2, 1.2, 0.8])
    return shares * rng.normal(size=(count, 12))


WHITE = {'normal': _normal, 'student': _student, 'laplace': _laplace, 'breathing': _breathing,
         'uneven': _uneven}


def noise_of(kind: str, rng: np.random.Generator) -> Noise:
    """Return the Noise of a case; each deviation is drawn, but for the normal one."""
    if kind == 'normal':
        return Noise()
    one, scale = Noise(), np.exp(rng.uniform(-0.5, 0.5, 4))
    return Noise(one.position * scale[0], one.velocity * scale[1], one.attitude * scale[2],
                 one.rate * scale[3], kind=kind)


def product(one, other):
    """Return the product, (4,), of two quaternions x, y, z, w."""
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
