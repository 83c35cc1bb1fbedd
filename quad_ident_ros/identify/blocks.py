# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Equations of motion averaged over short blocks of a flight, without derivatives of measurements.

With a smooth weight w that begins and ends at zero, the mean of y'' is the integral of w'' y
(modulating functions: M. Shinbrot, Trans. ASME 79, 1957). A block is one line of a linear
regression: no initial state is in it, and blocks apart have independent noise.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.identify.signals import OUTPUTS, Signal
from quad_ident_ros.model.attitude import body_rate

LENGTH = 0.5        # s, over which noise of mm averages to some cm/s^2
FEWEST = 20         # samples of a block, for which the sums are integrals
SMOOTHED = 0.1      # s, over which angles are differentiated: no vehicle turns to and fro faster
STEEP = 1.5         # rad, where a tangent is as good as infinite
POWER = 4           # of the weight s^4 (1 - s)^4
PRIOR_DAMPING = {'z': 0.5, 'phi': 5.0, 'theta': 5.0, 'psi': 5.0}    # 1/s, usual size of c1


@dataclass(frozen=True)
class Blocks:
    """
    Blocks of one output.

    ends_ns (n,) stamps of the last samples; target (n,), which the features (n, k) times K, c1 and
    for angles a constant are: y'', of z together with gravity; neglected (n,): the most that the
    linear model leaves out of the target (see `neglected`), infinite where rotors cannot give the
    input; tilt (n,) rad, the largest in a block, not a number where no attitude is recorded.
    """

    ends_ns: np.ndarray
    target: np.ndarray
    features: np.ndarray
    neglected: np.ndarray
    tilt: np.ndarray

    def __len__(self) -> int:
        """Return how many blocks there are."""
        return len(self.target)

    def part(self, rows: slice | np.ndarray) -> 'Blocks':
        """Return some of the blocks, by a slice or a mask."""
        return Blocks(*(values[rows] for values in vars(self).values()))

    def followed_by(self, others: 'Blocks') -> 'Blocks':
        """Return these blocks and others after them."""
        return Blocks(*(np.concatenate(pair) for pair in zip(
            vars(self).values(), vars(others).values(), strict=True)))


def samples_of(period: float) -> int:
    """Return how many periods a block has, even, so that blocks overlap by half."""
    return 2 * max(FEWEST // 2, round(LENGTH / period / 2))


@cache
def _weights(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the weight, its first and second derivative (count + 1,), and its held integral."""
    s = np.linspace(0.0, 1.0, count + 1)
    base = np.polynomial.Polynomial([0, 1, -1]) ** POWER
    base = base / base.integ()(1.0)
    return base(s), base.deriv()(s), base.deriv(2)(s), np.diff(base.integ()(s))


def blocks_of(signal: Signal, after_ns: int) -> Blocks:
    """
    Return the Blocks of a Signal with a start_ns that end after a stamp.

    They end on a grid of stamps, half a block apart, in every window of the flight.
    """
    count = samples_of(signal.period)
    hop_ns = round(count // 2 * signal.period * 1e9)
    # Stamps are whole numbers: as doubles, those of today are only good to 256 ns.
    earliest = signal.start_ns + round((signal.t[0] + (count - 0.5) * signal.period) * 1e9)
    latest = signal.start_ns + round(signal.t[-1] * 1e9 + 1e3)
    ends = hop_ns * np.arange(max(int(after_ns), earliest) // hop_ns + 1, latest // hop_ns + 1)
    last = np.searchsorted(signal.t, (ends - signal.start_ns) * 1e-9 + 1e-6) - 1
    ends, last = ends[last >= count], last[last >= count]
    if not len(ends):
        return Blocks(ends, np.empty(0), np.empty((0, 3 - (signal.output == 'z'))), np.empty(0),
                      np.empty(0))
    rows = last[:, None] + np.arange(-count, 1)
    weight, slope, bend, held = _weights(count)
    length = count * signal.period
    y = signal.y[rows] - signal.y[rows].mean(axis=1, keepdims=True)
    acceleration = y @ bend / (count * length ** 2)
    rate = -(y @ slope) / (count * length)
    thrust = (signal.u[rows[:, :-1]] + signal.trim) @ held
    if signal.output == 'z':
        target, features = acceleration + GRAVITY, [thrust, -rate]
    else:
        target, features = acceleration, [thrust, -rate, np.ones(len(rows))]
    if signal.attitude is None:
        most, tilt = np.zeros(len(rows)), np.full(len(rows), np.nan)
    else:
        tilts = np.arccos(np.cos(signal.attitude[:, 0]) * np.cos(signal.attitude[:, 1]))
        unsteady, steady = neglected(signal, tilts)
        most = (np.abs(unsteady[rows] @ slope) / (count * length)
                + steady[rows] @ weight / count)
        tilt = tilts[rows].max(axis=1)
    if signal.saturated is not None:
        most = np.where(signal.saturated[rows[:, :-1]].any(axis=1), np.inf, most)
    return Blocks(ends, target, np.column_stack(features), most, tilt)


def neglected(signal: Signal, tilts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Return what the linear model leaves out: a rate (N,) and the most of an acceleration (N,).

    z: in steady flight at a tilt drag is at most thrust x tan(tilt) across body z, of which
    sin(tilt) is vertical; in a flight from rest, whose input is U1, what the tilt takes of it too.
    Angles: the Euler rate is not the body rate, by eq. (3); and the
    products of two rates in eqs. (13) to (15), whose factor, a difference of two moments of
    inertia over the third, is at most 1 for any rigid body.
    """
    if signal.output == 'z':
        lost = 1 - np.cos(tilts) if signal.at_rest else 0.0
        share = np.tan(np.minimum(tilts, STEEP)) * np.abs(np.sin(tilts)) + lost
        return np.zeros_like(tilts), GRAVITY * share
    assert signal.attitude is not None
    rates = _rates(signal.attitude, signal.period)
    body = body_rate(signal.attitude, rates)
    axis = OUTPUTS.index(signal.output)
    return (rates - body)[:, axis], np.abs(np.prod(np.delete(body, axis, axis=1), axis=1))


def _rates(angles: np.ndarray, period: float) -> np.ndarray:
    """Return the rates (N, 3) rad/s of angles: the slopes of lines through those around."""
    half = max(2, round(SMOOTHED / period / 2))
    padded = np.pad(angles, ((half, half), (0, 0)), 'reflect', reflect_type='odd')
    kernel = np.arange(half, -half - 1, -1.0)
    kernel /= period * (kernel @ kernel)
    return np.column_stack([np.convolve(column, kernel, 'valid') for column in padded.T])
