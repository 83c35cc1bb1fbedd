# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a filter estimates, how it goes on, and how far it is from what is seen."""

from dataclasses import dataclass

import numpy as np

from withheld.constants import GRAVITY
from withheld.estimator.rotations import exponential, heading_of, logarithm

UP = np.array([0.0, 0.0, 1.0])


@dataclass
class Estimate:
    """
    Position (3,) m, velocity (3,) m/s, rotation (3, 3) body to world, biases (3,) of the IMU.

    Its arrays are replaced, never written to: to keep one is to copy it.
    """

    position: np.ndarray
    velocity: np.ndarray
    rotation: np.ndarray
    gyro_bias: np.ndarray
    accelerometer_bias: np.ndarray

    def propagate(self, gyro, force, step):
        """Integrate the mean rate rad/s and specific force m/s^2 of a step of s."""
        rate, force = gyro - self.gyro_bias, force - self.accelerometer_bias
        half = exponential(0.5 * step * rate)
        middle = self.rotation @ half
        velocity = self.velocity + step * (middle @ force - GRAVITY * UP)
        self.position = self.position + 0.5 * step * (self.velocity + velocity)
        self.velocity, self.rotation = velocity, middle @ half
        return rate, force


def _block(first):
    out = np.zeros((3, 15))
    out[:, first:first + 3] = np.eye(3)
    return out


PLACE, SPEED, TURN = _block(0), _block(3), _block(6)


def _heading_row(value, then):
    change = (value - heading_of(then.rotation) + np.pi) % (2.0 * np.pi) - np.pi
    x, y = then.rotation[:2, 0]
    row = np.zeros((1, 15))
    row[0, 7] = (y * then.rotation[0, 2] - x * then.rotation[1, 2]) / (x * x + y * y)
    row[0, 8] = (x * then.rotation[1, 1] - y * then.rotation[0, 1]) / (x * x + y * y)
    return np.array([change]), row


# Of what is seen: how far it is from an estimate, and how that grows with the error (15,).
ROWS = {'position': lambda value, then: (value - then.position, PLACE),
        'velocity': lambda value, then: (value - then.velocity, SPEED),
        'attitude': lambda value, then: (logarithm(then.rotation.T @ value), TURN),
        'heading': _heading_row}
