# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Autocorrelated measurement noise, from what sensors say of one another.

The pose is the integral of velocity and rate, for any force: an unmodelled force cannot be
mistaken for noise here, nor noise with a memory for such a force.
"""

from collections.abc import Sequence

import numpy as np
import scipy

from quad_ident_ros.greybox.errors import difference, GROUPS
from quad_ident_ros.greybox.flights import GAP, Track
from quad_ident_ros.greybox.parameters import SPLIT
from quad_ident_ros.model.attitude import product, rotation_matrix, turn
from quad_ident_ros.model.sensors import underlying

PAIRS = (('position', 'velocity'), ('attitude', 'rate'))
MEMORIES = (0.03, 0.08, 0.2, 0.5)   # s, of which the noise may be made up
HORIZON = 0.5   # s of the predictions that it is for
LONGEST = 1.0   # s between two samples that are compared
LAGS = 14
ALIKE = 0.1     # weight of shares that are alike, beside the drift's
KEPT = 0.995    # of pairs of samples, the others being glitches that were not told
FEWEST = 50     # pairs of samples from which on a lag is used
ARITHMETIC = 1e-6   # of the variance of the noise: less of a drift is that of arithmetic


def measurement_noise(flights: Sequence[Track], vectors: Sequence[np.ndarray],
                      near: np.ndarray, white: np.ndarray) -> tuple[np.ndarray, float]:
    """
    Return the standard deviation of the measurement noise, with what of it has a memory, (12,).

    Of a long memory only what changes within HORIZON counts: start and end of a prediction have
    the rest in common. What the velocity has of that, m/s, comes second: it moves a prediction.

    Args: flights; vectors: a vector z (Z,) per flight, whose tilt and bias of the sensors are
    undone; near (12,): the noise over some samples, which it is at least; white (12,): that from
    sample to sample. From the spread of the pose less the integral of the rate, by the time
    between two samples; constant biases do not count.
    """
    found, drift = np.array(near, float), 0.0
    drifts = [_drifts(flight, z) for flight, z in zip(flights, vectors, strict=True)]
    for k, (pose, rate) in enumerate(PAIRS):
        if any(pose in flight.summed for flight in flights):
            continue    # it is the integral, noise and all
        lags, spread = _spreads(flights, [drift[k] for drift in drifts], GROUPS[pose])
        if not len(lags):
            continue
        period = float(np.median([flight.period for flight in flights]))
        whole = _split(lags, spread, period, np.mean(white[GROUPS[rate]] ** 2),
                       [np.mean(found[GROUPS[group]] ** 2) for group in (pose, rate)])
        for group, power in zip((pose, rate), whole[:2], strict=True):
            part = GROUPS[group]
            found[part] *= max(1.0, np.sqrt(power / np.mean(found[part] ** 2)))
        if rate == 'velocity':
            drift = float(np.sqrt(whole[2]))
    return found, drift


def _drifts(flight: Track, z: np.ndarray) -> list[np.ndarray]:
    """Return position (N, 3) and rotation (N, 3), world, less the integrals of their rates."""
    states, t = underlying(z[SPLIT:], flight.states), flight.course.t
    good = np.flatnonzero(flight.seen[:, GROUPS['attitude']].all(axis=1))
    q = np.stack([np.interp(t, t[good], column) for column in states[good, 6:10].T], axis=1)
    states[:, 6:10] = q / np.linalg.norm(q, axis=1, keepdims=True)
    step = np.diff(t)[:, None]
    velocity = (states[1:, 3:6] + states[:-1, 3:6]) / 2
    rate = (states[1:, 10:] + states[:-1, 10:]) / 2
    moved = states[:-1].copy()
    moved[:, :3] += step * velocity
    moved[:, 6:10] = product(moved[:, 6:10], turn(step * rate))
    errors = difference(states[1:], moved)
    # A bias turns with the body. Its noise sums up to nothing in a mean, unlike in a median.
    whole = step[:, 0] <= GAP * flight.period
    turned = errors[:, GROUPS['attitude']]
    turned = turned - step * turned[whole].sum(axis=0) / step[whole].sum()
    turned = np.einsum('nij,nj->ni', rotation_matrix(states[1:, 6:10]), turned)
    return [np.concatenate([np.zeros((1, 3)), np.cumsum(part, axis=0)])
            for part in (errors[:, GROUPS['position']], turned)]


def _spreads(flights: Sequence[Track], drifts: Sequence[np.ndarray], group: slice
             ) -> tuple[np.ndarray, np.ndarray]:
    """Return times (L,) s between samples and the variance of the drift over them (L,)."""
    period = float(np.median([flight.period for flight in flights]))
    strides = np.unique(np.geomspace(1, LONGEST / period, LAGS).astype(int))
    known = [np.asarray(flight.seen[:, group].all(axis=1)) for flight in flights]
    pieces = [np.append(0, np.cumsum(np.diff(flight.course.t) > GAP * flight.period))
              for flight in flights]
    lags, spread = [], []
    for stride in strides:
        found = []
        for drift, seen, piece in zip(drifts, known, pieces, strict=True):
            whole = (piece[stride:] == piece[:-stride]) & seen[stride:] & seen[:-stride]
            if whole.sum() >= FEWEST:
                change = (drift[stride:] - drift[:-stride])[whole]
                square = np.sort((change - np.median(change, axis=0)) ** 2, axis=0)
                # Corrections of a filter are rare and large: a median would miss them.
                found.append(np.mean(square[:int(KEPT * len(square)) + 1]))
        if found:
            lags.append(stride * period)
            spread.append(np.mean(found))
    return np.array(lags), np.array(spread)


def _split(lags: np.ndarray, spread: np.ndarray, period: float, white: float,
           near: Sequence[float]) -> tuple[float, float, float]:
    """
    Return the variances of the noise of a pose and of its rate, as far as it changes in HORIZON.

    Then that of the noise of the rate that stays for so long.

    Args: lags (L,) s; spread (L,) of the drift over them; white: the variance of what is white in
    the rate; near (2,): variances of the noise over some samples. The noise of both is a sum of
    white noise and of first-order noise of MEMORIES, in like shares where the drift does not tell
    that of the pose from that of the rate.
    """
    h, memory = lags[:, None], np.array(MEMORIES)
    decay = 1.0 - np.exp(-h / memory)
    table = np.hstack([np.full_like(h, 2.0), 2.0 * decay, 2.0 * memory * (h - memory * decay)])
    # Exact states of a motion along some axes alone leave none at all along the others.
    spread = np.maximum(spread, ARITHMETIC * near[0])
    # Spreads over long times are known less well, in proportion to their size.
    weight = 1.0 / (spread * np.sqrt(lags + MEMORIES[0]))
    count = len(MEMORIES)
    alike = np.hstack([np.zeros((count, 1)), np.eye(count) / near[0], -np.eye(count) / near[1]])
    table = np.vstack([table * weight[:, None], ALIKE * alike])
    size = np.linalg.norm(table, axis=0)
    share, _ = scipy.optimize.nnls(table / size, np.append(
        (spread - white * period * lags) * weight, np.zeros(count)))
    share /= size
    apart = 1.0 - np.exp(-HORIZON / memory)
    return (share[0] + apart @ share[1:1 + count], white + apart @ share[1 + count:],
            (1.0 - apart) @ share[1 + count:])
