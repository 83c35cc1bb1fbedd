# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Controllers as users write them, good ones and bad ones."""

from functools import partial

import numpy as np

MASS, GRAVITY, THRUST, TORQUE, ARM = 0.5, 9.81, 5.57e-6, 1.36e-7, 0.12020815
INERTIA = np.array([0.00365, 0.00368, 0.00703])
SIGNS = np.array([[1, 1, 1, 1], [1, -1, -1, 1], [-1, -1, 1, 1], [1, -1, 1, -1]])


class Cascade:
    """A small one for the hummingbird: position, tilt and heading, without integrals."""

    def reset(self):
        self.calls = 0

    def control(self, state, reference, dt):
        self.calls += 1
        place, velocity, (w, x, y, z), rate = state[:3], state[3:6], state[6:10], state[10:]
        push = (4.0 * (reference[:3] - place) + 3.4 * (reference[3:6] - velocity)
                + reference[6:9] + [0.0, 0.0, GRAVITY])
        up = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        heading = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        wanted = push / np.linalg.norm(push)
        across = np.cross(up, wanted)
        cos, sin = np.cos(heading), np.sin(heading)
        turn = reference[12] - heading
        tilt = np.array([cos * across[0] + sin * across[1], -sin * across[0] + cos * across[1],
                         0.1 * np.arctan2(np.sin(turn), np.cos(turn))])
        moment = INERTIA * (100.0 * tilt - 16.0 * rate + [0, 0, 10.0 * rate[2]])
        needed = np.array([MASS * (push @ up), *moment])
        per_square = SIGNS * np.array([THRUST, THRUST * ARM, THRUST * ARM, TORQUE])[:, None]
        return np.sqrt(np.maximum(np.linalg.solve(per_square, needed), 0.0))


class Idle(Cascade):
    """It lets the vehicle fall."""

    def control(self, state, reference, dt):
        return np.zeros(4)


class Blind(Cascade):
    """A little less than the speeds of hover, whatever happens."""

    def control(self, state, reference, dt):
        return np.full(4, np.sqrt(0.995 * MASS * GRAVITY / (4 * THRUST)))


class Short(Cascade):
    """Three speeds for four rotors."""

    def control(self, state, reference, dt):
        return np.zeros(3)


class Words(Cascade):
    """No numbers."""

    def control(self, state, reference, dt):
        return 'fast'


class Endless(Cascade):
    """One is not a number."""

    def control(self, state, reference, dt):
        return [1.0, np.nan, 1.0, 1.0]


class Broken(Cascade):
    """It raises an error."""

    def control(self, state, reference, dt):
        return 1 / 0


class Complex(Cascade):
    """No real numbers."""

    def control(self, state, reference, dt):
        return np.full(4, 1j)


class Huge(Cascade):
    """Beyond what a float holds."""

    def control(self, state, reference, dt):
        return [10 ** 400] * 4


class Partial(Cascade):
    """A method without a name; three speeds for four rotors."""

    control = partial(lambda count, *told: np.zeros(count), 3)


class SilentError(Exception):
    """An error that cannot say what it is."""

    def __str__(self):
        raise ValueError


class Silent(Cascade):
    """It raises an error that says nothing."""

    def control(self, state, reference, dt):
        raise SilentError


class Property(Cascade):
    """To ask for its method raises an error."""

    @property
    def control(self):
        return 1 / 0


class Half:
    """It cannot control."""

    def reset(self):
        pass
