# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Between the inputs U1..U4 and the rotor speeds: the paper's eqs. (9) and (19)."""

import numpy as np
from numpy.typing import ArrayLike
import scipy

from quad_ident_ros.model.vehicle import Vehicle

RESIDUAL = 1e-6   # share of the inputs by which speeds that give them may miss


def allocation_matrix(vehicle: Vehicle) -> np.ndarray:
    """
    Return the matrix that gives U1..U4 from the squared rotor speeds, (4, n).

    U1 (N) is the thrust, U2 and U3 (N) the roll and pitch moments over the arm length, U4 (N m)
    the yaw moment. Source: eq. (19), for any number of rotors at any place.
    """
    position = np.array([rotor.position for rotor in vehicle.rotors])
    spin = np.array([rotor.spin for rotor in vehicle.rotors])
    thrust = np.full(len(spin), vehicle.thrust_coefficient)
    return np.stack([thrust, thrust * position[:, 1] / vehicle.arm_length,
                     -thrust * position[:, 0] / vehicle.arm_length,
                     vehicle.torque_coefficient * spin])


def squared_speeds(vehicle: Vehicle, inputs: ArrayLike) -> np.ndarray:
    """
    Return squared rotor speeds that give inputs, (N, n); see infeasibility where none can.

    Args: inputs (N, 4) U1..U4. Of all solutions the smallest is taken, unless it leaves the
    speed limits and another one does not.
    """
    inputs = np.asarray(inputs, float)
    matrix = allocation_matrix(vehicle)
    squared = inputs @ np.linalg.pinv(matrix).T
    if len(vehicle.rotors) > 4:
        scale = np.abs(matrix).max(axis=1)
        bounds = (vehicle.speed_min ** 2, vehicle.speed_max ** 2)
        outside = np.flatnonzero(((squared < bounds[0]) | (squared > bounds[1])).any(axis=1))
        # Inputs are mostly held for many samples: each is solved for once.
        values, which = np.unique(inputs[outside], axis=0, return_inverse=True)
        for k, value in enumerate(values / scale):
            found = scipy.optimize.lsq_linear(matrix / scale[:, None], value, bounds,
                                              method='bvls')
            if np.linalg.norm(found.fun) <= RESIDUAL * np.linalg.norm(value):
                squared[outside[which.ravel() == k]] = found.x
    return squared


def infeasibility(vehicle: Vehicle, inputs: ArrayLike, t: np.ndarray) -> str | None:
    """
    Say why no rotor speeds give these inputs, or return None where some do.

    Args: inputs (N, 4) U1..U4; t (N,) s.
    """
    inputs = np.asarray(inputs, float)
    matrix = allocation_matrix(vehicle)
    scale = np.abs(matrix).max(axis=1)
    squared = squared_speeds(vehicle, inputs)
    bad = _beyond(vehicle, squared)
    missed = np.linalg.norm((squared @ matrix.T - inputs) / scale, axis=1)
    unreachable = missed > RESIDUAL * np.linalg.norm(inputs / scale, axis=1)
    failing = bad.any(axis=1) | unreachable
    if not failing.any():
        return None
    k = int(np.argmax(failing))
    values = ', '.join(f'{u:g}' for u in inputs[k])
    problem = f'no rotor speeds give U = ({values}) at t = {t[k]:g} s: '
    if unreachable[k]:
        return problem + f'the {len(vehicle.rotors)} rotors, as they are placed and spin, cannot'
    rotor = int(np.argmax(bad[k]))
    return (f'{problem}rotor {rotor + 1} would need a squared speed of {squared[k, rotor]:.6g} '
            f'(rad/s)^2, which must be {vehicle.speed_min ** 2:.6g} to '
            f'{vehicle.speed_max ** 2:.6g}')


def beyond_limits(vehicle: Vehicle, inputs: ArrayLike) -> np.ndarray:
    """
    Return where inputs ask a rotor for a speed beyond speed_min and speed_max, (N,) of bool.

    Args: inputs (N, 4) U1..U4.
    """
    return np.asarray(_beyond(vehicle, squared_speeds(vehicle, inputs)).any(axis=1))


def _beyond(vehicle: Vehicle, squared: np.ndarray) -> np.ndarray:
    """Return which squared speeds (N, n) are beyond the limits, but for rounding."""
    slack = 1e-9 * max(1.0, float(np.abs(squared).max()))
    low: np.ndarray = squared < vehicle.speed_min ** 2 - slack
    high: np.ndarray = squared > vehicle.speed_max ** 2 + slack
    return low | high


def residual_rotor_speed(vehicle: Vehicle, inputs: ArrayLike) -> np.ndarray:
    """
    Return Omega_r, the signed sum of the rotor speeds, (N,) rad/s.

    Source: eq. (11), w1 - w2 + w3 - w4, here the sum of spin * w. Inputs must be feasible.
    """
    spin = np.array([rotor.spin for rotor in vehicle.rotors])
    return np.sqrt(np.maximum(squared_speeds(vehicle, inputs), 0.0)) @ spin
