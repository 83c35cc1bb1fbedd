# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Predictions with the nominal model, written for the check alone.

The library under test takes no part in what its strengths are measured with. States (..., 13):
position, velocity (world), quaternion x, y, z, w, rate (body).
"""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.constants import GRAVITY


class Nominal:
    """The nominal vehicle: thrust and torque with the square of the commands, linear drag."""

    def __init__(self, params):
        """Take its constants from rotorpy's parameters."""
        self.mass = params['mass']
        self.inertia = np.array([params[key] for key in ('Ixx', 'Iyy', 'Izz')])
        self.drag = np.asarray(params['linear_drag'])
        places = np.array(list(params['rotor_pos'].values()))
        self.to_force = np.stack([
            np.full(len(places), params['k_eta']), params['k_eta'] * places[:, 1],
            -params['k_eta'] * places[:, 0], params['k_m'] * params['rotor_directions']])

    def _slope(self, velocity, rotation, rate, force, moment):
        air = rotation.inv().apply(velocity)
        body = -self.drag * air
        body[:, 2] += force
        acceleration = rotation.apply(body) / self.mass - [0.0, 0.0, GRAVITY]
        turn = (moment - np.cross(rate, self.inertia * rate)) / self.inertia
        return acceleration, turn

    def predict(self, states, commands, step):
        """
        Return the states (B, 13) after steps of `step` s.

        Args: states (B, 13) at the start; commands (B, n, 4) rad/s, each held for a step.
        """
        place, velocity, rate = states[:, :3], states[:, 3:6], states[:, 10:13]
        rotation = Rotation.from_quat(states[:, 6:10])
        for k in range(commands.shape[1]):
            acts = commands[:, k] ** 2 @ self.to_force.T
            pull, turn = self._slope(velocity, rotation, rate, acts[:, 0], acts[:, 1:])
            middle = rate + 0.5 * step * turn
            halfway = rotation * Rotation.from_rotvec(0.5 * step * rate)
            pull, turn = self._slope(velocity + 0.5 * step * pull, halfway, middle, acts[:, 0],
                                     acts[:, 1:])
            place = place + step * velocity + 0.5 * step ** 2 * pull
            velocity = velocity + step * pull
            rotation = rotation * Rotation.from_rotvec(step * middle)
            rate = rate + step * turn
        return np.concatenate([place, velocity, rotation.as_quat(), rate], axis=1)


def errors(states, predicted):
    """Return the errors, (B, 12), of predicted states: position, velocity, rotation, rate."""
    rotation = Rotation.from_quat(predicted[:, 6:10]).inv() * Rotation.from_quat(states[:, 6:10])
    return np.concatenate([states[:, :6] - predicted[:, :6], rotation.as_rotvec(),
                           states[:, 10:] - predicted[:, 10:]], axis=1)


def rms(values):
    """Return {group: root mean square} of errors (B, 12)."""
    return {name: float(np.sqrt(np.mean(np.sum(values[:, part] ** 2, axis=1))))
            for name, part in GROUPS.items()}


GROUPS = {'position': slice(0, 3), 'velocity': slice(3, 6), 'attitude': slice(6, 9),
          'rate': slice(9, 12)}
HORIZON, EVERY, FIRST = 0.5, 0.1, 0.25      # s; the first start, as formats.md leaves open


def starts_of(count, step):
    """Return where predictions begin, (B,), and over how many steps they go."""
    length = round(HORIZON / step)
    return np.arange(round(FIRST / step), count - length, max(1, round(EVERY / step))), length


def nominal_errors(model, states, commands, step):
    """Return the errors (B, 12) of predictions along a flight, (N, 13) and (N, 4), from states."""
    first, length = starts_of(len(states), step)
    windows = np.stack([commands[k:k + length] for k in first])
    return errors(states[first + length], model.predict(states[first], windows, step))
