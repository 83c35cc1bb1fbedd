# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Controllers of the evaluation alone, of the nominal vehicle with any number of rotors."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are

from withheld.constants import cross, GRAVITY, rotation_of

UP = np.array([0.0, 0.0, 1.0])
LEAST_LIFT = 0.3        # of gravity: rotors do not pull downwards


def mixer_of(params: dict) -> NDArray[np.float64]:
    """Return the matrix (n, 4) from thrust and moments to the squares of the rotors' speeds."""
    places = np.array(list(params['rotor_pos'].values()))
    k = params['k_eta']
    return np.linalg.pinv(np.stack([
        np.full(len(places), k), k * places[:, 1], -k * places[:, 0],
        params['k_m'] * np.asarray(params['rotor_directions'])]))


def inertia_of(params: dict) -> NDArray[np.float64]:
    """Return the nominal moments of inertia (3,)."""
    return np.array([params[key] for key in ('Ixx', 'Iyy', 'Izz')])


class TiltFirst:
    """
    Position by PID, attitude by a quaternion that turns the thrust first and the heading slowly.

    The error of the attitude is split into the shortest turn of the thrust's axis and the turn
    about it (Brescianini and D'Andrea, IEEE Transactions on Control Systems Technology 28, 2020);
    rates by PI with the gyroscopic moment fed forward.
    """

    POSITION, VELOCITY, SLOW = 5.0, 3.4, 1.2        # 1/s^2, 1/s, 1/s^3
    TILT, HEADING = 9.0, 2.5                        # 1/s
    RATE, RATE_SLOW = np.array([22.0, 22.0, 9.0]), np.array([15.0, 15.0, 4.0])  # 1/s, 1/s^2

    def __init__(self, params: dict) -> None:
        """Take the nominal vehicle."""
        self.mass, self.inertia = params['mass'], inertia_of(params)
        self.mixer = mixer_of(params)
        self._time, self._drift, self._turn = None, np.zeros(3), np.zeros(3)

    def update(self, t: float, state: dict, aim: dict) -> dict:
        """Return {'cmd_motor_speeds': (n,) rad/s}; state and aim as of rotorpy's controllers."""
        step = 0.0 if self._time is None else t - self._time
        self._time = t
        away, late = aim['x'] - state['x'], aim['x_dot'] - state['v']
        self._drift = np.clip(self._drift + step * self.SLOW * away, -2.0, 2.0)
        pull = (aim['x_ddot'] + self.POSITION * away + self.VELOCITY * late + self._drift
                + GRAVITY * UP)
        pull[2] = max(pull[2], LEAST_LIFT * GRAVITY)
        rotation = rotation_of(state['q'])
        force = np.sqrt(pull @ pull)
        # In the body: where the thrust shall point, and by which turn it gets there.
        wanted = rotation.T @ pull / force
        turn = cross(UP, wanted)
        sine, cosine = np.sqrt(turn @ turn), wanted[2]
        rate = self.TILT * turn * (np.arctan2(sine, cosine) / sine if sine > 1e-9 else 1.0)
        heading = np.arctan2(rotation[1, 0], rotation[0, 0])
        off = (aim['yaw'] - heading + np.pi) % (2.0 * np.pi) - np.pi
        rate[2] += aim['yaw_dot'] + self.HEADING * off
        error = rate - state['w']
        self._turn = np.clip(self._turn + step * self.RATE_SLOW * error, -15.0, 15.0)
        moment = self.inertia * (self.RATE * error + self._turn) + cross(
            state['w'], self.inertia * state['w'])
        squares = self.mixer @ np.array([self.mass * force, *moment])
        return {'cmd_motor_speeds': np.sqrt(np.maximum(squares, 0.0))}


class Lqr:
    """
    Feedback of all states, optimal for the vehicle linearised in hover, about a feedforward.

    States are errors along the heading: position, its integral, velocity, small angles, rates;
    inputs are accelerations upwards and about the axes (Bouabdallah, Noth, Siegwart, IROS 2004).
    """

    # Allowed deviations (Bryson's rule): m s, m, m/s, rad, rad/s; m/s^2, rad/s^2.
    ALLOWED = np.repeat([0.5, 0.25, 0.5, 0.15, 1.5], 3)
    EFFORT = np.array([6.0, 40.0, 40.0, 15.0])
    STEEPEST = 0.7                                  # rad

    def __init__(self, params: dict) -> None:
        """Solve for the gains (4, 15)."""
        self.mass, self.inertia = params['mass'], inertia_of(params)
        self.mixer = mixer_of(params)
        a, b = np.zeros((15, 15)), np.zeros((15, 4))
        a[0:3, 3:6] = a[3:6, 6:9] = a[9:12, 12:15] = np.eye(3)
        a[6, 10], a[7, 9] = GRAVITY, -GRAVITY
        b[8, 0], b[12:15, 1:4] = 1.0, np.eye(3)
        cost = solve_continuous_are(a, b, np.diag(self.ALLOWED ** -2), np.diag(self.EFFORT ** -2))
        self.gains = (b.T @ cost) * (self.EFFORT ** 2)[:, None]
        self._time, self._sum = None, np.zeros(3)

    def update(self, t: float, state: dict, aim: dict) -> dict:
        """Return {'cmd_motor_speeds': (n,) rad/s}; state and aim as of rotorpy's controllers."""
        step = 0.0 if self._time is None else t - self._time
        self._time = t
        rotation = rotation_of(state['q'])
        yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
        c, s = np.cos(yaw), np.sin(yaw)
        level = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        away = state['x'] - aim['x']
        self._sum = np.clip(self._sum + step * away, -1.5, 1.5)
        pull = level @ aim['x_ddot']
        wanted = np.clip(np.arctan2([-pull[1], pull[0]], GRAVITY + pull[2]),
                         -self.STEEPEST, self.STEEPEST)
        roll = np.arctan2(rotation[2, 1], rotation[2, 2])
        pitch = -np.arcsin(np.clip(rotation[2, 0], -1.0, 1.0))
        turned = (yaw - aim['yaw'] + np.pi) % (2.0 * np.pi) - np.pi
        errors = np.concatenate([
            level @ self._sum, level @ away, level @ (state['v'] - aim['x_dot']),
            [roll - wanted[0], pitch - wanted[1], turned],
            state['w'] - [0.0, 0.0, aim['yaw_dot']]])
        lift, *turns = -self.gains @ errors
        lift = max(GRAVITY + aim['x_ddot'][2] + lift, LEAST_LIFT * GRAVITY)
        lean = max(np.cos(roll) * np.cos(pitch), 0.5)
        squares = self.mixer @ np.array([self.mass * lift / lean, *(self.inertia * turns)])
        return {'cmd_motor_speeds': np.sqrt(np.maximum(squares, 0.0))}
