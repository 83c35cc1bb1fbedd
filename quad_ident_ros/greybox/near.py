# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rollouts that are short enough for a model to stay near the record."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.greybox.flights import Flight, flight_of, inertial, SEGMENT, Track
from quad_ident_ros.greybox.linear import errors_along
from quad_ident_ros.model.vehicle import Vehicle

SEGMENTS = (SEGMENT, 0.3, 0.2)      # s
MOST = 180      # rollouts of all flights, three of 30 s: of more, every so many. Where that many
                # do not separate an effect from noise, it makes no gap that matters
SHORT = 0.08    # s, of inertial flights: what nothing explains is taken as constant for that long
FAR = 0.8       # rad, of the attitude at the end: beyond it what the slopes say is not so


def near_flights(tracks: Sequence[Track], vehicle: Vehicle, z: np.ndarray) -> list[Flight]:
    """
    Return the Flights of Tracks, with the longest rollouts of a vector z (Z,) that stay near.

    An attitude that is let go is soon anywhere: no fit finds its way back from there. Raises
    InputError where a flight is too short for them.
    """
    if inertial(tracks):
        return _fewer([flight_of(track, SHORT) for track in tracks], int(MOST * SEGMENT / SHORT))
    for segment in SEGMENTS:
        flights = [flight_of(track, segment) for track in tracks]
        off = np.concatenate([
            errors_along(flight, vehicle, z, flight.states[flight.first])[:, -1]
            for flight in flights])[:, GROUPS['attitude']]
        if np.median(np.linalg.norm(off, axis=1)) < FAR:
            break
    return _fewer(flights, MOST)


def _fewer(flights: list[Flight], most: int) -> list[Flight]:
    """Return flights with every so many of their rollouts, so that there are at most so many."""
    share = -(-sum(len(flight.first) for flight in flights) // most)
    return [replace(flight, first=flight.first[::share]) for flight in flights]
