# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is aboard: a balloon, a winch, a tank with baffles, and a payload that draws power."""

import numpy as np

from withheld.actuators import Battery
from withheld.constants import GRAVITY
from withheld.forms.body import Coupled
from withheld.influence import Influence


class Buoyant(Influence):
    """
    A balloon that carries some of the weight, and has to be moved along with the air around it.

    Its lift less the weight of skin and gas is what it seems to take of the mass. Added mass of a
    sphere: H. Lamb, Hydrodynamics, 1932; G. A. Khoury, Airship Technology, 2012.
    """

    beside = ('unknown',)       # what it adds where the body is accelerated is no weight
    MOVED = 0.8         # of what it carries

    def __init__(self, size, params, rng):
        """Set what it carries."""
        self.parameters = {'mass': -0.007 * size * params['mass']}

    def begin(self, rng):
        """Start at rest."""
        self._pull = np.zeros(3)

    def wrench(self, now):
        """Return its lift less what moves it."""
        carried = -self.parameters['mass']
        force = carried * (np.array([0.0, 0.0, GRAVITY]) - self.MOVED * self._pull)
        return now.rotation.T @ force, np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Take the acceleration."""
        self._pull = np.asarray(acceleration)


class Winched(Influence):
    """
    A load on a winch, which lets it down and pulls it up again: starts and stops change its pull.

    As vehicles deliver in practice; the way is that of the least jerk, and the load hangs still.
    """

    beside = ('unknown',)       # its starts and stops are no weight
    LASTS, RESTS, REEL = 1.5, 1.0, 0.9          # s; s; m

    def __init__(self, size, params, rng):
        """Set the mass."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add the mass."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Draw the phase, s."""
        self.phase = rng.uniform(0.0, 2.0 * (self.LASTS + self.RESTS))

    def wrench(self, now):
        """Return what the winch pulls by other than the weight."""
        number, rest = divmod(now.time + self.phase, self.LASTS + self.RESTS)
        u = min(rest / self.LASTS, 1.0)
        slope = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) * self.REEL / self.LASTS ** 2
        rises = slope if int(number) % 2 else -slope
        return now.rotation.T @ [0.0, 0.0, -self.parameters['mass'] * rises], np.zeros(3)


class Baffled(Coupled):
    """
    Liquid in a tank with baffles, which hold it the more, the faster it goes past them.

    With the square of the slip: slow turns leave it behind, fast ones take it along. F. T. Dodge,
    The New Dynamic Behavior of Liquids in Moving Containers, Southwest Research Institute, 2000.
    """

    HOLDS = 15.0        # 1/rad, of its inertia

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the baffles."""
        self._rate = now.rate
        slip = now.rate - self._turning
        return np.zeros(3), -self.HOLDS * self.loads * np.abs(slip) * slip

    def after(self, step, rotation, acceleration):
        """Let it be taken along, by the solution for a rate that is held."""
        slip = self._rate - self._turning
        self._turning = self._rate - slip / (1.0 + self.HOLDS * step * np.abs(slip))


class Consumer(Battery):
    """
    A pack that also supplies a payload, such as lamps or a pump, which is switched on and off.

    So the voltage falls and rises in steps that have nothing to do with the rotors. Ohm's law.
    """

    recorded = False
    STAYS = 3.0         # s on average, on and off
    DRAWS, ROTORS, SLOPE = 0.02, 0.003, 0.004   # of the voltage: it, the rotors, and in 30 s
    TIME = 0.1          # s, in which it is on

    def __init__(self, size, params, rng):
        """Set what it draws."""
        super().__init__(0.0, 1.8)
        self.size, self._on = size, 0.0
        self.parameters = {'share': self.DRAWS * size}

    def begin(self, rng):
        """Draw when it is switched."""
        self.times = np.cumsum(rng.exponential(self.STAYS, 100))

    def drain(self, time, step, speeds):
        """Go on."""
        goal = float(np.searchsorted(self.times, time) % 2)
        self._on += (1.0 - np.exp(-step / self.TIME)) * (goal - self._on)
        self.ratio = 1.0 - self.size * (
            self.DRAWS * self._on + self.ROTORS * (float(np.mean(speeds ** 3)) - 1.0)
            + self.SLOPE * time / 30.0)
