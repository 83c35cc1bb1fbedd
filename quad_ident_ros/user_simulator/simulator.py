# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A user's simulator as what flies predictions, on all cores where it flies one at a time."""

from contextlib import ExitStack
from functools import lru_cache, partial
import os
from time import perf_counter
from types import TracebackType
from typing import Any

import numpy as np

from quad_ident_ros.cluster import cluster, is_installed, values, WorkerDied
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import Track
from quad_ident_ros.greybox.parameters import SPLIT
from quad_ident_ros.model.dynamics import steps_within
from quad_ident_ros.model.sensors import recorded
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.user_simulator.fly import fly
from quad_ident_ros.user_simulator.plan import Plan, plan_of, sensors_alone
from quad_ident_ros.user_simulator.program import Program

WORTH = 2.0     # s of flying from which on further processes are worth their start
PARTS = 4       # of a job for each process, so that none waits long for another


class Simulator:
    """
    The simulator FILE.py:NAME of a vehicle, a Predictor; to be used in a `with`.

    Its vehicle is that which it flies, with the effects that it has. Predictions with other
    effects have them around it, see plan.plan_of. One that flies a state at a time does so on all
    cores where Dask is installed.
    """

    def __init__(self, spec: str, vehicle: Vehicle) -> None:
        self.spec, self.vehicle = spec, vehicle
        self._program = Program(spec)
        self._client: Any = None
        self._workers = ExitStack()
        hover = np.full(len(vehicle.rotors), vehicle.hover_speed)
        still = np.concatenate([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], np.zeros(6)])[None]
        self._fly(Plan(still, hover[None], np.full((1, 1), 0.01), hover[None, None],
                       hover[None, None], None))     # so that what is wrong shows at once

    def __enter__(self) -> 'Simulator':
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self._workers.close()

    def __call__(self, track: Track, vehicle: Vehicle, z: np.ndarray, starts: np.ndarray,
                 first: np.ndarray, count: int) -> np.ndarray:
        """Return what rollouts along a Track would record, as a Predictor does."""
        theta = z[SPLIT:]
        plan = plan_of(self.vehicle, theta, track.course, starts, first, count)
        states = self._fly(plan)[:, ::steps_within(track.course.t)]
        return recorded(sensors_alone(theta), states)

    def _fly(self, plan: Plan) -> np.ndarray:
        """Return the true states (B, M + 1, 13) along a Plan."""
        batch, cores = len(plan.starts), len(os.sched_getaffinity(0))
        if self._program.at_once or cores == 1 or batch < 2 or not is_installed():
            return fly(self._program, plan)
        begun = perf_counter()
        done = [fly(self._program, plan.part(slice(0, 1)))]
        if self._client is None and (perf_counter() - begun) * batch < WORTH:
            return np.concatenate([*done, fly(self._program, plan.part(slice(1, batch)))])
        if self._client is None:
            self._client = self._workers.enter_context(cluster(workers=cores))
        edges = np.linspace(1, batch, min(PARTS * cores, batch - 1) + 1).astype(int)
        parts = [plan.part(slice(*edge)) for edge in zip(edges[:-1], edges[1:], strict=True)]
        try:
            flown = {number: states for (number, _), states in values(
                self._client, partial(_fly_there, self._program.spec), enumerate(parts))}
        except WorkerDied:
            raise InputError(f'{self.spec}: it ended the process in which it flew; run it by '
                             'itself to see why') from None
        return np.concatenate([*done, *(flown[number] for number in range(len(parts)))])


_program_there = lru_cache(1)(Program)
"""The simulator of a worker, by its specification."""


def _fly_there(spec: str, part: tuple[int, Plan]) -> np.ndarray:
    return fly(_program_there(spec), part[1])
