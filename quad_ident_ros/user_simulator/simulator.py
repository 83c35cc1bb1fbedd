# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A user's simulator as what flies predictions, on all cores where it flies one at a time."""

from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
import os
from time import perf_counter
from types import TracebackType

import numpy as np

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
    effects have them around it, see plan.plan_of.
    """

    def __init__(self, spec: str, vehicle: Vehicle) -> None:
        self.spec, self.vehicle = spec, vehicle
        self._program = Program(spec)
        self._pool: ProcessPoolExecutor | None = None
        hover = np.full(len(vehicle.rotors), vehicle.hover_speed)
        still = np.concatenate([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], np.zeros(6)])[None]
        self._fly(Plan(still, hover[None], np.full((1, 1), 0.01), hover[None, None],
                       hover[None, None], None))     # so that what is wrong shows at once

    def __enter__(self) -> 'Simulator':
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

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
        if self._program.at_once or cores == 1 or batch < 2:
            return fly(self._program, plan)
        begun = perf_counter()
        done = [fly(self._program, plan.part(slice(0, 1)))]
        if self._pool is None and (perf_counter() - begun) * batch < WORTH:
            return np.concatenate([*done, fly(self._program, plan.part(slice(1, batch)))])
        if self._pool is None:
            # Started afresh: a copy of this process would have the locks of its threads.
            self._pool = ProcessPoolExecutor(cores, get_context('spawn'), _load, (self.spec,))
        edges = np.linspace(1, batch, min(PARTS * cores, batch - 1) + 1).astype(int)
        parts = [plan.part(slice(*edge)) for edge in zip(edges[:-1], edges[1:], strict=True)]
        try:
            return np.concatenate([*done, *self._pool.map(_fly_here, parts)])
        except BrokenProcessPool:
            raise InputError(f'{self.spec}: it ended the process in which it flew; run it by '
                             'itself to see why') from None


_HERE: list[Program] = []     # the simulator of a process that flies nothing else


def _load(spec: str) -> None:
    _HERE.append(Program(spec))


def _fly_here(plan: Plan) -> np.ndarray:
    return fly(_HERE[0], plan)
