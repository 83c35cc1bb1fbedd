# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether moments about x and y are moments, or the forces U2 and U3 of the paper."""

import numpy as np

from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import correlation, Grid
from quad_ident_ros.data.record import ARM, FlightRecord, MOMENTS
from quad_ident_ros.model.vehicle import Vehicle

FORCES = 'moments_as_forces'
"""Info of a record: the moments of its input were taken for U2 and U3, by their size."""

SURE = 0.7        # correlation of what was commanded with what turned the body
LONGEST = 0.4     # m of arm, up to which the two units are farther apart than NEAR is wide
NEAR = 1.35       # of a factor about a unit's: beyond a third, it may be the file's inertia
SLOW = 1.0        # s; what changes more slowly is trim and aerodynamics
LATEST = 0.08     # s that motors follow their commands within


def are_forces(record: FlightRecord, vehicle: Vehicle) -> bool:
    """Return whether moment_x, moment_y turn the body as forces (N) at the arm length would."""
    arm = vehicle.arm_length
    factor = _factor(record, vehicle, MOMENTS)
    return factor is not None and arm <= LONGEST and _near(factor, arm)


def unit(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find moments that are forces at the arm, U2 and U3 that are moments, or come from forces."""
    if record.info.get(FORCES):
        return [Finding(
            'input_unit', 'warning', 'input',
            'the moments about x and y are, by what they turn, forces at the arm length (N), as '
            'earlier versions published them; they are taken for U2 and U3',
            'publish the torque of the WrenchStamped in N m')]
    if vehicle is None or not record.has('u2', 'u3') or vehicle.arm_length > LONGEST:
        return []
    arm = vehicle.arm_length
    factor = _factor(record, vehicle, ('u2', 'u3'))
    severity = 'warning' if record.has('cmd1') else 'error'
    if factor is not None and ARM in record.info and _near(factor, arm * arm):
        return [Finding(
            'input_unit', severity, 'u2, u3',
            f'they turn {vehicle.name} like forces that were divided by its arm length, '
            f'{arm:.3g} m, a second time: the torque they come from was already a force (N)',
            'publish the torque of the WrenchStamped in N m')]
    if factor is None or not _near(factor, 1.0):
        return []
    return [Finding(
        'input_unit', severity, 'u2, u3',
        f'they turn {vehicle.name} as moments in N m would, not as forces at its arms of '
        f'{arm:.3g} m',
        'name the columns moment_x and moment_y, or divide them by the arm length')]


def _near(factor: float, usual: float) -> bool:
    return bool(usual / NEAR < factor < usual * NEAR)


def _factor(record: FlightRecord, vehicle: Vehicle, names: tuple[str, ...]) -> float | None:
    """Return the moment on the body over what two columns say of it, None where that is open."""
    grid = Grid.of(record)
    if grid is None or not record.has(*names, 'wx', 'wy', 'wz'):
        return None
    rate = grid.smooth(grid.signal('wx', 'wy', 'wz'))
    inertia = vehicle.inertia_matrix
    # Fast turns, as after the paper's steps, are held up by the air.
    turned = (np.gradient(rate, grid.period, axis=0) @ inertia + np.cross(rate, rate @ inertia)
              + np.array(vehicle.rotational_drag) * np.abs(rate) * rate)[:, :2]
    given = grid.smooth(grid.held(*names))
    # Fast parts know no trim and no drag; steps that a flight begins with have none.
    for one, other in ((_fast(grid, turned), _fast(grid, given)), (turned, given)):
        alike, factor = max(_aligned(grid, one, other, lag)
                            for lag in range(round(LATEST / grid.period) + 1))
        if alike >= SURE:
            return factor
    return None


def _fast(grid: Grid, signal: np.ndarray) -> np.ndarray:
    return signal - grid.smooth(signal, SLOW)


def _aligned(grid: Grid, turned: np.ndarray, given: np.ndarray, lag: int) -> tuple[float, float]:
    """Return the correlation of moments and what was given lag samples before, and the slope."""
    index = np.flatnonzero(grid.good)
    index = index[index >= lag]
    return correlation(turned[index], given[index - lag])
