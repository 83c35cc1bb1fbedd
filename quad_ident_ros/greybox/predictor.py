# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What flies the predictions that are held against a flight: the vehicle model, by default."""

from typing import Protocol

import numpy as np

from quad_ident_ros.greybox.flights import Track
from quad_ident_ros.greybox.parameters import constants_of, SPLIT
from quad_ident_ros.model.dynamics import predict
from quad_ident_ros.model.vehicle import Vehicle


class Predictor(Protocol):
    """Whatever predicts flights of a vehicle with effects."""

    def __call__(self, track: Track, vehicle: Vehicle, z: np.ndarray, starts: np.ndarray,
                 first: np.ndarray, count: int) -> np.ndarray:
        """
        Return what rollouts along a Track would record, (B, count + 1, 13).

        Args: z (Z,) of greybox.parameters; starts (B, 13) recorded states at the samples
        first (B,); count of samples to go.
        """


def by_model(track: Track, vehicle: Vehicle, z: np.ndarray, starts: np.ndarray,
             first: np.ndarray, count: int) -> np.ndarray:
    """Return the predictions of the vehicle model, as a Predictor does."""
    return predict(vehicle, z[SPLIT:], track.course, starts, first, count,
                   constants=constants_of(z[None], vehicle), guide=track.guide)
