# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulators as users write them: rigid bodies in plain NumPy, with equations of their own."""

import numpy as np

MASS, THRUST, TORQUE, LAG = 0.5, 5.57e-6, 1.36e-7, 0.03
INERTIA = np.array([3.65e-3, 3.68e-3, 7.03e-3])
SIDE = 0.12020815
PLACES = SIDE * np.array([[1, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]])
SPINS = np.array([1, -1, 1, -1])
FINE = 0.002    # s


def cross(a, b):
    """Return products (B, 3) across; that of NumPy takes most of a step of one vehicle."""
    return a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]


def turned(q, vector):
    """Return vectors (B, 3) of the body in the world."""
    w, u = q[:, :1], q[:, 1:]
    return vector + 2.0 * cross(u, cross(u, vector) + w * vector)


class Many:
    """All at once, no lag, no air."""

    lag, drag, fine = 0.0, 0.0, FINE

    def step_many(self, states, commands, dt):
        return self.advance(states, commands, dt, 0.0, 0.0)

    def advance(self, states, commands, dt, force, moment):
        count = int(np.ceil(np.max(dt) / self.fine))
        h = (dt / count)[:, None]
        for _ in range(count):
            a = self.slope(states, commands, force, moment)
            b = self.slope(states + 0.5 * h * a, commands, force, moment)
            c = self.slope(states + 0.5 * h * b, commands, force, moment)
            d = self.slope(states + h * c, commands, force, moment)
            states = states + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            states[:, 6:10] /= np.linalg.norm(states[:, 6:10], axis=1, keepdims=True)
        return states

    def slope(self, x, commands, force, moment):
        v, q, w, turning = x[:, 3:6], x[:, 6:10], x[:, 10:13], x[:, 13:]
        speeds = turning if self.lag else commands
        thrusts = THRUST * speeds ** 2
        push = np.zeros_like(v)
        push[:, 2] = thrusts.sum(axis=1)
        back = np.concatenate([q[:, :1], -q[:, 1:]], axis=1)
        air = turned(back, v)
        air[:, 2] = 0.0
        acceleration = turned(q, push - self.drag * air + force) / MASS
        acceleration[:, 2] -= 9.81
        twist = np.stack([thrusts @ PLACES[:, 1], -thrusts @ PLACES[:, 0],
                          TORQUE * speeds ** 2 @ SPINS], axis=1) + moment
        turn = (twist - cross(w, INERTIA * w)) / INERTIA
        dq = 0.5 * np.concatenate([
            -np.sum(q[:, 1:] * w, axis=1, keepdims=True),
            q[:, :1] * w + cross(q[:, 1:], w)], axis=1)
        rising = (commands - turning) / self.lag if self.lag else np.zeros_like(turning)
        return np.concatenate([v, acceleration, dq, turn, rising], axis=1)


class ManyLagged(Many):
    """With motors that lag."""

    lag = LAG


class ManyPushed(Many):
    """Takes force and moment."""

    def step_many(self, states, commands, dt, force, moment):
        return self.advance(states, commands, dt, force, moment)


class One(Many):
    """One state at a time; it does not return the speeds of its rotors."""

    step_many = None

    def reset(self, state):
        self.state = state[None]

    def step(self, commands, dt):
        self.state = self.advance(self.state, commands[None], np.array([dt]), 0.0, 0.0)
        return self.state[0, :13]


class OneLagged(One):
    """With motors that lag, whose speeds it returns."""

    lag = LAG

    def step(self, commands, dt):
        super().step(commands, dt)
        return self.state[0]


class OnePushed(One):
    """Takes force and moment."""

    def step(self, commands, dt, force, moment):
        self.state = self.advance(self.state, commands[None], np.array([dt]), force, moment)
        return self.state[0, :13]


class Dragged(Many):
    """With a drag of the body that its vehicle file may not know."""

    drag = 0.3
