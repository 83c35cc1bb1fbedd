# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bandwidth of a closed loop: the frequency at which the path falls to 0.707 of what is asked."""

import numpy as np
import scipy

AXES = ('x', 'y', 'z', 'yaw')
HALF_POWER = 0.5 ** 0.5
PERIOD = 20.0           # s of the multisine, whose lines are 1 / PERIOD apart
LOWEST, HIGHEST = 0.1, 8.0      # Hz: below, loops follow; above, vehicles do not
STRENGTH = 0.03         # m/s^2 and rad/s^2 rms: tilts by a milliradian, so that the loop is linear
SEGMENT = 10.0          # s of the spectra of a flight
COHERENT = 0.8          # of a flight: below, noise is more than a quarter of what is asked for


def multisine(rate: float) -> np.ndarray:
    """
    Return x, y, z, yaw (N, 4), m and rad, over two PERIODs: lines of all axes in turn.

    Each axis has every fourth line between LOWEST and HIGHEST, of the same acceleration, so that
    one flight separates all axes (Pintelon and Schoukens, System Identification, 2012, 2.7).
    """
    t = np.arange(int(2 * PERIOD * rate + 1e-6)) / rate
    rng = np.random.default_rng(0)
    path = np.zeros((len(t), len(AXES)))
    for axis in range(len(AXES)):
        lines = 2.0 * np.pi * _lines(axis) / PERIOD
        size = STRENGTH * np.sqrt(2.0 / len(lines)) / lines ** 2
        phases = rng.uniform(0.0, 2.0 * np.pi, len(lines))
        path[:, axis] = np.sin(np.outer(t, lines) + phases) @ size
    return path


def bandwidth_of_multisine(asked: np.ndarray, flown: np.ndarray) -> dict[str, float | None]:
    """
    Return {axis: bandwidth, Hz} by the second period of a multisine (N, 4) and the path flown.

    Either may be half the difference of two flights with opposite signs: what both have, as the
    sag of a battery or the yaw that a tilt about two axes makes, is none of the answer. None
    where the loop follows beyond HIGHEST.
    """
    half = len(asked) // 2
    spectra = [np.fft.rfft(each[half:2 * half], axis=0) for each in (asked, flown)]
    found = {}
    for axis, name in enumerate(AXES):
        lines = _lines(axis)
        gains = np.abs(spectra[1][lines, axis] / spectra[0][lines, axis])
        found[name] = crossing(lines / PERIOD, gains)
    return found


def bandwidth_of_flight(asked: np.ndarray, flown: np.ndarray, rate: float
                        ) -> dict[str, float | None]:
    """
    Return {axis: bandwidth, Hz} of a flight (N, 4) at rate Hz by its spectra.

    None where the flight does not ask for enough at frequencies up to there, by coherence.
    """
    count = min(len(asked) // 2, int(SEGMENT * rate))
    found: dict[str, float | None] = {}
    for axis, name in enumerate(AXES):
        pair = asked[:, axis] - asked[:, axis].mean(), flown[:, axis] - flown[:, axis].mean()
        f, across = scipy.signal.csd(*pair, fs=rate, nperseg=count)
        powers = [scipy.signal.welch(each, fs=rate, nperseg=count)[1] for each in pair]
        coherent = np.abs(across) ** 2 >= COHERENT * powers[0] * powers[1]
        end = len(f) if coherent[1:].all() else 1 + int(np.argmin(coherent[1:]))
        gains = np.abs(across[1:end]) / np.maximum(powers[0][1:end], 1e-300)
        found[name] = crossing(f[1:end], gains) if powers[0].any() else None
    return found


def crossing(f: np.ndarray, gains: np.ndarray) -> float | None:
    """Return the first frequency (Hz) at which gains over f fall to HALF_POWER, or None."""
    below = np.flatnonzero(gains < HALF_POWER)
    if not len(below):
        return None
    k = int(below[0])
    if k == 0:
        return float(f[0])
    share = np.log(gains[k - 1] / HALF_POWER) / np.log(gains[k - 1] / gains[k])
    return float(f[k - 1] * (f[k] / f[k - 1]) ** share)


def _lines(axis: int) -> np.ndarray:
    """Return the numbers of the lines of an axis."""
    return np.arange(int(LOWEST * PERIOD) + axis, int(HIGHEST * PERIOD), len(AXES))
