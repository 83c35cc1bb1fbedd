# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Inertial measurement units and what corrects them, with all that is wrong with them."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.constants import cross, GRAVITY, rotation_of
from withheld.estimator.estimate import UP
from withheld.estimator.rotations import (
    exponential,
    heading_of,
    logarithm,
    quaternion_of,
)


@dataclass(frozen=True)
class Imu:
    """
    An inertial measurement unit.

    rate Hz; gyro rad/s and accelerometer m/s^2, deviations of the white noise of a sample;
    gyro_bias rad/s and accelerometer_bias m/s^2, deviations of what calibration left on each
    axis, drawn per flight; shaking (rad/s, m/s^2): amplitude of the vibration of one rotor in
    hover, which goes with the square of its speed.
    """

    rate: float = 500.0
    gyro: float = 0.01
    accelerometer: float = 0.15
    gyro_bias: float = 0.005
    accelerometer_bias: float = 0.03
    shaking: tuple = (0.03, 0.5)


@dataclass(frozen=True)
class Aid:
    """
    What corrects the estimate.

    rate Hz; latency s; deviations of position m, velocity m/s, attitude rad, heading rad; None
    where it does not measure that.
    """

    rate: float
    latency: float
    position: float
    velocity: float | None = None
    attitude: float | None = None
    heading: float | None = None


class Sensors:
    """The IMU and the aid of one flight, at the body origin."""

    def __init__(self, setup, centre, tilt, hover, count, rng):
        """Draw the biases. Args: setup; centre (3,) m; tilt (3,) rad; hover rad/s; rotors."""
        self.setup, self.centre, self.hover, self.rng = setup, centre, hover, rng
        self.tilt = Rotation.from_euler('ZYX', tilt[::-1]).as_matrix()
        # Without a measured attitude the sensor block as a whole sits askew.
        self.block = np.eye(3) if setup.aid.attitude is not None else self.tilt
        imu = setup.imu
        self.bias = (imu.gyro_bias * rng.normal(size=3),
                     imu.accelerometer_bias * rng.normal(size=3))
        self.phases = rng.uniform(0.0, 2.0 * np.pi, count)

    def at(self, s):
        """Return position and velocity of the body origin, and the rotation (3, 3)."""
        rotation = rotation_of(s[6:10])
        return (s[:3] - rotation @ self.centre,
                s[3:6] - rotation @ cross(s[10:13], self.centre), rotation)

    def imu(self, before, after, speeds, step):
        """Return mean rate and specific force of a step between two of `at`, as measured."""
        imu, rng = self.setup.imu, self.rng
        turn = logarithm(before[2].T @ after[2])
        middle = before[2] @ exponential(0.5 * turn)
        force = middle.T @ ((after[1] - before[1]) / step + GRAVITY * UP)
        self.phases = self.phases + step * speeds
        size = (speeds / self.hover) ** 2
        wave = np.array([size @ np.cos(self.phases), size @ np.sin(self.phases),
                         0.5 * size @ np.cos(2.0 * self.phases)])
        return (self.block.T @ turn / step + self.bias[0] + imu.gyro * rng.normal(size=3)
                + imu.shaking[0] * wave,
                self.block.T @ force + self.bias[1] + imu.accelerometer * rng.normal(size=3)
                + imu.shaking[1] * wave)

    def aid(self, place):
        """Return {name: value} of what the aid measures at one of `at`."""
        aid, rng = self.setup.aid, self.rng
        rotation = place[2] @ self.tilt
        seen = {'position': place[0] + aid.position * rng.normal(size=3)}
        if aid.velocity is not None:
            seen['velocity'] = place[1] + aid.velocity * rng.normal(size=3)
        if aid.attitude is not None:
            seen['attitude'] = rotation @ exponential(aid.attitude * rng.normal(size=3))
        if aid.heading is not None:
            seen['heading'] = heading_of(rotation) + aid.heading * rng.normal()
        return seen

    def exact(self, state, place, bias):
        """Return what sensors without noise show (13,) of a state (13,) and its `at`."""
        return np.concatenate([place[0], place[1], quaternion_of(place[2] @ self.tilt),
                               self.block.T @ state[10:] + bias])
