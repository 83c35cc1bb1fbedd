# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A quadrotor in MuJoCo, for --simulator docs/simulators/mujoco_quadrotor.py:Quadrotor."""

from pathlib import Path

import mujoco
import numpy as np

from quad_ident_ros.vehicle_files.load import load_any_vehicle

FILE = Path(__file__).with_name('quadrotor.xml')
THRUST = load_any_vehicle(FILE).thrust_coefficient      # N/(rad/s)^2 that stand for a thrust here


class Quadrotor:
    """Its controls are the thrusts of the rotors, N; effects act as force and moment."""

    def __init__(self):
        self.model = mujoco.MjModel.from_xml_path(str(FILE))
        self.data = mujoco.MjData(self.model)
        self.body = self.model.body('quadrotor').id

    def reset(self, state):
        """Begin at a state; MuJoCo's rate of a free body is in the body's axes, as ours is."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:7] = [*state[:3], *state[6:10]]
        self.data.qvel[:6] = [*state[3:6], *state[10:13]]
        mujoco.mj_forward(self.model, self.data)

    def step(self, commands, dt, force, moment):
        """Hold the speeds of the motors, rad/s, for dt s."""
        self.data.ctrl[:4] = THRUST * commands ** 2
        count = int(np.ceil(dt / 0.002 - 1e-9))
        self.model.opt.timestep = dt / count
        for _ in range(count):
            rotation = np.empty(9)
            mujoco.mju_quat2Mat(rotation, self.data.qpos[3:7])
            rotation = rotation.reshape(3, 3)
            self.data.xfrc_applied[self.body] = [*(rotation @ force), *(rotation @ moment)]
            mujoco.mj_step(self.model, self.data)
        return np.concatenate([self.data.qpos[:3], self.data.qvel[:3], self.data.qpos[3:7],
                               self.data.qvel[3:6]])
