# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Lag and delay of the motors of a Crazyflie by its accelerometer alone, beside the published lag.

`.venv/bin/python -m docs.motor_lag FOLDER` writes the table into docs/real_flights.md; FOLDER has
crazyflie_usd. The force of the rotors is 1, u, u^2 of signals u that follow the commands with a
first-order lag, as in Eschmann et al. 2024 (arXiv 2404.07837); a delay before it, and the low pass
of the accelerometer in the vehicle's firmware, are what the paper does not have. Each lag is also
one of the moments, and so gives an inertia about x and y.
"""

from collections.abc import Callable
from pathlib import Path
import sys

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import butter, lfilter, sosfiltfilt

from benchmarks.tables import keep, markdown
from quad_ident_ros.data.load import load

STEP = 1e-3             # s, of the log
MASS = 0.027            # kg
SLICE = 35.0, 65.0      # s of the log's clock, the paper's slice for the thrust
BLOCK = 3.0             # s over which errors may be correlated
ACCELEROMETER = 30.0    # Hz, second order: sensors_bmi088_bmp388.c of the firmware
FULL = 65535.0          # of the duty
ARM = 0.028             # m
TURNING = 2.0, 15.0     # Hz: slower, the air turns the body too; faster, the gyro is noise
SIDES = np.array([[-1, -1, 1, 1], [-1, 1, 1, -1]])      # moments about x and y of m1 to m4


def main(folder: str) -> None:
    """Fit the lag in four ways, and write the table."""
    record = load(Path(folder) / 'crazyflie_usd' / 'log10')
    t = np.arange(record.t[0], record.t[-1], STEP)
    held = np.searchsorted(record.t, t, side='right') - 1
    signals = record.stack('output1', 'output2', 'output3', 'output4')[held] / FULL
    force = MASS * np.interp(t, record.t, record.columns['az'])
    clock = t + record.info['start_ns'] * 1e-9
    used = (clock > SLICE[0]) & (clock < SLICE[1])
    rows = []
    for title, delayed, cutoff in (
            ('lag, as in the paper', False, None), ('lag and delay', True, None),
            ('lag, low pass of the accelerometer', False, ACCELEROMETER),
            ('lag, delay, low pass of the accelerometer', True, ACCELEROMETER)):
        def terms(parameters: np.ndarray, cutoff: float | None = cutoff) -> np.ndarray:
            return _terms(t, signals, parameters, cutoff)[used]

        found, std, rms, curve = _fitted(terms, force[used], t[used], delayed)
        inertia, along = _inertia(_followed(t, signals, found), curve, record.stack('wx', 'wy'),
                                  np.searchsorted(record.t, t), used)
        rows.append((title, f'{1e3 * found[0]:.1f} ± {1e3 * std[0]:.1f}',
                     f'{1e3 * found[1]:.1f} ± {1e3 * std[1]:.1f}' if delayed else '–',
                     f'{1e3 * rms:.2f}', ', '.join(f'{value:.4f}' for value in curve),
                     *(f'{1e6 * value:.1f} ({share:.2f})'
                       for value, share in zip(inertia, along, strict=True))))
    keep('real_flights.md', 'motor_lag', markdown(
        ('model', 'time constant, ms', 'delay, ms', 'rms of the force left, mN',
         'thrust of a rotor, N: 1, u, u²', 'Ixx, 1e-6 kg m² (correlation)', 'Iyy'), rows))


def _inertia(u: np.ndarray, curve: np.ndarray, rates: np.ndarray, at: np.ndarray,
             used: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Return the inertia about x and y, kg m^2, and how moments and accelerations correlate.

    It is the ratio of their spread, as both are with errors. Args: u (N, 4) signals that the
    rotors have reached; curve of the thrust; rates (M, 2), rad/s, and the sample at each time.
    """
    band = butter(2, np.array(TURNING) * 2.0 * STEP, 'bandpass', output='sos')
    moments = ARM * (curve[0] + curve[1] * u + curve[2] * u ** 2) @ SIDES.T
    turning = sosfiltfilt(band, np.gradient(rates[at], STEP, axis=0), axis=0)[used]
    moments = sosfiltfilt(band, moments, axis=0)[used]
    along = np.sum(moments * turning, axis=0)
    spread = np.linalg.norm(moments, axis=0), np.linalg.norm(turning, axis=0)
    return spread[0] / spread[1], along / (spread[0] * spread[1])


def _terms(t: np.ndarray, signals: np.ndarray, parameters: np.ndarray,
           cutoff: float | None) -> np.ndarray:
    """Return the terms (N, 3) of the force, by time constant and delay (s) of the signals."""
    u = _followed(t, signals, parameters)
    terms = np.stack([np.full(len(u), 4.0), u.sum(axis=1), (u ** 2).sum(axis=1)], axis=1)
    if cutoff is None:
        return terms
    return lfilter(*butter(2, 2.0 * STEP * cutoff), terms, axis=0)


def _followed(t: np.ndarray, signals: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """Return the signals (N, 4) that the rotors have reached, by time constant and delay (s)."""
    lag, *delay = parameters
    if delay:
        signals = np.stack([np.interp(t - delay[0], t, one) for one in signals.T], axis=1)
    kept = np.exp(-STEP / lag)
    return lfilter([1 - kept], [1, -kept], signals, axis=0, zi=kept * signals[:1])[0]


def _fitted(terms: Callable[[np.ndarray], np.ndarray], force: np.ndarray, t: np.ndarray,
            delayed: bool) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
    """Return the parameters, their standard errors, the rms that is left, N, and the curve."""
    def curve(parameters: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(terms(parameters), force, rcond=None)[0]

    def left(parameters: np.ndarray) -> np.ndarray:
        return force - terms(parameters) @ curve(parameters)

    start = [0.06, 0.01] if delayed else [0.06]
    best = least_squares(left, start, diff_step=1e-2, bounds=(0.0, 0.3), x_scale=0.01)
    # The residuals are not white noise: errors within a block may be correlated.
    blocks = (t // BLOCK).astype(int)
    slopes = np.stack([best.jac[blocks == one].T @ best.fun[blocks == one]
                       for one in np.unique(blocks)])
    spread = np.linalg.inv(best.jac.T @ best.jac)
    std = np.sqrt(np.diag(spread @ slopes.T @ slopes @ spread))
    return best.x, std, float(best.fun.std()), curve(best.x)


if __name__ == '__main__':
    main(*sys.argv[1:])
