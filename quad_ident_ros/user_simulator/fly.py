# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rollouts of a user's simulator, one after the other or all at once."""

import numpy as np

from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.rigid_body import STATE
from quad_ident_ros.user_simulator.plan import Plan
from quad_ident_ros.user_simulator.program import Program


def fly(program: Program, plan: Plan) -> np.ndarray:
    """Return the true states (B, M + 1, 13) along the rollouts of a Plan; raises InputError."""
    if program.at_once:
        return _flown(program, plan)
    return np.concatenate([_flown(program, plan.part(slice(row, row + 1)))
                           for row in range(len(plan.starts))])


def _flown(program: Program, plan: Plan) -> np.ndarray:
    batch, count = plan.dt.shape
    out = np.empty((batch, count + 1, STATE))
    out[:, 0] = plan.starts
    state = np.concatenate([plan.starts, plan.speeds], axis=1)
    if not program.at_once:
        program.reset(state[0])
    for k in range(count):
        state = _step(program, plan, k, state)
        out[:, k + 1] = state[:, :STATE]
    return out


def _step(program: Program, plan: Plan, k: int, state: np.ndarray) -> np.ndarray:
    """Return the states (B, 13 + n) after step k."""
    dt, sent = plan.dt[:, k], plan.sent[:, k]
    if plan.added is None:
        made = program.step(state, sent, dt)
    else:
        linear, angular, middle = plan.added.accelerations(k, state[:, :STATE], dt)
        if program.takes_wrench:
            vehicle = plan.added.vehicle
            force = vehicle.mass * np.einsum('bij,bi->bj', rotation_matrix(middle[:, 6:10]),
                                             linear)
            made = program.step(state, sent, dt, force, angular @ vehicle.inertia_matrix)
        else:   # half of it before and half of it after the step: Strang's splitting
            kick = 0.5 * dt[:, None] * np.concatenate([linear, angular], axis=1)
            state = _kicked(state, kick)
            if not program.at_once:
                program.reset(state[0])
            made = _kicked(program.step(state, sent, dt), kick)
    if made.shape[1] == STATE:
        made = np.concatenate([made, plan.ends[:, k]], axis=1)
    return made


def _kicked(state: np.ndarray, kick: np.ndarray) -> np.ndarray:
    """Return states (B, 13 or more) with velocity and rate changed by a kick (B, 6)."""
    state = state.copy()
    state[:, 3:6] += kick[:, :3]
    state[:, 10:STATE] += kick[:, 3:]
    return state
