# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The gap of a user's own simulator: as it is, and with the effects of a diagnosis around it."""

from collections.abc import Callable
from dataclasses import replace

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.judgement import Judgement
from quad_ident_ros.diagnose.measure import channels
from quad_ident_ros.diagnose.residual_wrench import residual_wrench
from quad_ident_ros.diagnose.result import GapInSimulator
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import inertial
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.user_simulator.simulator import Simulator


def refuse_inertial(bench_flights: list) -> None:
    """Raise InputError where flights have no states from which a simulator could begin."""
    if inertial(bench_flights):
        raise InputError('--simulator: these flights have neither position nor velocity, and no '
                         'simulator can begin where they are; give flights that have both')


def gap_in_simulator(simulator: Simulator, bench: Bench, judged: Judgement,
                     on_progress: Callable[[float], None] = lambda share: None
                     ) -> GapInSimulator:
    """
    Return the gap of a simulator on the flight held out, and where it lies.

    Full open loop, from the starts of the model's own predictions. on_progress is called with
    the share done. Raises InputError for what is wrong with the simulator.
    """
    z0, model = nominal(bench.vehicle), judged.model
    nuisances = [z - model.z for z in model.vectors]
    free = [replace(track, guide=None) for track in bench.tracks]
    jobs, done = 3 + len(nuisances) - 1, 0

    def told() -> None:
        nonlocal done
        done += 1
        on_progress(done / jobs)

    stages = []
    for z in (z0, z0 + nuisances[-1], model.vectors[-1]):
        stages.append(gaps.ends(free[-1], bench.vehicle, z, bench.horizon, simulator))
        told()
    by_model = gaps.ends(free[-1], bench.vehicle, z0, bench.horizon)
    wrenches = []
    for track, nuisance in zip(free[:-1], nuisances[:-1], strict=True):
        wrenches.append(residual_wrench(track, bench.vehicle, z0 + nuisance,
                                        bench.noise.deviation, simulator))
        told()
    before, before_own, after = (gaps.gap([one]) for one in stages)
    noise = gaps.noise_gap(free[-1], bench.vehicle, model.vectors[-1], judged.noises[-1],
                           bench.horizon)
    apart = gaps.Ends(stages[0].errors - by_model.errors, by_model.t)
    return GapInSimulator(
        simulator=simulator.spec, horizon=bench.horizon, before=before, before_own=before_own,
        after=after, noise=noise, before_interval=gaps.interval([stages[0]], bench.rules),
        after_interval=gaps.interval([stages[2]], bench.rules),
        closed=gaps.closed(before_own['velocity'], after['velocity'], noise['velocity']),
        from_nominal=gaps.gap([apart]),
        where=channels(tuple(wrenches), bench.vehicle, bench.rules))
