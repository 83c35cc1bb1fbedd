# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records of what was measured, and what goes wrong in records of real flights."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

STATES = ('px', 'py', 'pz', 'vx', 'vy', 'vz', 'qx', 'qy', 'qz', 'qw', 'wx', 'wy', 'wz')


@dataclass(frozen=True)
class Faults:
    """
    What is wrong with a record.

    lost: share of the rows; offset s and drift (s/s) of the clock of the states against that of
    the commands; glitches: share of the rows whose attitude jumps; voltage: whether it is
    recorded.
    """

    lost: float = 0.0
    offset: float = 0.0
    drift: float = 0.0
    glitches: float = 0.0
    voltage: bool = True


def draw_faults(rng):
    """Return the Faults of one flight: each flight has its own clocks."""
    return Faults(lost=rng.uniform(0.01, 0.08), drift=rng.uniform(-1e-4, 1e-4),
                  offset=rng.choice([-1.0, 1.0]) * rng.uniform(0.01, 0.03),
                  glitches=rng.uniform(0.0005, 0.002), voltage=False)


def record_of(flown, faults, rng):
    """Return the columns of a flight record, {name: (N,)}."""
    t = flown.step * np.arange(len(flown.measured))
    states = flown.measured.copy()
    if faults.offset or faults.drift:
        states = _late(t, states, faults.offset + faults.drift * t)
    jumps = rng.random(len(t)) < faults.glitches
    if jumps.any():
        states[jumps, 6:10] = (Rotation.from_quat(states[jumps, 6:10]) * Rotation.from_rotvec(
            rng.normal(0.0, 0.2, (jumps.sum(), 3)))).as_quat()
    columns = {'t': t, **dict(zip(STATES, states.T, strict=True))}
    columns |= {f'cmd{j + 1}': column for j, column in enumerate(flown.commands.T)}
    if faults.voltage:
        columns['vbat'] = np.round(flown.voltage + rng.normal(0.0, 0.005, len(t)), 3)
    if not faults.lost:
        return columns
    kept = np.ones(len(t), bool)
    while kept.mean() > 1.0 - faults.lost:
        k = int(rng.integers(1, len(t) - 1))
        kept[k:k + int(rng.geometric(0.4))] = False
    return {name: values[kept] for name, values in columns.items()}


def _late(t, states, late):
    """
    Return states that are recorded `late` s (N,) after they were.

    By a cubic spline: a straight line between two samples would smooth them as no clock does.
    """
    q = states[:, 6:10] * np.cumprod(np.where(np.concatenate(
        [[1.0], np.sum(states[1:, 6:10] * states[:-1, 6:10], axis=1)]) < 0, -1.0, 1.0))[:, None]
    states = np.concatenate([states[:, :6], q, states[:, 10:]], axis=1)
    out = CubicSpline(t, states)(np.clip(t - late, t[0], t[-1]))
    out[:, 6:10] /= np.linalg.norm(out[:, 6:10], axis=1, keepdims=True)
    return out


def csv_text(columns):
    """Return the text of a flight record."""
    lines = [','.join(columns)]
    rows = np.stack(list(columns.values()), axis=1)
    lines += [','.join(f'{value:.9g}' for value in row) for row in rows]
    return '\n'.join(lines) + '\n'
