# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The error-state Kalman filter."""

import numpy as np

from withheld.estimator.estimate import ROWS
from withheld.estimator.rotations import exponential, hat


class ErrorStateFilter:
    """
    Kalman filter of the error of an estimate (J. Solà, arXiv:1711.02508, with local angles).

    The error (15,): position, velocity, rotation (body), bias of the gyro, of the accelerometer.
    Args: estimate; aid; gyro rad/s and accelerometer m/s^2: deviations of a sample that it
    takes for true; walks (rad/s, m/s^2) of the biases per root second; trust: what the aid's
    deviations are multiplied by.
    """

    def __init__(self, estimate, aid, gyro, accelerometer, walks, trust=1.0):
        """Begin with an estimate that is nearly right."""
        self.now, self.aid, self.trust = estimate, aid, trust
        self.noise = np.repeat([0.0, accelerometer, gyro, 0.0, 0.0], 3) ** 2
        self.walk = np.repeat([0.0, 0.0, 0.0, *walks], 3) ** 2
        self.covariance = np.diag(np.repeat([0.02, 0.05, 0.01, 0.005, 0.05], 3) ** 2)

    def propagate(self, gyro, force, step):
        """Integrate a sample of the IMU."""
        before = self.now.rotation
        rate, force = self.now.propagate(gyro, force, step)
        moves = np.eye(15)
        moves[0:3, 3:6] = step * np.eye(3)
        moves[3:6, 6:9] = -step * before @ hat(force)
        moves[3:6, 12:15] = -step * before
        moves[6:9, 6:9] -= step * hat(rate)
        moves[6:9, 9:12] = -step * np.eye(3)
        self.covariance = moves @ self.covariance @ moves.T
        self.covariance[np.diag_indices(15)] += step ** 2 * self.noise + step * self.walk

    def correct(self, seen, then):
        """Take in what was seen, {name: value}, of the time at which the estimate was `then`."""
        rows, changes, deviations = [], [], []
        for name, value in seen.items():
            change, row = ROWS[name](value, then)
            rows.append(row)
            changes.append(change)
            deviations.append(np.full(len(change), self.trust * getattr(self.aid, name)))
        row, change = np.concatenate(rows), np.concatenate(changes)
        spread = row @ self.covariance @ row.T + np.diag(np.concatenate(deviations) ** 2)
        gain = np.linalg.solve(spread, row @ self.covariance).T
        self.covariance = self.covariance - gain @ row @ self.covariance
        self.covariance = 0.5 * (self.covariance + self.covariance.T)
        error, now = gain @ change, self.now
        now.position = now.position + error[0:3]
        now.velocity = now.velocity + error[3:6]
        now.rotation = now.rotation @ exponential(error[6:9])
        now.gyro_bias = now.gyro_bias + error[9:12]
        now.accelerometer_bias = now.accelerometer_bias + error[12:15]
