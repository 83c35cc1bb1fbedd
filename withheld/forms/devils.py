# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind of a dust devil."""

import numpy as np

from withheld.forms.air import Wind


class DustDevil(Wind):
    """
    A light wind and a dust devil, which wanders around: air turns about it, and rises within.

    Along the ground it goes inwards, and around what rises it sinks. The turning is that of J. M.
    Burgers, A mathematical model illustrating the theory of turbulence, Advances in Applied
    Mechanics 1, 1948; the rest as P. C. Sinclair, The lower structure of dust devils, Journal of
    the Atmospheric Sciences 30(8), 1973. As vehicles meet it over fields in the sun.
    """

    TURNS, INWARDS = 1.0, 0.12          # of the wind: the fastest turning; inwards, at most or so
    CORE = (0.7, 1.2)                   # m, where it turns fastest
    WANDERS, PERIODS = (0.6, 1.4), (16.0, 30.0)     # m, off the middle; s, once around
    HIGH = 3.0                          # m, up to which air goes inwards
    FASTEST = 0.71533                   # of the law of Burgers, at the core
    SPREAD = 1.25643

    def __init__(self, size, params, rng):
        """Draw the devil."""
        super().__init__(size, params, rng)
        self.core, self.wanders = rng.uniform(*self.CORE), rng.uniform(*self.WANDERS)
        fast = float(np.linalg.norm(self.mean))
        self.turns = rng.choice([-1.0, 1.0]) * self.TURNS * fast
        self.inwards = self.INWARDS * fast / self.core

    def begin(self, rng):
        """Draw where it is, and how it wanders."""
        self.rate = rng.choice([-1.0, 1.0]) * 2.0 * np.pi / rng.uniform(*self.PERIODS)
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def middle(self, time):
        """Return where it is, x and y."""
        angle = self.rate * time + self.phase
        return self.wanders * np.cos(angle), self.wanders * np.sin(angle)

    def wind(self, time, position):
        """Return the velocity of the air."""
        at = self.middle(time)
        x, y = position[0] - at[0], position[1] - at[1]
        r = (x * x + y * y) / self.core ** 2
        # Over the distance from it: that of turning, and that of going inwards.
        turns = self.turns / self.core * (
            -np.expm1(-self.SPREAD * r) / (self.FASTEST * max(r, 1e-9)))
        fades = np.exp(-r)
        high = min(max(position[2], 0.0), self.HIGH)
        goes = -self.inwards * fades if position[2] <= self.HIGH else 0.0
        rises = 2.0 * self.inwards * high * (1.0 - r) * fades
        return self.mean + np.array([goes * x - turns * y, goes * y + turns * x, rises])
