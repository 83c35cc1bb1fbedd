# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors and lines of commands that are neither one or two equal lags nor a constant delay."""

import numpy as np

from withheld.actuators import Line, Motor
from withheld.constants import hover_speed

TIME = 0.012        # s per size


class Underdamped(Motor):
    """A rotor whose speed a controller with an integral part makes overshoot; damped by 0.5."""

    DAMPING = 0.5

    def __init__(self, size, params, rng):
        """Set the time constant, 2 damping / frequency, which is the mean delay."""
        self.parameters = {'time': TIME * size}
        self.rate = 2.0 * self.DAMPING / (TIME * size) if size else np.inf
        self._slope = 0.0

    def turn(self, speeds, command, step):
        """Return the speeds, by the solution for a held command."""
        if not np.isfinite(self.rate):
            return command
        e, v, d = speeds - command, self._slope, self.DAMPING * self.rate
        w = np.sqrt(self.rate ** 2 - d ** 2)
        c, s, f = np.cos(w * step), np.sin(w * step), np.exp(-d * step)
        self._slope = f * (v * c - (d * v + self.rate ** 2 * e) / w * s)
        return command + f * (e * c + (v + d * e) / w * s)


class SpeedDependent(Motor):
    """A lag of the first order whose time constant falls with the speed, as damping grows."""

    def __init__(self, size, params, rng):
        """Set the time constant in hover."""
        self.parameters = {'time': TIME * size}
        self.hover = hover_speed(params)

    def turn(self, speeds, command, step):
        """Return the speeds."""
        time = self.parameters['time'] * self.hover / np.maximum(speeds, 0.1 * self.hover)
        return towards(speeds, command, time, step)


class TorqueBalance(Motor):
    """Torque for the commanded speed against the drag of the blades: both with the square."""

    def __init__(self, size, params, rng):
        """Set the time constant in hover."""
        self.parameters = {'time': TIME * size}
        self.hover = hover_speed(params)

    def turn(self, speeds, command, step):
        """Return the speeds of J dw/dt = k (command^2 - w^2)."""
        time = self.parameters['time'] * 2.0 * self.hover / np.maximum(
            speeds + command, 0.1 * self.hover)
        return towards(speeds, command, time, step)


class TwoPoles(Motor):
    """A filter in the speed controller before the lag of the motor, rotors a little unequal."""

    def __init__(self, size, params, rng):
        """Draw how the rotors differ."""
        self.times = TIME * size * rng.uniform(0.85, 1.15, params['num_rotors'])
        self.parameters = {'time': TIME * size}
        self._smooth = None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        smooth = speeds if self._smooth is None else self._smooth
        before = smooth
        self._smooth = towards(smooth, command, 0.4 * self.times, step)
        goal = 0.5 * (before + self._smooth) if np.any(self.times) else command
        return towards(speeds, goal, 0.6 * self.times, step)


class DeadBand(Motor):
    """A speed controller that takes a small error for none, with a lag of the first order."""

    BAND = 0.005        # of the speed in hover, per size

    def __init__(self, size, params, rng):
        """Set the time constant and the error, rad/s, below which there is no lag."""
        self.parameters = {'time': TIME * size, 'band': self.BAND * size * hover_speed(params)}

    def turn(self, speeds, command, step):
        """Return the speeds."""
        error = np.clip(command - speeds, -self.parameters['band'], self.parameters['band'])
        return towards(speeds, command - error, self.parameters['time'], step)


def towards(speeds, command, time, step):
    """Return the speeds after a step of a lag of the first order; time s, 0 for none."""
    with np.errstate(divide='ignore'):
        return command + (speeds - command) * np.exp(-step / np.asarray(time, float))


class Jitter(Line):
    """Each command takes between four and sixteen tenths of the mean time."""

    def __init__(self, size, params, rng):
        """Set the mean delay."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def begin(self, rng):
        """Take the flight's own draws."""
        self._rng = rng

    def waits(self, time):
        """Return the delay of one command."""
        return self.delay * self._rng.uniform(0.4, 1.6)


class Staggered(Line):
    """A bus that serves one rotor after another."""

    def __init__(self, size, params, rng):
        """Set the delays."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}
        self.shares = np.linspace(0.6, 1.4, params['num_rotors'])

    def waits(self, time):
        """Return the delays of the rotors."""
        return self.delay * self.shares


class Clocked(Line):
    """Actuators that ask for their command by a clock of their own, after a constant delay."""

    PERIOD = 0.007      # s, no multiple of any controller's

    def __init__(self, size, params, rng):
        """Set the constant part and the phase of the clock."""
        super().__init__(TIME * size)
        self.parameters = {'least': TIME * size}
        self.phase = rng.uniform(0.0, self.PERIOD)

    def waits(self, time):
        """Return the delay of one command; none at size 0."""
        if not self.delay:
            return 0.0
        return self.delay - (time + self.delay + self.phase) % -self.PERIOD


class Growing(Line):
    """A delay that grows as buffers fill: from 0.7 to 1.3 of its mean in 20 s."""

    def __init__(self, size, params, rng):
        """Set the mean."""
        super().__init__(TIME * size)
        self.parameters = {'mean': TIME * size}

    def waits(self, time):
        """Return the delay of one command."""
        return self.delay * (0.7 + 0.6 * min(time / 20.0, 1.0))
