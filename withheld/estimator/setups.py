# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Autopilots: sensors, a filter, rates; some to develop with, others to evaluate with."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from withheld.estimator.complementary import ComplementaryFilter
from withheld.estimator.kalman import ErrorStateFilter
from withheld.estimator.sensors import Aid, Imu


@dataclass(frozen=True)
class Setup:
    """
    An autopilot with its sensors.

    make_filter(start, aid) returns the filter; assumed s, the latency that it takes for true;
    cutoff Hz and order of the low pass of the gyro; control Hz, a multiple of the record's rate.
    """

    imu: Imu
    aid: Aid
    make_filter: Callable
    assumed: float
    cutoff: float
    order: int
    control: float


# Two sensors and two filters, paired otherwise for the evaluation, with other gains throughout.
SETUPS = {
    'development': (
        Setup(Imu(), Aid(100.0, 0.008, 0.001, attitude=0.004),
              partial(ErrorStateFilter, gyro=0.05, accelerometer=0.8, walks=(1e-3, 1e-2)),
              assumed=0.006, cutoff=60.0, order=1, control=100.0),
        Setup(Imu(gyro=0.005, accelerometer=0.1, gyro_bias=0.0005),
              Aid(10.0, 0.1, 0.02, velocity=0.04, heading=0.02),
              partial(ComplementaryFilter, level=0.05, turn=0.5, bias=5e-4, settle=1.0, blend=0.5),
              assumed=0.1, cutoff=80.0, order=2, control=250.0)),
    'evaluation': (
        Setup(Imu(gyro=0.006, accelerometer=0.1, shaking=(0.05, 0.8)),
              Aid(20.0, 0.08, 0.03, velocity=0.05, heading=0.03),
              partial(ErrorStateFilter, gyro=0.03, accelerometer=0.4, walks=(5e-4, 5e-3),
                      trust=1.5),
              assumed=0.08, cutoff=50.0, order=1, control=500.0),
        Setup(Imu(gyro=0.015, accelerometer=0.2, shaking=(0.02, 0.3)),
              Aid(50.0, 0.012, 0.0015, attitude=0.006),
              partial(ComplementaryFilter, level=4.0, turn=0.0, bias=2.0, settle=0.3),
              assumed=0.012, cutoff=40.0, order=2, control=100.0)),
}
