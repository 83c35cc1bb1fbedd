# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The force that a model does not explain, by the accelerometer: it measures force per mass."""

from dataclasses import replace

import numpy as np

from quad_ident_ros.greybox.flights import Flight
from quad_ident_ros.greybox.linear import errors_along
from quad_ident_ros.greybox.noise import MAD
from quad_ident_ros.greybox.parameters import INDEX
from quad_ident_ros.greybox.predictor import by_model, Predictor
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.vehicle import Vehicle


def residual_force(flight: Flight, vehicle: Vehicle, z: np.ndarray,
                   predictor: Predictor = by_model) -> tuple[np.ndarray, np.ndarray] | None:
    """
    Return the mean force (B, 3) N, body, beyond a model's in each rollout, and its error (B, 3).

    None without an accelerometer. An offset of it is in the force. It is taken to be at the centre
    of mass, so that turns add what they give over the distance.
    Args: z (Z,): the parameters of the model.
    """
    if flight.force is None:
        return None
    rows = flight.first[:, None] + np.arange(flight.count)
    # One step from each recorded state shows the acceleration that the model has there. Rollouts
    # that overlap have it in common.
    first, places = np.unique(rows, return_inverse=True)
    steps = replace(flight, first=first, count=1)
    now, after = flight.states[steps.first], flight.states[steps.first + 1]
    period = flight.course.t[steps.first + 1] - flight.course.t[steps.first]
    change = after[:, 3:6] - now[:, 3:6] - errors_along(
        steps, vehicle, z, now, predictor)[:, 1, 3:6]
    model = change / period[:, None] + [0.0, 0.0, vehicle.gravity]
    body = np.einsum('bji,bj->bi', rotation_matrix(now[:, 6:10]), model)
    measured = 0.5 * (flight.force[steps.first] + flight.force[steps.first + 1])
    apart = (measured - body)[places.reshape(rows.shape)]
    # Of slow records a window has fewer samples than a third difference needs.
    wide = flight.first[:, None] + np.arange(max(flight.count, 4))
    wide = np.minimum(wide, len(flight.force) - 1)
    third = np.abs(np.diff(flight.force[wide], 3, axis=1)).reshape(-1, 3)
    noise = MAD * np.median(third, axis=0) / np.sqrt(20.0 * flight.count)
    mass = vehicle.mass + z[INDEX['mass_offset.mass']]
    return mass * apart.mean(axis=1), np.broadcast_to(mass * noise, (len(rows), 3))
