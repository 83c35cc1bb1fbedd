# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What one develops with: rotorpy's geometric controller, and a cascade as of most autopilots."""

import numpy as np
from rotorpy.controllers.quadrotor_control import SE3Control

from withheld.constants import cross, GRAVITY, rotation_of
from withheld.feedback import Lqr, mixer_of, TiltFirst


class Geometric(SE3Control):
    """
    rotorpy's controller of the nominal vehicle, with gains that tolerate a delay.

    It turns about z more gently: rotors that jump to a speed hand their momentum over at once.
    """

    def __init__(self, params):
        """Set the gains."""
        super().__init__(params)
        self.kp_pos, self.kd_pos = np.array([4.0, 4.0, 6.0]), np.array([3.2, 3.2, 4.5])
        self.kp_att = np.array([150.0, 150.0, 25.0])
        self.kd_att = np.array([20.0, 20.0, 5.0])

    def update(self, t, state, flat_output):
        """Return rotorpy's {'cmd_motor_speeds': (n,) rad/s}, by its law but with less ado."""
        force = self.mass * (self.kp_pos * (flat_output['x'] - state['x'])
                             + self.kd_pos * (flat_output['x_dot'] - state['v'])
                             + flat_output['x_ddot'] + (0.0, 0.0, self.g))
        rotation, yaw = rotation_of(state['q']), flat_output['yaw']
        up = force / np.sqrt(force @ force)
        left = cross(up, (np.cos(yaw), np.sin(yaw), 0.0))
        left /= np.sqrt(left @ left)
        wanted = np.array([cross(left, up), left, up])      # its axes as rows
        turn = wanted @ rotation
        error = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0],
                                turn[1, 0] - turn[0, 1]])
        rate = state['w'] - (0.0, 0.0, flat_output['yaw_dot'])
        moment = self.inertia @ (-self.kp_att * error - self.kd_att * rate) + cross(
            state['w'], self.inertia @ state['w'])
        speeds = self.TM_to_f @ np.array([force @ rotation[:, 2], *moment]) / self.k_eta
        return {'cmd_motor_speeds': np.sign(speeds) * np.sqrt(np.abs(speeds))}


class Cascade:
    """
    A cascade: position to velocity to tilt to rate to torque, each of them with PI or P alone.

    No part of the path beyond the velocity is fed forward but the acceleration, and the thrust is
    not divided by the tilt: what holds such autopilots on their path is the integral.
    """

    POSITION, VELOCITY, SLOW = 1.5, 3.2, 0.6        # 1/s, 1/s, 1/s^2
    TILT, RATE, RATE_SLOW = 7.0, 20.0, 12.0         # 1/s, 1/s, 1/s^2
    STEEPEST = 0.7                                  # rad

    def __init__(self, params):
        """Take the nominal vehicle."""
        self.mass = params['mass']
        self.inertia = np.array([params[key] for key in ('Ixx', 'Iyy', 'Izz')])
        self.mixer = mixer_of(params)
        self._time, self._drift, self._turn = None, np.zeros(3), np.zeros(3)

    def update(self, t, state, aim):
        """Return {'cmd_motor_speeds': (n,) rad/s}; state and aim as of rotorpy's controllers."""
        step = 0.0 if self._time is None else t - self._time
        self._time = t
        late = (aim['x_dot'] + self.POSITION * (aim['x'] - state['x'])) - state['v']
        self._drift = np.clip(self._drift + step * self.SLOW * late, -3.0, 3.0)
        pull = aim['x_ddot'] + self.VELOCITY * late + self._drift
        x, y, z, w = state['q']
        roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
        pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
        yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        ahead = np.cos(yaw) * pull[0] + np.sin(yaw) * pull[1]
        aside = -np.sin(yaw) * pull[0] + np.cos(yaw) * pull[1]
        lift = max(GRAVITY + pull[2], 0.3 * GRAVITY)
        tilts = np.clip(np.arctan2([-aside, ahead], lift), -self.STEEPEST, self.STEEPEST)
        heading = (aim['yaw'] - yaw + np.pi) % (2 * np.pi) - np.pi
        wanted = self.TILT * np.array([tilts[0] - roll, tilts[1] - pitch, 0.5 * heading])
        wanted[2] += aim['yaw_dot']
        error = wanted - state['w']
        self._turn = np.clip(self._turn + step * self.RATE_SLOW * error, -20.0, 20.0)
        moment = self.inertia * (self.RATE * error + self._turn)
        thrust = self.mass * np.hypot(lift, np.hypot(ahead, aside))
        squares = self.mixer @ np.array([thrust, *moment])
        return {'cmd_motor_speeds': np.sqrt(np.maximum(squares, 0.0))}


CONTROLLERS = {'geometric': Geometric, 'cascade': Cascade, 'tilt_first': TiltFirst, 'lqr': Lqr}
