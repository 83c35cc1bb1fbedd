# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""rotorpy's Hummingbird, for --simulator docs/simulators/rotorpy_hummingbird.py:Hummingbird."""

import numpy as np
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor


class Hummingbird:
    """It takes no force: effects push it between two steps."""

    def __init__(self):
        self.vehicle = Multirotor(quad_params)

    def reset(self, state):
        """Begin at a state; rotorpy has the scalar of a quaternion last."""
        self.state = {'x': state[:3], 'v': state[3:6], 'q': state[[7, 8, 9, 6]],
                      'w': state[10:13], 'wind': np.zeros(3), 'rotor_speeds': state[13:]}

    def step(self, commands, dt):
        """Hold the speeds of the motors, rad/s, for dt s."""
        self.state = now = self.vehicle.step(self.state, {'cmd_motor_speeds': commands}, dt)
        return np.concatenate([now['x'], now['v'], now['q'][[3, 0, 1, 2]], now['w'],
                               now['rotor_speeds']])
