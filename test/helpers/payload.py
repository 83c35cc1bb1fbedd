# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A vehicle that picks up a payload in flight and may drop it, simulated."""

from functools import cache

import numpy as np

from quad_ident_ros.data.record import FlightRecord

PERIOD = 0.01
MASS, PAYLOAD, GRAVITY, DRAG = 0.65, 0.2, 9.806, 6.354e-4
PICKED_UP = 12.0       # s
START_NS = 1_795_402_874_187_903_202    # of 2026, which no double has exactly


@cache
def climb(payload, noise=0.005, seed=0, length=20.0, dropped=np.inf, tilt=0.0):
    """
    Return a flight record in z under a controller with steps.

    The payload is there from PICKED_UP until dropped, s. m z'' = U1 - m g - k z', each sample's
    held input integrated in 20 steps. tilt, rad: the largest, to and fro beside the climbs; the
    controller makes up for what it takes of the vertical part of the thrust.
    """
    random = np.random.default_rng(seed)
    count = round(length / PERIOD)
    t = np.arange(count) * PERIOD
    z, rate, target = 0.0, 0.0, 0.0
    phi, theta = tilt * np.sin(1.3 * t), tilt * np.sin(0.9 * t) * np.cos(1.3 * t)
    share = np.cos(phi) * np.cos(theta)
    heights, thrusts = np.empty(count), np.empty(count)
    for k in range(count):
        mass = MASS + (payload if PICKED_UP <= t[k] < dropped else 0.0)
        if k % 30 == 0:
            target = random.choice([-1.0, 1.0])
        thrust = MASS * GRAVITY + target - 4.0 * z - 3.0 * rate
        heights[k], thrusts[k] = z, thrust / share[k]
        for _ in range(20):
            rate += ((thrust - DRAG * rate) / mass - GRAVITY) * PERIOD / 20
            z += rate * PERIOD / 20
    heights = heights + noise * random.normal(size=count)
    zero = np.zeros(count)
    if tilt:
        phi, theta = (each + 0.002 * random.normal(size=count) for each in (phi, theta))
    return FlightRecord(t, {'phi': phi, 'theta': theta, 'psi': zero, 'pz': heights,
                            'u1': thrusts, 'u2': zero, 'u3': zero, 'u4': zero},
                        {'trim': [MASS * GRAVITY, 0.0, 0.0, 0.0], 'start_ns': START_NS})
