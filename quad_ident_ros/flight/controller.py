# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Geometric tracking control on SO(3), for the nominal vehicle.

Source: Lee, Leok, McClamroch, CDC 2010, eqs. (12) to (20), with integrals of position and attitude
error as Goodarzi, Lee, Lee, ECC 2013. The change of the desired rate is left out.
"""

import math
from typing import Protocol

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.mixing import allocation_matrix
from quad_ident_ros.model.vehicle import Vehicle

WANTED = 14     # position, velocity, acceleration, jerk (3 each), yaw, yaw rate
SEEN = 18       # position, velocity, rotation matrix by rows, rate
MEMORY = 6      # integrals of the errors of position and attitude
POSITION_PACE, YAW_PACE = 2.0, 3.0      # rad/s, of the closed loops
DAMPING = 0.85
STEEPEST = 2.0  # force across the vertical that is asked for, in weights
LIGHTEST = 0.4  # force along it

(MASS, IX, IY, IZ, GRAVITY, KP, KV, KI, TILT_P, TILT_V, TILT_I, YAW_P, YAW_V, YAW_I, MOST_PUSH,
 MOST_X, MOST_Y, MOST_Z, SQUARE_MIN, SQUARE_MAX, IXY, IXZ, IYZ, GAINS) = range(24)


def gains_of(vehicle: Vehicle) -> np.ndarray:
    """
    Return the controller's constants (GAINS,) for a vehicle.

    The gains act on accelerations, of the body and of its turning, so that they need no tuning to
    mass and inertia; smaller vehicles, which disturbances turn faster, have faster attitude loops.
    """
    gains = np.empty(GAINS)
    gains[[MASS, GRAVITY]] = vehicle.mass, vehicle.gravity
    gains[IX:IZ + 1] = vehicle.inertia
    tilt = float(np.clip(8.0 * (0.2 / vehicle.arm_length) ** 0.25, 6.0, 12.0))
    for first, pace in ((KP, POSITION_PACE), (TILT_P, tilt), (YAW_P, YAW_PACE)):
        gains[first:first + 3] = pace ** 2, 2 * DAMPING * pace, 0.25 * pace ** 3
    # What the integrals may grow to: half the weight, and as much at half an arm.
    gains[MOST_PUSH] = 0.5 * vehicle.gravity
    gains[MOST_X:MOST_Z + 1] = (0.25 * vehicle.mass * vehicle.gravity * vehicle.arm_length
                                / np.array(vehicle.inertia))
    gains[IXY:IYZ + 1] = vehicle.products
    gains[[SQUARE_MIN, SQUARE_MAX]] = vehicle.speed_min ** 2, vehicle.speed_max ** 2
    return gains


def mixer_of(vehicle: Vehicle) -> np.ndarray:
    """
    Return the squared rotor speeds per thrust (N) and moments (N m), (n, 4).

    Raises InputError where the rotors cannot give the four of them independently.
    """
    matrix = allocation_matrix(vehicle) * [[1.0], [vehicle.arm_length], [vehicle.arm_length],
                                           [1.0]]
    scale = np.abs(matrix).max(axis=1, keepdims=True)
    if np.linalg.matrix_rank(matrix / np.where(scale > 0, scale, 1.0), 1e-6) < 4:
        raise InputError(f'vehicle {vehicle.name}: its {len(vehicle.rotors)} rotors, as they are '
                         'placed and spin, cannot give thrust, roll, pitch and yaw moments '
                         'independently; check their positions and spins')
    return np.linalg.pinv(matrix)


class Controller(Protocol):
    """What closes the loop."""

    def reset(self) -> None:
        """Begin a flight, in hover."""

    def control(self, seen: np.ndarray, wanted: np.ndarray, dt: float, command: np.ndarray
                ) -> None:
        """Write rotor speeds (n,) rad/s; see control."""


class Tracking:
    """The controller of a vehicle: what it sees and what is wanted to rotor speeds, over time."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._gains, self._mixer = gains_of(vehicle), mixer_of(vehicle)
        self._memory = np.zeros(MEMORY)

    def reset(self) -> None:
        """Forget what was flown."""
        self._memory[:] = 0.0

    def control(self, seen: np.ndarray, wanted: np.ndarray, dt: float, command: np.ndarray
                ) -> None:
        """Write rotor speeds command (n,) rad/s for what is SEEN and WANTED; dt s since."""
        control(seen, wanted, dt, *self.numbers, command)

    @property
    def numbers(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return gains (GAINS,), mixer (n, 4) and memory (MEMORY,), as control takes them."""
        return self._gains, self._mixer, self._memory


@compiled
def _clamp(value: float, most: float) -> float:
    return min(max(value, -most), most)


@compiled
def control(seen: np.ndarray, wanted: np.ndarray, dt: float, gains: np.ndarray, mixer: np.ndarray,
            memory: np.ndarray, command: np.ndarray) -> None:
    """Write rotor speeds command (n,) rad/s for what is SEEN and WANTED; dt s since the last."""
    g = gains
    rotation = seen[6:15].reshape(3, 3)
    rate = seen[15:18]
    push = np.empty(3)
    for i in range(3):
        error = seen[i] - wanted[i]
        memory[i] = _clamp(memory[i] + g[KI] * error * dt, g[MOST_PUSH])
        push[i] = (-g[KP] * error - g[KV] * (seen[3 + i] - wanted[3 + i]) - memory[i]
                   + wanted[6 + i])
    across = math.hypot(push[0], push[1])
    if across > STEEPEST * g[GRAVITY]:
        push[:2] *= STEEPEST * g[GRAVITY] / across
    # To fall faster would leave the rotors nothing to turn the vehicle with.
    push[2] = max(push[2] + g[GRAVITY], LIGHTEST * g[GRAVITY])
    strength = math.sqrt(push[0] ** 2 + push[1] ** 2 + push[2] ** 2)
    desired = np.empty((3, 3))      # columns: the desired body axes
    up = push / strength
    desired[:, 2] = up
    ahead = np.array([math.cos(wanted[12]), math.sin(wanted[12]), 0.0])
    left = np.cross(up, ahead)
    left /= math.sqrt(left[0] ** 2 + left[1] ** 2 + left[2] ** 2)
    desired[:, 1] = left
    desired[:, 0] = np.cross(left, up)
    jerk = wanted[9:12]
    swing = np.array([-left[0] * jerk[0] - left[1] * jerk[1] - left[2] * jerk[2],
                      desired[0, 0] * jerk[0] + desired[1, 0] * jerk[1]
                      + desired[2, 0] * jerk[2], 0.0]) / strength
    swing[2] = wanted[13] * up[2]
    lift = g[MASS] * max(push[0] * rotation[0, 2] + push[1] * rotation[1, 2]
                         + push[2] * rotation[2, 2], 0.0)
    # What turns a vehicle steadily, a weak rotor or a mass off its centre, grows with the thrust.
    load = lift / (g[MASS] * g[GRAVITY])
    between = desired.T @ rotation
    aim = between.T @ swing         # the desired rate, in the body
    turn, asked = np.empty(3), np.empty(3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        error = 0.5 * (between[k, j] - between[j, k])
        first = TILT_P if i < 2 else YAW_P
        memory[3 + i] = _clamp(memory[3 + i] + g[first + 2] * error * dt, g[MOST_X + i])
        turn[i] = -g[first] * error - g[first + 1] * (rate[i] - aim[i]) - load * memory[3 + i]
        asked[i] = turn[i]
        turn[i] = g[IX + i] * turn[i] + (g[IX + k] - g[IX + j]) * rate[j] * rate[k]
    if g[IXY] != 0.0 or g[IXZ] != 0.0 or g[IYZ] != 0.0:
        products = np.array([[0.0, g[IXY], g[IXZ]], [g[IXY], 0.0, g[IYZ]],
                             [g[IXZ], g[IYZ], 0.0]])
        turn += products @ asked + np.cross(rate, products @ rate)
    _mix(lift, turn, g[SQUARE_MIN], g[SQUARE_MAX], mixer, command)


@compiled
def _mix(lift: float, turn: np.ndarray, least: float, most: float, mixer: np.ndarray,
         command: np.ndarray) -> None:
    """Write rotor speeds for a thrust and moments; where limits bind yaw yields, then thrust."""
    n = len(command)
    share = 1.0
    for j in range(n):
        # Without yaw, and what yaw adds.
        command[j] = mixer[j, 0] * lift + mixer[j, 1] * turn[0] + mixer[j, 2] * turn[1]
        yaw = mixer[j, 3] * turn[2]
        room = max(most - command[j] if yaw > 0.0 else command[j] - least, 0.0)
        if abs(yaw) > room:
            share = min(share, room / abs(yaw))
    low = high = 0.0
    for j in range(n):
        command[j] += share * mixer[j, 3] * turn[2]
        low = max(low, least - command[j])
        high = max(high, command[j] - most)
    for j in range(n):
        command[j] = math.sqrt(min(max(command[j] + low - high, least), most))
