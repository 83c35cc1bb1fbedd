# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Between the inputs U1..U4 and the rotor speeds: the paper's eqs. (9) and (19)."""

import numpy as np
from scipy.optimize import nnls


def allocation_matrix(vehicle):
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


def squared_speeds(vehicle, inputs):
    """
    Return the squared rotor speeds that give inputs, (N, n); negative where none can.

    Args: inputs (N, 4) U1..U4. Of all solutions the smallest is taken, non-negative where there
    is one.
    """
    matrix = allocation_matrix(vehicle)
    squared = np.asarray(inputs, float) @ np.linalg.pinv(matrix).T
    if len(vehicle.rotors) > 4:
        scale = np.abs(matrix).max(axis=1)
        for k in np.flatnonzero(squared.min(axis=1) < 0):
            solution, residual = nnls(matrix / scale[:, None], inputs[k] / scale)
            if residual < 1e-6 * np.linalg.norm(inputs[k] / scale):
                squared[k] = solution
    return squared


def infeasibility(vehicle, inputs, t):
    """
    Say why no rotor speeds give these inputs, or return None where some do.

    Args: inputs (N, 4) U1..U4; t (N,) s.
    """
    squared = squared_speeds(vehicle, inputs)
    slack = 1e-9 * max(1.0, float(np.abs(squared).max()))
    low = vehicle.speed_min ** 2 - slack
    high = vehicle.speed_max ** 2 + slack
    bad = (squared < low) | (squared > high)
    if not bad.any():
        return None
    k = int(np.argmax(bad.any(axis=1)))
    rotor = int(np.argmax(bad[k]))
    values = ', '.join(f'{u:g}' for u in inputs[k])
    return (f'no rotor speeds give U = ({values}) at t = {t[k]:g} s: rotor {rotor + 1} would need '
            f'a squared speed of {squared[k, rotor]:.6g} (rad/s)^2, possible are '
            f'{vehicle.speed_min ** 2:.6g} to {vehicle.speed_max ** 2:.6g}')


def residual_rotor_speed(vehicle, inputs):
    """
    Return Omega_r, the signed sum of the rotor speeds, (N,) rad/s.

    Source: eq. (11), w1 - w2 + w3 - w4, here the sum of spin * w. Inputs must be feasible.
    """
    spin = np.array([rotor.spin for rotor in vehicle.rotors])
    return np.sqrt(np.maximum(squared_speeds(vehicle, inputs), 0.0)) @ spin
