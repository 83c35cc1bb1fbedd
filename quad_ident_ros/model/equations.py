# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The equations of motion as the paper prints them, and their integration.

Parameter vector: Ix, Iy, Iz, Kfax, Kfay, Kfaz, Kftx, Kfty, Kftz, Jr, m, g, l. What follows from
eqs. (1)-(12) is in rigid_body.
"""

import math

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.model.vehicle import Vehicle

STATE = 12      # position, velocity (world), Euler angles, Euler rates


def parameter_vector(vehicle: Vehicle) -> np.ndarray:
    """Return the constants of the equations of motion, (13,), in the order stated above."""
    return np.array([*vehicle.inertia, *vehicle.rotational_drag, *vehicle.linear_drag,
                     vehicle.rotor_inertia, vehicle.mass, vehicle.gravity, vehicle.arm_length])


@compiled
def printed(x: np.ndarray, u: np.ndarray, omega_r: float, p: np.ndarray, dx: np.ndarray) -> None:
    """
    Write the derivative of the state into dx; the paper's eqs. (13)-(18) to the letter.

    State (12,): position and velocity in the world, Euler angles, Euler rates. `sin theta^2` in
    eq. (13) is read as sin^2(theta). What is wrong in these equations is listed in docs/paper.md.
    """
    ix, iy, iz = p[0], p[1], p[2]
    jr, m, g, arm = p[9], p[10], p[11], p[12]
    sp, cp = math.sin(x[6]), math.cos(x[6])
    st, ct = math.sin(x[7]), math.cos(x[7])
    ss, cs = math.sin(x[8]), math.cos(x[8])
    dp, dt, ds = x[9], x[10], x[11]
    thrust = u[0] / m
    wx, wy, wz = dp - ds * st, ds * sp * ct + dt * cp, ds * cp * ct - dt * sp
    for i in range(3):
        dx[i] = x[3 + i]
        dx[6 + i] = x[9 + i]
    dx[3] = (cp * cs * st + sp * ss) * thrust - p[6] * x[3] / m
    dx[4] = (ss * st * cp - cs * sp) * thrust - p[7] * x[4] / m
    dx[5] = -g + cp * ct * thrust - p[8] * x[5] / m
    dx[9] = (arm * u[1] / ix + (iy - iz) / ix * wz * wy - jr * omega_r / ix * wy
             - p[3] / ix * (dp * dp - 2 * dp * ds * st * st))
    dx[10] = (arm * u[2] / iy + (iz - ix) / iy * wz * wx - jr * omega_r / iy * (ds * st - dp)
              - p[4] / iy * (dt * dt * cp * cp + 2 * dp * ds * sp * cp * ct
                             + ds * ds * sp * sp * ct * ct))
    dx[11] = (u[3] / iz + (ix - iy) / iz * wy * wx - jr * omega_r / iy * (ds * st - dp)
              - (dt * dt * sp * sp - 2 * dp * ds * sp * cp * ct)
              + p[5] / iz * ds * ds * cp * cp * ct * ct)


@compiled
def rk4(x: np.ndarray, inputs: np.ndarray, omega_r: np.ndarray, p: np.ndarray, period: float,
        substeps: int, rate_limit: float, out: np.ndarray) -> tuple[int, float]:
    """
    Integrate by classical Runge-Kutta, writing the state at each sample into out (N, 12).

    Input row k (N, 4) is held from sample k to k + 1. Stops where a rate exceeds rate_limit
    (rad/s) or a state is no finite number. Returns the count of samples written and the time
    reached, s.
    """
    size = x.size
    h = period / substeps
    k1, k2, k3, k4 = np.empty(size), np.empty(size), np.empty(size), np.empty(size)
    y = np.empty(size)
    out[0] = x
    for k in range(inputs.shape[0] - 1):
        u = inputs[k]
        for s in range(substeps):
            printed(x, u, omega_r[k], p, k1)
            for i in range(size):
                y[i] = x[i] + 0.5 * h * k1[i]
            printed(y, u, omega_r[k], p, k2)
            for i in range(size):
                y[i] = x[i] + 0.5 * h * k2[i]
            printed(y, u, omega_r[k], p, k3)
            for i in range(size):
                y[i] = x[i] + h * k3[i]
            printed(y, u, omega_r[k], p, k4)
            for i in range(size):
                x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
            rate = max(abs(x[size - 3]), abs(x[size - 2]), abs(x[size - 1]))
            size_of_all = 0.0
            for i in range(size):
                size_of_all += abs(x[i])
            # The comparisons are written so that a state that is no number stops the run too.
            if not (rate <= rate_limit and size_of_all < math.inf):
                return k + 1, (k * substeps + s + 1) * h
        out[k + 1] = x
    return inputs.shape[0], (inputs.shape[0] - 1) * period
