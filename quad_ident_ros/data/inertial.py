# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
States reckoned from accelerometer and gyro alone, for records without position and velocity.

Over the tenth of a second of a prediction the errors of such dead reckoning are small, and
gravity, which enters both the reckoned and the predicted motion, cancels. Over a flight they grow
without bounds: where the vehicle is, how fast it flies through the air and which way is up is not
known.
Source: strapdown equations, Titterton and Weston, Strapdown Inertial Navigation Technology, 2004.
"""

from dataclasses import replace

import numpy as np
import scipy

from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.model.attitude import rotation_matrix, turn, turned_on

POSITION, VELOCITY = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
RATE, FORCE = ('wx', 'wy', 'wz'), ('ax', 'ay', 'az')
GAP = 0.15      # s; the slowest records that can be diagnosed have shorter steps

SUMMED = 'summed'
"""Info of a record: groups of its states that are integrals of the others."""


def is_inertial(record: FlightRecord) -> bool:
    """Return whether a record has rates and specific force, but neither position nor velocity."""
    return (record.has(*RATE, *FORCE) and not record.has(*POSITION)
            and not record.has(*VELOCITY))


def with_position(record: FlightRecord) -> FlightRecord:
    """Return a record whose position, if it has none, is the integral of its velocity from 0."""
    if record.has(*POSITION) or not record.has(*VELOCITY):
        return record
    position = _integral(record.stack(*VELOCITY), _steps(record))
    return replace(record, columns={**record.columns, **dict(zip(POSITION, position.T,
                                                                 strict=True))},
                   info={**record.info, SUMMED: ('position',)})


def reckoned(record: FlightRecord, gravity: float) -> FlightRecord:
    """
    Return a record with position, velocity and attitude integrated from its rates and force.

    It starts at rest at the origin; up is where the specific force points in the mean, since a
    vehicle that stays in a room does not gain speed. An attitude that was recorded is replaced:
    that of a filter which levels itself does not turn as the gyro does.
    Args: gravity m/s^2.
    """
    rate, force = record.stack(*RATE), record.stack(*FORCE)
    dt = _steps(record)
    quaternion = turned_on(turn(0.5 * (rate[1:] + rate[:-1]) * dt))
    rotation = _level(rotation_matrix(quaternion), force)
    world = np.einsum('nij,nj->ni', rotation, force) - [0.0, 0.0, gravity]
    velocity = _integral(world, dt)
    quaternion = _quaternions(rotation[0], quaternion)
    columns = {name: values for name, values in record.columns.items()
               if name not in (*EULER, *QUATERNION)}
    for names, values in ((POSITION, _integral(velocity, dt)), (VELOCITY, velocity),
                          (QUATERNION, quaternion)):
        columns |= dict(zip(names, values.T, strict=True))
    return replace(record, columns=columns, info={**record.info, SUMMED: ('position', 'attitude')})


def _steps(record: FlightRecord) -> np.ndarray:
    """Return the steps in time (N - 1, 1), s; over a gap nothing is integrated."""
    steps = np.diff(record.t)
    return np.where(steps > GAP, 0.0, steps)[:, None]


def _level(rotation: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return rotations (N, 3, 3) turned so that the mean of the specific force points up."""
    up = np.einsum('nij,nj->ni', rotation, force).mean(axis=0)
    length = np.linalg.norm(up)
    if not length > 0.0:
        return rotation
    up = up / length
    forward = np.array([1.0, 0.0, 0.0]) - up[0] * up
    if np.linalg.norm(forward) < 0.1:    # it points along x: any other axis does
        forward = np.array([0.0, 1.0, 0.0]) - up[1] * up
    forward /= np.linalg.norm(forward)
    return np.stack([forward, np.cross(up, forward), up]) @ rotation


def _quaternions(first: np.ndarray, relative: np.ndarray) -> np.ndarray:
    """Return quaternions (N, 4) that begin with a rotation (3, 3) and turn on as relative ones."""
    turned = (scipy.spatial.transform.Rotation.from_matrix(first)
              * scipy.spatial.transform.Rotation.from_quat(np.roll(relative, -1, axis=1)))
    return np.roll(turned.as_quat(), 1, axis=1)


def _integral(values: np.ndarray, dt: np.ndarray) -> np.ndarray:
    """Return the integral (N, 3) of values (N, 3) by the trapezoidal rule, from 0 on."""
    steps = 0.5 * (values[1:] + values[:-1]) * dt
    return np.vstack([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
