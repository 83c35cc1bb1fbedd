# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors by their inflow and blades: inflow that lags, is left behind, tilts, and two branches."""

import numpy as np

from withheld.constants import arm_length, hover_speed, induced_velocity
from withheld.forms.air import Thrust
from withheld.forms.blades import swept
from withheld.forms.body import signs
from withheld.influence import Influence


class Overshooting(Thrust):
    """
    Rotors whose inflow takes its time to follow their own speed: the thrust overshoots.

    P. J. Carpenter, B. Fridovich, Effect of a rapid blade-pitch increase on the thrust and
    induced-velocity response of a full-scale helicopter rotor, NACA TN 3044, 1953.
    """

    RADII = 6.0         # of the wake's way until it has followed

    def __init__(self, size, params, rng):
        """Set the time that it takes, s, in hover."""
        super().__init__(size, params, rng)
        self.time = self.RADII * self.radius / self.induced

    def begin(self, rng):
        """Start with an inflow that has followed."""
        self._slow, self._goal = None, 1.0

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / self.induced
        self._goal = turn * swept(np.hypot(hubs[:, 0], hubs[:, 1]) / turn)
        slow = self._goal if self._slow is None else self._slow
        return 1.0 - 0.06 * self.size * np.clip((hubs[:, 2] + slow) / turn - 1.0, -3.0, 3.0)

    def after(self, step, rotation, acceleration):
        """Let the inflow follow."""
        slow = self._goal if self._slow is None else self._slow
        self._slow = slow + (1.0 - np.exp(-step / self.time)) * (self._goal - slow)


class Outrun(Thrust):
    """
    Rotors that lose a little in slow level flight, until they outrun their vortices and gain.

    Translational lift that sets in at a speed: Rotorcraft Flying Handbook, FAA-H-8083-21, 2000,
    chapter 3. Climbing costs thrust evenly.
    """

    ONSET, WIDE, SLOW = 0.35, 0.1, 0.15         # of the induced velocity

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        x, y, z = (now.hubs() / (self.induced * turn[:, None])).T
        across = np.hypot(x, y)
        rises = np.tanh((across - self.ONSET) / self.WIDE) + np.tanh(self.ONSET / self.WIDE)
        loses = across / self.SLOW * np.exp(-0.5 * (across / self.SLOW) ** 2)
        return 1.0 + self.size * (
            0.015 * rises - 0.012 * loses - 0.03 * np.clip(z, -3.0, 3.0))


class TwoBranches(Influence):
    """
    Blades on which the flow stays as it is, parted or not, until the speed has changed enough.

    Hysteresis of lift at low Reynolds numbers: T. J. Mueller, The influence of laminar separation
    and transition on low Reynolds number airfoil hysteresis, Journal of Aircraft 22(9), 1985.
    """

    STEP, LOOP = 1.2, 0.025     # of the factor that it is about, either way; of the hover speed
    TIME = 0.05                 # s, from one branch to the other

    def __init__(self, size, params, rng):
        """Draw whether it is more or less on the whole, and where the loop is."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover, self.middle = hover_speed(params), rng.uniform(0.99, 1.01)
        self.parameters = {'share': self.share}

    def begin(self, rng):
        """Start with a flow that clings."""
        self._clings, self._off = 1.0, 0.0

    def gain(self, now):
        """Return the factors."""
        self._off = now.speeds / self.hover - self.middle
        return 1.0 + self.share * (1.0 + self.STEP * (2.0 * self._clings - 1.0))

    def after(self, step, rotation, acceleration):
        """Let it cling or part."""
        held = np.where(np.asarray(self._clings) > 0.5, 1.0, 0.0)
        goal = np.where(self._off > self.LOOP, 1.0, np.where(self._off < -self.LOOP, 0.0, held))
        self._clings = self._clings + (1.0 - np.exp(-step / self.TIME)) * (goal - self._clings)


class SkewedInflow(Influence):
    """
    Stiff propellers whose inflow is less in front than behind, and lifts them at their front.

    By Coleman's gradient, with the angle of the wake (R. P. Coleman, A. M. Feingold, C. W.
    Stempin, Evaluation of the induced-velocity field of an idealized helicopter rotor, NACA WR
    L-126, 1945): the moment grows with the speed, and a climb, which straightens the wake, takes
    it away.
    """

    def __init__(self, size, params, rng):
        """Set the moment per velocity of slow flight, and the induced velocity in hover, m/s."""
        self.moment = 0.002 * size * params['mass'] * arm_length(params)
        self.parameters = {'coefficient': self.moment}
        self.hover, self.induced = hover_speed(params), induced_velocity(params)

    def wrench(self, now):
        """Return the moment of all rotors."""
        turn, hubs = np.maximum(now.speeds / self.hover, 0.2), now.hubs()
        x, y, z = (hubs / (self.induced * turn[:, None])).T
        across = np.hypot(x, y)
        inflow = swept(across)
        through = np.maximum(z + inflow, 0.3)
        # Of the inflow: its gradient, tan(angle / 2), over half the velocity.
        gradient = 2.0 / (through * (1.0 + np.sqrt(1.0 + (across / through) ** 2)))
        share = self.moment / len(turn) * turn * inflow * gradient
        return np.zeros(3), np.array([-share @ hubs[:, 1], share @ hubs[:, 0], 0.0])
