# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The complementary filter."""

import numpy as np

from withheld.constants import cross
from withheld.estimator.estimate import ROWS, UP
from withheld.estimator.rotations import exponential


class ComplementaryFilter:
    """
    Observer with fixed gains, of the third order in position.

    The attitude as in R. Mahony, T. Hamel and J.-M. Pflimlin, IEEE Trans. Autom. Control (2008).
    Args: estimate; aid; level 1/s, towards the accelerometer's vertical, or towards the measured
    attitude where the aid has it; turn 1/s, towards the measured heading; bias 1/s^2, of the
    gyro; settle s, time constant of the position; blend s, of the velocity towards a measured one.
    """

    def __init__(self, estimate, aid, level, turn, bias, settle, blend=None):
        """Begin with an estimate that is nearly right."""
        self.now, self.aid = estimate, aid
        self.level, self.turn, self.bias = level, turn, bias
        self.settle, self.blend = settle, blend

    def propagate(self, gyro, force, step):
        """Integrate a sample of the IMU."""
        if self.aid.attitude is None:
            now = self.now
            felt = force - now.accelerometer_bias
            off = cross(felt / np.sqrt(felt @ felt), now.rotation.T @ UP)
            now.gyro_bias = now.gyro_bias - step * self.bias * off
            gyro = gyro + self.level * off
        self.now.propagate(gyro, force, step)

    def correct(self, seen, then):
        """Take in what was seen, {name: value}, of the time at which the estimate was `then`."""
        now, step = self.now, 1.0 / self.aid.rate
        change = {name: ROWS[name](value, then)[0] for name, value in seen.items()}
        away, share = change['position'], step / self.settle
        now.position = now.position + 3.0 * share * away
        now.velocity = now.velocity + 3.0 * share / self.settle * away
        now.accelerometer_bias = (now.accelerometer_bias
                                  - share / self.settle ** 2 * now.rotation.T @ away)
        if 'velocity' in change:
            now.velocity = now.velocity + step / self.blend * change['velocity']
        if 'attitude' in change:
            now.rotation = now.rotation @ exponential(step * self.level * change['attitude'])
            now.gyro_bias = now.gyro_bias - step * self.bias * change['attitude']
        if 'heading' in change:
            about = now.rotation.T @ UP
            now.rotation = now.rotation @ exponential(step * self.turn * change['heading'] * about)
