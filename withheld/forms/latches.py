# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A rotor on an arm that is not latched, and a motor with a magnet that came loose."""

import numpy as np

from withheld.constants import induced_velocity
from withheld.forms.body import Fault


class Unlatched(Fault):
    """
    A folding arm whose latch gave way: it droops towards its neighbour, into whose wake it gets.

    What its rotor lacks there goes with its own speed times that of the wake, so that it gets
    worse as the neighbour turns faster; flow from one side carries the wake onto it, and from the
    other one away. Disks that overlap: A. Griffiths, J. G. Leishman, A study of dual-rotor
    interference and ground effect using a free-vortex wake model, American Helicopter Society
    58th Annual Forum, 2002. The torque stays.
    """

    SHIFTS, MOST = 1.0, 2.0     # of the mean loss: by as fast a flow as the wake; at most

    def __init__(self, size, params, rng):
        """Find the neighbour, and the velocity of its wake in hover, m/s."""
        super().__init__(size, params, rng)
        away = np.array(list(params['rotor_pos'].values()))[:, :2]
        away = away[self.rotor] - away
        far = np.linalg.norm(away, axis=1)
        far[self.rotor] = np.inf
        self.other = int(np.argmin(far))
        self.towards = away[self.other] / far[self.other]
        self.induced = induced_velocity(params)

    def gain(self, now):
        """Return the factors."""
        other = float(np.clip(now.speeds[self.other] / self.hover, 0.2, 3.0))
        flow = float(now.hubs()[self.other, :2] @ self.towards) / (other * self.induced)
        # The wake stays behind where the vehicle flies.
        share = min(max(1.0 - self.SHIFTS * flow, 0.0), self.MOST)
        return self.losing(now, lambda turn: share * other / turn)


class Unglued(Fault):
    """
    A motor in whose bell the glue of a magnet has failed, so that it rubs on the stator.

    The stator pulls it in, and the spin throws it out: the slower the bell turns, the more it
    rubs. At a high speed it lifts, and comes down only at a lower one, since the stator pulls less
    from afar. Coulomb's friction; as motors after crashes have it in practice.
    """

    LIFTS, FALLS, MOST = 1.15, 0.98, 3.0    # of the speed in hover; of the mean loss

    def begin(self, rng):
        """Start with a magnet that rubs."""
        self._rubs, self._turn = True, 1.0

    def gain(self, now):
        """Return the factors."""
        self._turn = float(now.speeds[self.rotor]) / self.hover
        if not self._rubs:
            return np.ones(len(now.speeds))
        return self.losing(now, lambda turn: min(self.friction(turn) / turn ** 2, self.MOST))

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let the magnet lift or fall."""
        self._rubs = self._turn < (self.LIFTS if self._rubs else self.FALLS)

    def friction(self, turn):
        """Return the torque of the friction, of that at the speed of hover."""
        return max(self.LIFTS ** 2 - turn ** 2, 0.0) / (self.LIFTS ** 2 - 1.0)
