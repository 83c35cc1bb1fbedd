# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How a controller tracks with the nominal vehicle, with the corrected one, and in reality."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.closed_loop.bandwidth import (
    bandwidth_of_flight,
    bandwidth_of_multisine,
    multisine,
)
from quad_ident_ros.closed_loop.reference import Reference, wanted_of
from quad_ident_ros.flight.controller import Controller
from quad_ident_ros.flight.fly import flown
from quad_ident_ros.model.attitude import euler_from_quaternion
from quad_ident_ros.model.sensors import recorded
from quad_ident_ros.model.vehicle import Vehicle

UNITS = {'position': 'm', 'velocity': 'm/s', 'yaw': 'rad'}
NOMINAL, CORRECTED, REAL = 'nominal', 'corrected', 'real'
BEGIN = 3.0         # s that do not count: a flight may begin in motion, the loops begin in hover
LOST = 100.0        # arms off the path, from where on a vehicle has left it

Errors = dict[str, float | None]
Bandwidths = dict[str, float | None] | None


@dataclass(frozen=True)
class ClosedLoop:
    """
    Tracking of a path and bandwidth, by vehicle: nominal, corrected and real.

    controller: as it was named; asked: whether the path is what the record of the flight says it
    was asked for, or else the smooth path that it flew, and then nothing is known of the real one;
    seconds: of the path; units of tracking; tracking {vehicle: {group: rms error}}, None
    where it leaves its path; bandwidth {vehicle: {axis: Hz}}, None of an axis where it is beyond
    what shows it, and of a vehicle that leaves the path which shows it; without
    {effect: {group: rms error}} and bandwidth_without {effect: {axis: Hz}} of the corrected
    vehicle without an effect.
    """

    controller: str
    asked: bool
    seconds: float
    units: dict[str, str]
    tracking: dict[str, Errors]
    bandwidth: dict[str, Bandwidths]
    without: dict[str, Errors]
    bandwidth_without: dict[str, Bandwidths]


class _LeavesPathError(Exception):
    """A vehicle is farther from its path than can be."""


class _Watched:
    """A Controller that ends the flight of a vehicle that has left its path."""

    def __init__(self, controller: Controller, farthest: float) -> None:
        self._controller, self._farthest = controller, farthest

    def reset(self) -> None:
        self._controller.reset()

    def control(self, seen: np.ndarray, wanted: np.ndarray, dt: float, command: np.ndarray
                ) -> None:
        if not np.linalg.norm(seen[:3] - wanted[:3]) <= self._farthest:
            raise _LeavesPathError
        self._controller.control(seen, wanted, dt, command)


def compare(name: str, controller: Controller, reference: Reference, vehicle: Vehicle,
            nominal: np.ndarray, corrected: np.ndarray, without: Mapping[str, np.ndarray],
            on_progress: Callable[[float], None] = lambda share: None) -> ClosedLoop:
    """
    Return the ClosedLoop of a controller along a Reference.

    The loops fly without noise, from hover at the begin of the path, BEGIN of which does not
    count. Bandwidths are those of a small multisine about hover there; that of reality is by the
    spectra of the flight. Args: name of the controller; nominal, corrected (P,): parameter
    vectors of effects; without {effect: (P,)}: corrected without each.
    """
    watched = _Watched(controller, LOST * vehicle.arm_length)
    flights = 2 * (2 + len(without))
    done = 0

    def told() -> None:
        nonlocal done
        done += 1
        on_progress(done / flights)

    def shown(jobs: Mapping[str, np.ndarray]
              ) -> tuple[dict[str, Errors], dict[str, Bandwidths]]:
        errors: dict[str, Errors] = {}
        bands: dict[str, Bandwidths] = {}
        for who, theta in jobs.items():
            errors[who] = _tracked(watched, reference, vehicle, theta)
            told()
            bands[who] = _bandwidth(watched, reference, vehicle, theta)
            told()
        return errors, bands

    tracking, bandwidth = shown({NOMINAL: nominal, CORRECTED: corrected})
    left_out = shown(without)
    if reference.asked:
        tracking[REAL] = errors_of(reference, reference.flown)
        # The smooth path has nothing above the frequencies of its knots.
        bandwidth[REAL] = bandwidth_of_flight(reference.path, reference.flown[:, [0, 1, 2, 6]],
                                              reference.rate)
    return ClosedLoop(name, reference.asked, len(reference.wanted) / reference.rate, dict(UNITS),
                      tracking, bandwidth, *left_out)


def errors_of(reference: Reference, path: np.ndarray) -> Errors:
    """Return the rms errors of a path (N, 7) in position, velocity and yaw, from BEGIN on."""
    first = int(BEGIN * reference.rate)
    wanted, path = reference.wanted[first:], path[first:]
    turn = path[:, 6] - wanted[:, 12]
    errors = {'position': path[:, :3] - wanted[:, :3], 'velocity': path[:, 3:6] - wanted[:, 3:6],
              'yaw': (np.mod(turn + np.pi, 2.0 * np.pi) - np.pi)[:, None]}
    return {group: float(np.sqrt(np.mean(np.sum(error ** 2, axis=1))))
            for group, error in errors.items()}


def _tracked(controller: Controller, reference: Reference, vehicle: Vehicle, theta: np.ndarray
             ) -> Errors:
    path = _path(controller, reference.wanted, reference.rate, vehicle, theta)
    return dict.fromkeys(UNITS) if path is None else errors_of(reference, path)


def _bandwidth(controller: Controller, reference: Reference, vehicle: Vehicle,
               theta: np.ndarray) -> Bandwidths:
    """Return the bandwidths about hover at the begin of a Reference, or None off the path."""
    asked = multisine(reference.rate)
    halves = [np.zeros_like(asked), np.zeros_like(asked)]
    for sign in (1.0, -1.0):
        path = sign * asked + reference.wanted[0, [0, 1, 2, 12]]
        wanted = wanted_of(np.arange(len(path)) / reference.rate, path, 0.02)
        found = _path(controller, wanted, reference.rate, vehicle, theta)
        if found is None:
            return None
        halves[0] += 0.5 * sign * wanted[:, [0, 1, 2, 12]]
        halves[1] += 0.5 * sign * found[:, [0, 1, 2, 6]]
    return bandwidth_of_multisine(*halves)


def _path(controller: Controller, wanted: np.ndarray, rate: float, vehicle: Vehicle,
          theta: np.ndarray) -> np.ndarray | None:
    """Return the path (N, 7) as it would be recorded, or None where the vehicle leaves it."""
    rest = wanted[:1].copy()
    rest[:, 3:12] = rest[:, 13:] = 0.0      # before, the vehicle hovers where the path begins
    whole = np.concatenate([rest, wanted])
    try:
        states = flown(vehicle, theta, whole, np.zeros((len(whole), 12)), rate, controller)[0][1:]
    except _LeavesPathError:
        return None
    states = recorded(theta, states)
    yaw = np.unwrap(euler_from_quaternion(states[:, 6:10])[:, 2])
    return np.hstack([states[:, :6], yaw[:, None]])
