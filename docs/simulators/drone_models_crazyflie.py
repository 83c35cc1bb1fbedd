# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""drone-models' Crazyflie, for --simulator docs/simulators/drone_models_crazyflie.py:Crazyflie."""

from drone_models import parametrize  # with SCIPY_ARRAY_API=1 in the environment
from drone_models.first_principles import dynamics
import numpy as np
from scipy.spatial.transform import Rotation

RPM = 30.0 / np.pi      # of 1 rad/s


class Crazyflie:
    """Flies many states at once; effects act as force and moment."""

    def __init__(self):
        self.dynamics = parametrize(dynamics, 'cf21B_500')

    def step_many(self, states, commands, dt, force, moment):
        """Hold the speeds of the motors (B, 4), rad/s, for dt (B,) s, by Runge-Kutta's steps."""
        count = int(np.ceil(np.max(dt) / 0.005))
        h = dt[:, None] / count
        for _ in range(count):
            a = self.slope(states, commands, force, moment)
            b = self.slope(states + 0.5 * h * a, commands, force, moment)
            c = self.slope(states + 0.5 * h * b, commands, force, moment)
            d = self.slope(states + h * c, commands, force, moment)
            states = states + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            states[:, 6:10] /= np.linalg.norm(states[:, 6:10], axis=1, keepdims=True)
        return states

    def slope(self, x, commands, force, moment):
        """Return the derivatives of states (B, 17); drone-models has forces in the world."""
        scalar, vector, rate = x[:, 6:7], x[:, 7:10], x[:, 10:13]
        q = np.concatenate([vector, scalar], axis=1)    # the scalar last
        turn = Rotation.from_quat(q)
        v, _, dv, dw, rising = self.dynamics(
            x[:, :3], q, x[:, 3:6], rate, RPM * commands, RPM * x[:, 13:], turn.apply(force),
            turn.apply(moment))
        dq = 0.5 * np.concatenate([-np.sum(vector * rate, axis=1, keepdims=True),
                                   scalar * rate + np.cross(vector, rate)], axis=1)
        return np.concatenate([v, dv, dq, dw, rising / RPM], axis=1)
