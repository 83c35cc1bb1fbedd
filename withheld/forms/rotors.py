# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors that slip, overheat, fold, or flap with the turning of the body."""

import numpy as np

from withheld.constants import arm_length, hover_speed
from withheld.forms.body import Fault
from withheld.influence import Influence


class SlippingHub(Fault):
    """
    A propeller that friction holds on its shaft: it slips where it takes more torque than that.

    The bound of a clamped hub: Shigley's Mechanical Engineering Design, 2011, chapter 16. Below
    it nothing is lost; beyond it thrust and torque level off.
    """

    HOLDS = 0.92        # of the speed in hover, where it begins to slip
    WIDE = 0.06

    def gain(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: 4.0 * self.WIDE * np.logaddexp(
            0.0, (turn - self.HOLDS) / self.WIDE) / turn)

    def torque(self, now):
        """Return the factors."""
        return self.gain(now)


class Overheating(Fault):
    """
    A motor that loses torque as its winding heats, with what it had to do in the last seconds.

    Copper loss goes with the square of the torque, its heat with a time constant (J. R.
    Hendershot, T. J. E. Miller, Design of Brushless Permanent-Magnet Machines, 2010, chapter 15).
    """

    TIME = 6.0          # s

    def begin(self, rng):
        """Start cold."""
        self._heat, self._load = 0.0, 1.0

    def gain(self, now):
        """Return the factors."""
        self._load = float(np.clip(now.speeds[self.rotor] / self.hover, 0.2, 2.0)) ** 4
        return self.losing(now, lambda turn: 0.2 + self._heat)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it heat."""
        self._heat += (1.0 - np.exp(-step / self.TIME)) * (self._load - self._heat)


class Folding(Influence):
    """
    Folding propellers: blades on hinges lag behind the hub, and swing out as they turn faster.

    So the body feels a change of speed later, and the momentum grows faster than the speed (lag
    hinges: W. Johnson, Helicopter Theory, 1980, chapter 9).
    """

    TIME = 0.04         # s
    SPREAD = 0.4        # of the inertia in hover: what goes with the square of the speed

    def __init__(self, size, params, rng):
        """Set the inertia at the speed of hover."""
        self.inertia = 0.002 * size * params['Ixx']
        self.parameters = {'rotor_inertia': self.inertia}
        self.hover, self.spins = hover_speed(params), np.asarray(params['rotor_directions'])
        self._blades = None

    def wrench(self, now):
        """Return the moment of their momentum, and of what the hinges pass on."""
        self._hubs = now.speeds.copy()
        blades = self._hubs if self._blades is None else self._blades
        turn, (p, q, _) = blades / self.hover, now.rate
        momentum = self.spins @ ((1.0 - self.SPREAD + self.SPREAD * turn ** 2) * blades)
        slope = self.spins @ ((1.0 - self.SPREAD + 3.0 * self.SPREAD * turn ** 2)
                              * (self._hubs - blades) / self.TIME)
        return np.zeros(3), self.inertia * np.array([momentum * q, -momentum * p, slope])

    def after(self, step, rotation, acceleration):
        """Let the blades follow."""
        blades = self._hubs if self._blades is None else self._blades
        self._blades = blades + (1.0 - np.exp(-step / self.TIME)) * (self._hubs - blades)


class RateFlapping(Influence):
    """
    Disks that tilt with the velocity a little later, and lag behind where the body turns.

    Flapping with terms of pitch and roll rate: P. Pounds, R. Mahony, P. Corke, Modelling and
    control of a large quadrotor robot, Control Engineering Practice 18(7), 2010.
    """

    TIME, LEVER = 0.06, 0.7         # s; m/s of velocity that a rad/s is worth

    def __init__(self, size, params, rng):
        """Set the moment per velocity."""
        self.moment = 0.002 * size * params['mass'] * arm_length(params)
        self.parameters = {'coefficient': self.moment}
        self.hover = hover_speed(params)

    def begin(self, rng):
        """Start upright."""
        self._tilt, self._now = np.zeros(2), np.zeros(2)

    def wrench(self, now):
        """Return the moment."""
        turn = float(np.mean(now.speeds)) / self.hover
        self._now = turn * np.array([-now.air[1], now.air[0]])
        p, q, _ = now.rate
        return np.zeros(3), self.moment * np.array([
            self._tilt[0] - self.LEVER * p, self._tilt[1] - self.LEVER * q, 0.0])

    def after(self, step, rotation, acceleration):
        """Let the disks follow."""
        self._tilt = self._tilt + (1.0 - np.exp(-step / self.TIME)) * (self._now - self._tilt)
