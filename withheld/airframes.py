# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles of the evaluation alone, of four classes of mass and four geometries."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from withheld.constants import GRAVITY

SPEED_MARGIN = 1.9      # of the largest speed over that in hover: 3.6 times the thrust
AXES = ('Ixx', 'Iyy', 'Izz')


def airframe(mass: float, inertia: Sequence[float], places: ArrayLike, spins: Sequence[int],
             radius: float, hover: float, torque: float) -> dict:
    """
    Return rotorpy's parameters of a vehicle.

    Args: mass kg; inertia (3,) kg m^2; places (n, 2) m of the rotors, forward and to the left;
    spins (n,), the sign of the reaction about z; radius m of the rotors; hover rad/s, their
    mean speed there; torque m, the reaction torque per thrust.
    """
    places = np.asarray(places, float)
    count = len(places)
    k_eta = mass * GRAVITY / (count * hover ** 2)
    return {
        'mass': mass, **dict(zip(AXES, inertia, strict=True)), 'Ixy': 0.0, 'Ixz': 0.0, 'Iyz': 0.0,
        'num_rotors': count, 'rotor_radius': radius, 'rotor_directions': np.array(spins),
        'rotor_pos': {f'r{j + 1}': np.array([*place, 0.0]) for j, place in enumerate(places)},
        'k_eta': k_eta, 'k_m': torque * k_eta, 'tau_m': 0.0,
        'rotor_speed_min': 0.0, 'rotor_speed_max': SPEED_MARGIN * hover}


def ring(count: int, arm: float, first: float) -> NDArray[np.float64]:
    """Return the places (count, 2) m of rotors on a circle; the first at an angle, rad."""
    angles = first + 2.0 * np.pi * np.arange(count) / count
    return arm * np.stack([np.cos(angles), np.sin(angles)], axis=1)


# Each with the size of its rotors; masses and sizes as such vehicles are sold or built.
HEXACOPTER_X = airframe(
    1.6, (0.022, 0.023, 0.036), ring(6, 0.275, np.pi / 6.0), (1, -1, 1, -1, 1, -1), 0.12, 480.0,
    0.016)
LIFTER_3KG = airframe(
    3.0, (0.062, 0.066, 0.102), ring(4, 0.33, np.pi / 4.0), (-1, 1, -1, 1), 0.19, 340.0, 0.024)
RACER_250G = airframe(
    0.25, (2.6e-4, 3.4e-4, 4.8e-4),
    ((0.05, 0.062), (0.05, -0.062), (-0.05, -0.062), (-0.05, 0.062)), (1, -1, 1, -1), 0.038,
    1350.0, 0.0068)
# Wide in front and narrow behind, with the centre of mass towards the front.
ASYMMETRIC_H = airframe(
    0.75, (0.0052, 0.0041, 0.0074),
    ((0.10, 0.17), (0.10, -0.17), (-0.125, -0.11), (-0.125, 0.11)), (1, -1, 1, -1), 0.089, 760.0,
    0.013)
