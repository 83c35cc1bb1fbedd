# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What logging does to a flight, and what flights of one vehicle do not share."""

from dataclasses import dataclass

import numpy as np

from withheld.influence import Influence


@dataclass(frozen=True)
class Logging:
    """
    How a flight is controlled and logged.

    every: commands per row; low_pass Hz of the rate that is measured, 0 without; bits of a
    command in the log, from 0 to the largest speed, 0 for all.
    """

    every: int = 1
    low_pass: float = 0.0
    bits: int = 0

    def logged(self, commands, largest):
        """Return the commands (N, n) as the log has them."""
        if not self.bits:
            return commands
        unit = largest / (2 ** self.bits - 1)
        return unit * np.round(commands / unit)


@dataclass(frozen=True)
class Log:
    """
    A way of flying and logging that real records have.

    logging; charge: the largest change of the thrust from flight to flight; landing: with take-off
    and landing on a floor; flights, or None for as many as the set has.
    """

    logging: Logging = Logging()
    charge: float = 0.0
    landing: bool = False
    flights: int | None = None


LOGS = {'': Log(), 'fast_control': Log(Logging(every=5)), 'low_pass': Log(Logging(low_pass=20.0)),
        'bits_8': Log(Logging(bits=8)), 'bits_11': Log(Logging(bits=11)),
        'charge': Log(charge=0.03), '20_hz': Log(Logging(every=5)),
        'one_flight': Log(flights=1), 'landing': Log(landing=True),
        'dropped': Log()}      # a payload falls off midway: a form of mass_offset
PERIODS = {'20_hz': 0.05}       # s, where it is not that of the other records


class LowPass:
    """A filter of the first order, at samples `step` s apart; 0 Hz leaves what comes."""

    def __init__(self, frequency, step):
        """Set the share of each sample."""
        self.share = 1.0 - np.exp(-2.0 * np.pi * frequency * step) if frequency else 1.0
        self.value = None

    def __call__(self, values):
        """Return the filtered values (3,) after another sample."""
        if self.value is None:
            self.value = values
        self.value = self.value + self.share * (values - self.value)
        return self.value


class Charge(Influence):
    """Thrust that is a flight's own: the battery was more or less full."""

    def __init__(self, factor):
        """Take the factor on the thrust of all rotors."""
        self.factor = factor

    def gain(self, now):
        """Return the factor."""
        return self.factor


class Grounded:
    """
    A path with take-off and landing: stand, climb, follow a path, sink, stand.

    Args: path with update(t); seconds of the flight; floor m; stand and climb s.
    """

    def __init__(self, path, seconds, floor, stand=1.5, climb=2.5):
        """Find where the climb ends and the descent begins."""
        self.path, self.floor, self.stand, self.climb = path, floor, stand, climb
        self.up, self.down = stand + climb, seconds - stand - climb
        self.first, self.last = path.update(self.up), path.update(self.down)

    def update(self, t):
        """Return rotorpy's flat outputs at t, s; 'idle' where the rotors do not fly."""
        if self.up <= t <= self.down:
            return self.path.update(t)
        aim = self.first if t < self.up else self.last
        # Of the fifth order towards what the path does where it begins or ends.
        share = np.clip((t - self.stand) / self.climb if t < self.up
                        else (self.down + self.climb - t) / self.climb, 0.0, 1.0)
        sign = 1.0 if t < self.up else -1.0
        start = np.array([*aim['x'][:2], self.floor])
        x, v, a = _joined(start, aim, share, self.climb, sign)
        zero = np.zeros(3)
        return {'x': x, 'x_dot': v, 'x_ddot': a, 'x_dddot': zero, 'x_ddddot': zero,
                'yaw': aim['yaw'], 'yaw_dot': 0.0, 'yaw_ddot': 0.0,
                'idle': share == 0.0}


def _joined(start, aim, share, length, sign):
    """Return place, velocity, acceleration of the quintic from rest to what the aim does."""
    gap, v, a = aim['x'] - start, sign * length * aim['x_dot'], length ** 2 * aim['x_ddot']
    c3 = 10 * gap - 4 * v + 0.5 * a
    c4 = -15 * gap + 7 * v - a
    c5 = 6 * gap - 3 * v + 0.5 * a
    place = start + c3 * share ** 3 + c4 * share ** 4 + c5 * share ** 5
    speed = 3 * c3 * share ** 2 + 4 * c4 * share ** 3 + 5 * c5 * share ** 4
    turn = 6 * c3 * share + 12 * c4 * share ** 2 + 20 * c5 * share ** 3
    return place, sign * speed / length, turn / length ** 2
