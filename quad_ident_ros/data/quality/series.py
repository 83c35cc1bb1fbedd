# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Evenly sampled, smoothed signals of a flight record, that the checks compare."""

from dataclasses import dataclass

import numpy as np
import scipy

from quad_ident_ros.data.attitudes import attitudes_of
from quad_ident_ros.data.once import once
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.streams import slerp
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.attitude import conjugate, continuous, product, rotate

WIDTH = 0.2       # s, full width of the smoothing window
GAP = 3.0         # median periods from which on a step in time is a gap
MOST = 100_000    # samples that the checks look at: of more, one of so many, over the whole record
DIRECT = 2001     # samples of a window, from which on Fourier transforms take fewer steps
NEAR, SHARE_ERROR, ALIKE = 0.25, 0.1, 0.5   # of a share that is 1, its error, and a correlation
COARSEST = 0.1 * WIDTH  # s between them, however long a record is: smoothing needs a few


@dataclass(frozen=True, eq=False)
class Grid:
    """
    An even time base t (N,) s, its period s, and where it is free of gaps, good (N,) bool.

    A view on the record; the functions below give its signals at t.
    """

    record: FlightRecord
    t: np.ndarray
    period: float
    good: np.ndarray

    @classmethod
    def of(cls, record: FlightRecord) -> 'Grid | None':
        """
        Return the grid of a record at its median period, or at some of these where it is long.

        None for a record under 1 s.
        """
        even = _even(record)
        return None if even is None else cls(record, *even)

    def signal(self, *names: str) -> np.ndarray:
        """Return columns at t, (N, k)."""
        return np.stack([np.interp(self.t, self.record.t, self.record.stack(name)[:, 0])
                         for name in names], axis=-1)

    def held(self, *names: str) -> np.ndarray:
        """Return columns at t, each held until its next sample, (N, k)."""
        # A hundredth of a sample: rounding must not make it the command before.
        index = np.searchsorted(self.record.t, self.t + 0.01 * self.period, side='right') - 1
        return self.record.stack(*names)[index]

    def attitude(self) -> np.ndarray | None:
        """Return the attitude at t, (N, 4), or None where there is none."""
        q = attitudes_of(self.record)
        return None if q is None else slerp(self.record.t, continuous(q), self.t)

    def smooth(self, signal: np.ndarray, width: float = WIDTH) -> np.ndarray:
        """Return a signal (N, k) smoothed by a Hann window of a full width in s."""
        half = min(max(1, round(width / 2 / self.period)), len(signal))
        window = np.hanning(2 * half + 3)[1:-1]
        window /= window.sum()
        padded = np.concatenate([np.repeat(signal[:1], half, axis=0), signal,
                                 np.repeat(signal[-1:], half, axis=0)])
        if len(window) > DIRECT:
            return scipy.signal.fftconvolve(padded, window[:, None], 'valid', axes=0)
        return np.stack([np.convolve(column, window, 'valid') for column in padded.T], axis=-1)

    def derivative(self, signal: np.ndarray) -> np.ndarray:
        """Return the smoothed derivative of a signal (N, k) by central differences."""
        return self.smooth(np.gradient(signal, self.period, axis=0))

    def rate_of(self, attitude: np.ndarray) -> np.ndarray:
        """Return the smoothed body rate of attitudes (N, 4), (N, 3) rad/s."""
        q = continuous(attitude)
        turn = product(conjugate(q[:-2]), q[2:])
        length = np.linalg.norm(turn[:, 1:], axis=-1, keepdims=True)
        angle = 2.0 * np.arctan2(length, turn[:, :1])
        scale = np.divide(angle, length, out=np.full_like(length, 2.0), where=length > 1e-12)
        rate = scale * turn[:, 1:] / (2 * self.period)
        return self.smooth(np.vstack([rate[:1], rate, rate[-1:]]))

    def force(self) -> np.ndarray:
        """
        Return the specific force in the body, (N, 3) m/s^2, smoothed.

        Without an accelerometer it is taken as g along body z, as in gentle flight.
        """
        if self.record.has('ax', 'ay', 'az'):
            return self.smooth(self.signal('ax', 'ay', 'az'))
        return np.tile([0.0, 0.0, GRAVITY], (len(self.t), 1))

    def acceleration(self, attitude: np.ndarray) -> np.ndarray:
        """Return the acceleration in the world from attitude and specific force, (N, 3)."""
        return rotate(attitude, self.force()) - np.array([0.0, 0.0, GRAVITY])


@once
def _even(record: FlightRecord) -> tuple[np.ndarray, float, np.ndarray] | None:
    """Return the time base (N,) s of the Grid of a record, its period s, and good (N,)."""
    period = record.period()
    span = record.t[-1] - record.t[0]
    if span < 1.0 or len(record) < 50 or period > 0.1:
        return None
    period *= max(1, min(-(-len(record) // MOST), int(COARSEST / period)))
    # One bad stamp makes a span without end.
    count = min(int(span / period) + 1, max(MOST, len(record)))
    t = record.t[0] + period * np.arange(count)
    t = t[t <= record.t[-1]]
    after = np.clip(np.searchsorted(record.t, t), 1, len(record) - 1)
    wide = record.t[after] - record.t[after - 1] > GAP * period
    bad = scipy.ndimage.maximum_filter1d(wide.view(np.uint8), 2 * round(WIDTH / period) + 1,
                                         mode='constant') > 0
    edge = max(1, round(WIDTH / period))
    good = ~bad
    good[:edge] = good[-edge:] = False
    return (t, period, good) if good.sum() >= 50 else None


def is_rather(target: np.ndarray, signal: np.ndarray, other: np.ndarray, together: float) -> bool:
    """
    Return whether a target is another reading of a signal and not the signal, all (N, k).

    That is so where it has all of their difference, within the error, and little besides: also
    where they differ by less than noise does. together: samples that smoothing makes one.
    """
    difference, missed = other - signal, target - signal
    power = np.sum(difference ** 2)
    if not power > 0.0:
        return False
    share = np.sum(difference * missed) / power
    left = np.mean((missed - share * difference) ** 2)
    error = np.sqrt(together * left / power)
    alike = correlation(missed, difference)[0]
    return bool(abs(share - 1.0) < NEAR and error < SHARE_ERROR and alike > ALIKE)


def explained(target: np.ndarray, model: np.ndarray) -> float:
    """Return the share of a signal's power that another explains; 1 where they are equal."""
    power = np.sum(target ** 2)
    return 1.0 - np.sum((target - model) ** 2) / power if power > 0 else 0.0


def correlation(one: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Return the correlation over all axes about zero, and the slope of one on the other."""
    product, square = np.sum(one * other), np.sum(other ** 2)
    scale = np.sqrt(np.sum(one ** 2) * square)
    return (product / scale, product / square) if scale > 0 else (0.0, 0.0)
