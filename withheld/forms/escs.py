# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What speed controllers make of a command: motors that coast or creep, and a coarse table."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.body import signs
from withheld.forms.motors import TIME, towards
from withheld.influence import Influence


class Coasting(Motor):
    """
    A motor that its controller drives but does not brake: it falls as its propeller slows it.

    Upwards a lag of the first order, downwards never faster than dw/dt = -B w^2. Controllers
    with and without active braking: A. Franchi, A. Mallet, Adaptive closed-loop speed control of
    BLDC motors with applications to multi-rotor aerial vehicles, ICRA 2017.
    """

    SLOWING = 10.0      # 1/s, of a propeller alone at the speed of hover, for size 1

    def __init__(self, size, params, rng):
        """Set the time constant of what is driven, and how slowly it falls."""
        grown = size ** 0.7     # the gap grows faster than the lag
        self.parameters = {'time': 0.75 * TIME * grown}
        self.slowing = self.SLOWING / (grown * hover_speed(params)) if size else np.inf

    def turn(self, speeds, command, step):
        """Return the speeds."""
        driven = towards(speeds, command, self.parameters['time'], step)
        return np.maximum(driven, speeds / (1.0 + self.slowing * step * speeds))


class SlowTail(Motor):
    """
    Most of a step at once and the rest slowly, as of a forward path with a slow integral beside.

    A pole close to a zero: K. J. Astrom, T. Hagglund, Advanced PID Control, 2006, section 4.
    """

    SHARE, SLOW = 0.25, 3.0     # of a step, and times the mean time, of what is slow

    def __init__(self, size, params, rng):
        """Set the times of both parts; their mean is that of a lag."""
        self.parameters = {'time': TIME * size}
        self.slow = self.SLOW * TIME * size
        self.fast = (TIME * size - self.SHARE * self.slow) / (1.0 - self.SHARE)
        self._parts = None

    def turn(self, speeds, command, step):
        """Return the speeds."""
        fast, slow = (speeds, speeds) if self._parts is None else self._parts
        self._parts = towards(fast, command, self.fast, step), towards(slow, command, self.slow,
                                                                       step)
        return (1.0 - self.SHARE) * self._parts[0] + self.SHARE * self._parts[1]


class Scalloped(Influence):
    """
    A thrust curve from a table with few points, between which commands are on straight lines.

    The root that turns thrust to speed is bent, so the thrust is too high or too low in arcs from
    point to point (the error of linear interpolation: C. de Boor, A Practical Guide to Splines,
    1978, chapter 3).
    """

    POINTS = 0.22       # of the speed in hover, from one point to the next
    DEPTH = 1.5         # of an arc, by the factor that it is about

    def __init__(self, size, params, rng):
        """Draw whether it is more or less, and where the points are."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover, self.first = hover_speed(params), rng.uniform(0.0, 1.0)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        between = (now.speeds / (self.POINTS * self.hover) + self.first) % 1.0
        arc = 4.0 * between * (1.0 - between)
        return 1.0 + self.share * (1.0 + self.DEPTH * (arc - 2.0 / 3.0))
