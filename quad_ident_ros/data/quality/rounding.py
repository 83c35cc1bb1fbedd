# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Commands that were rounded to steps as large as what they change by."""

import numpy as np

from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import Grid
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle

FEWEST = 5      # levels: fewer may be those of an experiment
OFTEN = 10.0    # times that a level comes in the mean, at least: more than by chance
EVEN = 3.0      # times the 10th percentile of the steps is the 90th, at most: the curve of a motor
                # makes rounded signals uneven, a command that is held until the next far more so
SLOW = 1.0      # s; what changes more slowly is trim, which rounding leaves right in the mean
COARSE = 0.01   # of the variance: a regression on commands with such errors comes out too small
                # by as much (Fuller, Measurement Error Models, section 1.1.1, 1987)


def commands(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find rotor speed commands whose rounding is a part of what they change by within 1 s."""
    names, grid = record.numbered('cmd'), Grid.of(record)
    if grid is None or not names:
        return []
    given = grid.held(*names)
    fast = np.std((given - grid.smooth(given, 2.0 * SLOW))[grid.good], axis=0)
    steps = np.array([_step(record.columns[name]) for name in names])
    if not (np.all(steps > 0.0) and np.all(fast > 0.0)):
        return []
    share = float(np.median(steps ** 2 / 12.0 / fast ** 2))     # uniform within a step
    if share < COARSE:
        return []
    return [Finding(
        'coarse_commands', 'warning', f'{names[0]} to {names[-1]}',
        f'they are rounded to steps of {np.median(steps):.3g}, which is '
        f'{100.0 * min(share, 1.0):.0f} % of the variance within a second: the vehicle seems to '
        'answer later, and less, than it does',
        'log the commands as the controller gives them, not rounded; or fly more briskly')]


def _step(values: np.ndarray) -> float:
    """Return the step between the levels of values (N,), 0 where they are not rounded."""
    levels = np.unique(values[np.isfinite(values)])
    if len(levels) < FEWEST or OFTEN * len(levels) > len(values):
        return 0.0
    low, middle, high = np.percentile(np.diff(levels), [10.0, 50.0, 90.0])
    return float(middle) if high <= EVEN * low else 0.0
