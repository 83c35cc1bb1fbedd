# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Delay and lag between the commanded and the actual speed of the rotors."""

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import SLICES

DELAY, LAG = SLICES['actuation_delay'].start, SLICES['motor_lag'].start


def delayed(t, commands, delay):
    """
    Return what the rotors follow from each sample to the next, (N, n) rad/s.

    Args: t (N,) s; commands (N, n) rad/s, each held to the next; delay s, negative where the
    clock of the commands is late. Where a command changes between two samples its root mean square
    is taken, which has the mean thrust; before the first one the first is held, after the last
    one the last.
    """
    if delay == 0.0:
        return commands
    steps = np.diff(t)
    squares = commands ** 2
    # The time integral of the held command's square, of which differences are means.
    beyond = abs(delay) + 1.0
    widths = np.concatenate([[beyond], steps, [beyond]])[:, None]
    held = np.concatenate([squares[:1], squares])
    area = np.concatenate([np.zeros_like(squares[:1]), np.cumsum(held * widths, axis=0)])
    at = np.concatenate([[t[0] - beyond], t, [t[-1] + beyond]])
    shifted = np.stack([np.interp(t - delay, at, column) for column in area.T], axis=1)
    means = np.sqrt(np.maximum(np.diff(shifted, axis=0) / steps[:, None], 0.0))
    return np.concatenate([means, means[-1:]])


@compiled
def lagged(t, commands, time_constant):
    """
    Return the speed of the rotors at each sample, (N, n) rad/s, from rest at the first command.

    Args: t (N,) s; commands (N, n) rad/s, each held to the next; time_constant s of the lag.
    """
    speeds = commands.copy()
    if time_constant > 0.0:
        for k in range(len(t) - 1):
            left = np.exp(-(t[k + 1] - t[k]) / time_constant)
            for j in range(commands.shape[1]):
                speeds[k + 1, j] = commands[k, j] + (speeds[k, j] - commands[k, j]) * left
    return speeds


def actuated(t, commands, thetas):
    """
    Return what the rotors follow and how fast they turn at each sample, both (T, N, n) rad/s.

    Args: t (N,) s; commands (N, n) rad/s; thetas (T, P) parameter sets.
    """
    found = {}
    followed = np.empty((len(thetas), *commands.shape))
    speeds = np.empty_like(followed)
    for k, theta in enumerate(thetas):
        key = (theta[DELAY], theta[LAG])
        if key not in found:
            command = np.ascontiguousarray(delayed(t, commands, theta[DELAY]))
            found[key] = command, lagged(t, command, theta[LAG])
        followed[k], speeds[k] = found[key]
    return followed, speeds
