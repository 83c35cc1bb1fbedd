# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How much is measured."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Size:
    """
    How much is measured.

    draws: of the noise on P1; share_draws: on P2, for the share of fits at the optimum; seconds:
    CPU time after which a slow method gets no further draw; long_runs, long_budget,
    long_seconds: searches for the best cost, their evaluations and CPU time; largest: samples of
    the longest record; accuracy_draws: per scenario of the accuracy study, and ten times that, to
    distinguish chance from fault; flight: s of each flight through the nodes; rollouts: calls of
    each kind of rollout; diagnoses: vehicles that are diagnosed; real_flights: that are diagnosed
    together; long_flight: s of each long one; clean_flights: of each noise that are checked;
    change_flights: with a change of the vehicle, and as many without; fleet_flights: that a fleet
    has, light_flights: of a fleet that are refused at once; day_fleets: whose flights share days,
    of each kind; spring_fleets: that fly in one spring, of each kind.
    """

    draws: int = 30
    share_draws: int = 200
    seconds: float = 10.0
    long_runs: int = 3
    long_budget: int = 100_000
    long_seconds: float = 20.0
    largest: int = 5_000_000
    accuracy_draws: tuple = (200, 2000)
    flight: float = 60.0
    rollouts: int = 21
    diagnoses: int = 100
    real_flights: int = 7
    long_flight: float = 1200.0
    clean_flights: int = 200
    change_flights: int = 100
    fleet_flights: int = 100
    light_flights: int = 10_000
    day_fleets: int = 40
    spring_fleets: int = 100


QUICK = Size(draws=3, share_draws=4, seconds=1.0, long_runs=1, long_budget=20_000,
             long_seconds=2.0, largest=50_000, accuracy_draws=(10, 20), flight=8.0,
             rollouts=3, diagnoses=3, real_flights=2, long_flight=60.0, clean_flights=4,
             change_flights=4, fleet_flights=4, light_flights=200, day_fleets=2,
             spring_fleets=2)
