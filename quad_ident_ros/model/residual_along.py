# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The inputs of a residual function along a recorded flight."""

from dataclasses import replace

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import TABLE
from quad_ident_ros.model.actuators import actuated
from quad_ident_ros.model.dynamics import Course
from quad_ident_ros.model.residual_function import INPUTS, NOTHING
from quad_ident_ros.model.residual_in_flight import look
from quad_ident_ros.model.rigid_body import (
    derivative,
    INPUT,
    prepare,
    rotor_table,
    STATE,
    vehicle_vector,
)
from quad_ident_ros.model.sensors import underlying
from quad_ident_ros.model.situation import ROTOR_ROWS, SPEED
from quad_ident_ros.model.vehicle import Vehicle


def inputs_along(vehicle: Vehicle, theta: np.ndarray, course: Course, states: np.ndarray
                 ) -> np.ndarray:
    """
    Return the inputs of a residual function at the samples of a flight, (N, 22), see INPUTS.

    Args: theta (P,); states (N, 13) recorded at the times of the course.
    """
    speeds = actuated(course.t, course.stamps, course.commands, theta[None]).speeds[0]
    out = np.empty((len(states), len(INPUTS)))
    _look_along(vehicle_vector(vehicle)[:, None], rotor_table(vehicle), theta,
                np.ascontiguousarray(underlying(theta, states)), speeds,
                course.inputs(replace(vehicle, residual=NOTHING)), out)
    return out


@compiled(fused=True)
def _look_along(v: np.ndarray, places: np.ndarray, theta: np.ndarray, states: np.ndarray,
                speeds: np.ndarray, inputs: np.ndarray, out: np.ndarray) -> None:
    """Write the inputs at states (N, 13) of the centre of mass into out (N, 22)."""
    x, dx, seen = np.empty((STATE, 1)), np.empty((STATE, 1)), np.empty((out.shape[1], 1))
    s, rotors = np.zeros((TABLE, 1)), np.zeros((places.shape[0], ROTOR_ROWS, 1))
    parameters, u = np.empty((len(theta), 1)), np.empty((inputs.shape[1], 1))
    parameters[:, 0] = theta
    prepare(v, places, parameters, s, rotors)
    for n in range(len(states)):
        x[:, 0], u[:, 0], rotors[:, SPEED, 0] = states[n], inputs[n], speeds[n]
        derivative(x, u, v, places, parameters, s, rotors, dx)
        look(u, INPUT, v, places, s, rotors, seen)
        out[n] = seen[:, 0]
