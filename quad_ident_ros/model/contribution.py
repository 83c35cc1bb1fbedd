# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What effects add to the nominal vehicle along a recorded flight."""

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.effects.registry import NULL, SLICES
from quad_ident_ros.model.actuators import accelerations, actuated
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.dynamics import Course
from quad_ident_ros.model.rigid_body import (
    derivatives,
    rotor_table,
    vehicle_vector,
    with_residual,
)
from quad_ident_ros.model.sensors import underlying
from quad_ident_ros.model.vehicle import Vehicle


def contribution(vehicle: Vehicle, theta: ArrayLike, course: Course, states: np.ndarray
                 ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return force (N, 3) N and moment (N, 3) N m, body, that effects add to the nominal vehicle.

    Nominal mass and inertia times what they change in the accelerations of the body origin.
    Args: theta (P,); course: a dynamics.Course; states (N, 13) recorded at its times.
    """
    theta = np.asarray(theta, float)
    linear, angular = (with_effects - nominal for with_effects, nominal in
                       zip(_along(vehicle, theta, course, states),
                           _along(vehicle, NULL, course, states), strict=True))
    body = np.einsum('nij,ni->nj', rotation_matrix(states[:, 6:10]), linear)
    return vehicle.mass * body, angular @ vehicle.inertia_matrix


def _along(vehicle: Vehicle, theta: np.ndarray, course: Course, states: np.ndarray
           ) -> tuple[np.ndarray, np.ndarray]:
    """Return the accelerations of a body with effects along a course, (N, 3) each."""
    acted = actuated(course.t, course.stamps, course.commands, theta[None])
    (speeds,), (rising,) = acted.speeds, accelerations(course.t, acted, theta[None])
    return accelerations_of(vehicle, theta, course.t, states, speeds, rising,
                            course.inputs(vehicle))


def accelerations_of(vehicle: Vehicle, theta: np.ndarray, t: np.ndarray, states: np.ndarray,
                     speeds: np.ndarray, rising: np.ndarray, inputs: np.ndarray
                     ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return those of the body origin, m/s^2, world, and of the rate, rad/s^2, body, (N, 3) each.

    Args: theta (P,); t (N,) s; states (N, 13) recorded; speeds (N, n) rad/s of the rotors, and
    rising (N, n), their rates of change; inputs (N, INPUT) of rigid_body.
    """
    states = np.ascontiguousarray(underlying(theta, states))
    change = np.empty_like(states)
    constants = with_residual(vehicle_vector(vehicle), vehicle)
    derivatives(constants[:, None], rotor_table(vehicle), theta, t, states, speeds, rising, inputs,
                change)
    arm = -theta[SLICES['com_offset']]
    rate, turning = states[:, 10:], change[:, 10:]
    swing = np.cross(turning, arm) + np.cross(rate, np.cross(rate, arm))
    linear = change[:, 3:6] + np.einsum('nij,nj->ni', rotation_matrix(states[:, 6:10]), swing)
    return linear, turning
