# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Wind behind a wind turbine, and of a wall of fans."""

import numpy as np

from withheld.forms.air import Wind


class Turbine(Wind):
    """
    Wind behind a small wind turbine: slower, turned about its axis, and in beats of its blades.

    The wake widens on its way: N. O. Jensen, A note on wind generator interaction, Risoe-M-2411,
    1983. It turns the other way than the blades, as they take their torque from it.
    """

    AWAY, HIGH, RADIUS = 3.0, 1.3, 1.2      # m: before the place of the flight; of the axis
    WIDENS, EDGE = 0.08, 0.15               # of the way; of the radius, within which it ends
    SLOWER, TURNS, BEATS = 0.45, 0.35, 0.2  # of the mean
    BLADES, SPIN = 3, 2.0 * np.pi * 0.45    # rad/s

    def __init__(self, size, params, rng):
        """Draw how the axis lies beside the flight, and which way it turns."""
        super().__init__(size, params, rng)
        self.along = self.mean / max(float(np.linalg.norm(self.mean)), 1e-9)
        self.across = np.array([-self.along[1], self.along[0], 0.0])
        self.off, self.spin = rng.uniform(-0.8, 0.8), self.SPIN * rng.choice([-1.0, 1.0])

    def begin(self, rng):
        """Draw where its blades are."""
        self.phase = rng.uniform(0.0, 2.0 * np.pi)

    def wind(self, time, position):
        """Return the velocity of the air."""
        way = max(self.AWAY + position @ self.along, 0.0)
        radius = self.RADIUS + self.WIDENS * way
        y, z = (position @ self.across - self.off) / radius, (position[2] - self.HIGH) / radius
        far = float(np.hypot(y, z))
        inside = 0.5 * (1.0 - np.tanh((far - 1.0) / self.EDGE))
        beat = np.cos(self.BLADES * (np.arctan2(z, y) - self.spin * time) + self.phase)
        slower = self.SLOWER * (self.RADIUS / radius) ** 2 - self.BEATS * min(far, 1.0) * beat
        turned = -np.sign(self.spin) * self.TURNS * np.array([0.0, 0.0, y]) + (
            np.sign(self.spin) * self.TURNS * z * self.across)
        speed = float(np.linalg.norm(self.mean))
        return speed * ((1.0 - inside * slower) * self.along + inside * turned)


class FanWall(Wind):
    """
    Wind of a wall of many small fans, of which each blows as its program has it.

    F. Noca and others, Wind and weather facility for testing free-flying drones, AIAA Aviation
    Forum 2019. Side by side their jets mix.
    """

    ROWS, COLUMNS, APART = 8, 14, 0.35      # fans above and beside each other; m
    MIXES = 0.22                            # m
    DEPTH, SWINGS = 0.5, 0.4                # of the logarithm of the speed; of it, in time
    PERIODS = (2.0, 8.0)                    # s

    def __init__(self, size, params, rng):
        """Draw how fast each fan is."""
        super().__init__(size, params, rng)
        along = self.mean / max(float(np.linalg.norm(self.mean)), 1e-9)
        self.across = np.array([-along[1], along[0], 0.0])
        count = self.ROWS * self.COLUMNS
        row, column = np.divmod(np.arange(count), self.COLUMNS)
        self.places = self.APART * np.column_stack(
            [column - 0.5 * (self.COLUMNS - 1), row + 0.5])
        speeds = np.exp(self.DEPTH * rng.normal(size=count))
        self.speeds = speeds / np.mean(speeds)
        self.rates = 2.0 * np.pi / rng.uniform(*self.PERIODS, count)

    def begin(self, rng):
        """Draw the phases of the programs."""
        self.phases = rng.uniform(0.0, 2.0 * np.pi, len(self.speeds))

    def wind(self, time, position):
        """Return the velocity of the air."""
        limit = np.max(self.places, axis=0)
        here = np.clip([position @ self.across, position[2]], [-limit[0], 0.0], limit)
        near = np.exp(-0.5 * np.sum((self.places - here) ** 2, axis=1) / self.MIXES ** 2)
        now = self.speeds * (1.0 + self.SWINGS * np.sin(self.rates * time + self.phases))
        return float(near @ now / np.sum(near)) * self.mean
