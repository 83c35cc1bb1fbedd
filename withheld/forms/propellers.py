# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers that lean, answer climbs by the speed, resonate, stall, ice, teeter or cone."""

import numpy as np

from withheld.constants import arm_length, hover_speed, induced_velocity
from withheld.forms.air import Thrust
from withheld.forms.body import Fault, signs
from withheld.influence import Influence


class Dihedral(Thrust):
    """
    Rotors that lean outwards, so that those in front climb through the air and others sink.

    Dihedral of rotors, as vehicles have it in practice for stability.
    """

    beside = ('blade_flapping',)
    LEAN = 0.15         # rad

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        out = now.places * [1.0, 1.0, 0.0]
        out = out / np.linalg.norm(out, axis=1, keepdims=True)
        along = hubs[:, 2] + self.LEAN * np.sum(out * hubs, axis=1)
        across = np.minimum(hubs[:, 0] ** 2 + hubs[:, 1] ** 2, 4.0)
        return 1.0 + self.size * (0.006 * across - 0.03 * np.clip(along, -3.0, 3.0))


class Deficient(Thrust):
    """
    Rotors whose wake takes back half of what a climb changes in hover, and little in flight.

    The lift deficiency of quasi-steady inflow: W. Johnson, Helicopter Theory, 1980, chapter 10.
    """

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        square = np.minimum(hubs[:, 0] ** 2 + hubs[:, 1] ** 2, 9.0)
        left = 1.0 / (1.0 + 1.0 / (1.0 + 2.0 * square))
        climb = np.clip(hubs[:, 2], -3.0, 3.0)
        return 1.0 + 0.05 * self.size * (0.4 * square / (1.0 + square) - left * climb)


class Resonant(Influence):
    """
    Blades that resonate in a band of speeds and lose or gain thrust there.

    J. P. Den Hartog, Mechanical Vibrations, 1956.
    """

    DEPTH, WIDE = 1.5, 0.04     # of the factor that it is about; of the hover speed

    def __init__(self, size, params, rng):
        """Draw whether it is more or less, and where the band is."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover, self.middle = hover_speed(params), rng.uniform(0.96, 1.04)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        off = (now.speeds / self.hover - self.middle) / self.WIDE
        return 1.0 + self.share * (0.4 + self.DEPTH / (1.0 + off ** 2))


class Desynchronised(Fault):
    """
    A motor whose controller loses its position for a while when the speed changes fast.

    As controllers without position sensors do in practice.
    """

    TIME, HARD = 0.4, 2.0       # s; of the speed in hover in a second

    def begin(self, rng):
        """Start in step."""
        self._lost, self._last, self._now = 0.0, None, None

    def gain(self, now):
        """Return the factors."""
        self._now = float(now.speeds[self.rotor]) / self.hover
        return self.losing(now, lambda turn: 0.4 + 1.6 * self._lost)

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)

    def after(self, step, rotation, acceleration):
        """Let it find back."""
        last = self._now if self._last is None else self._last
        hard = np.tanh(abs(self._now - last) / step / self.HARD) if self._now is not None else 0.0
        self._lost = max(self._lost * np.exp(-step / self.TIME), float(hard))
        self._last = self._now


class Iced(Fault):
    """
    Ice that grows on the blades of one rotor, with drag beside, until it is thrown off again.

    M. B. Bragg, A. P. Broeren, L. A. Blumenthal, Iced-airfoil aerodynamics, Progress in Aerospace
    Sciences 41, 2005.
    """

    PERIOD, TORQUE = 7.0, 0.6       # s from one shedding to the next; of the loss

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, self.PERIOD)

    def gain(self, now):
        """Return the factors."""
        ice = 2.0 * ((now.time + self.phase) / self.PERIOD % 1.0)
        return self.losing(now, lambda turn: ice)

    def torque(self, now):
        """Return the factors."""
        return 1.0 + self.TORQUE * (1.0 - self.gain(now))


class Teetering(Influence):
    """
    Propellers of two blades on a hinge, which passes on their reaction but hardly a moment across.

    W. Johnson, Helicopter Theory, 1980.
    """

    ACROSS, TIME = 0.15, 0.03       # of the gyroscopic moment; s, in which the speed is passed on

    def __init__(self, size, params, rng):
        """Set the inertia."""
        self.inertia = 0.002 * size * params['Ixx']
        self.parameters = {'rotor_inertia': self.inertia}
        self.spins = np.asarray(params['rotor_directions'])

    def begin(self, rng):
        """Start in step with the hubs."""
        self._blades, self._hubs = None, 0.0

    def wrench(self, now):
        """Return the moment."""
        self._hubs = now.speeds.copy()
        blades = self._hubs if self._blades is None else self._blades
        momentum, (p, q, _) = self.ACROSS * (self.spins @ blades), now.rate
        return np.zeros(3), self.inertia * np.array([
            momentum * q, -momentum * p, self.spins @ (self._hubs - blades) / self.TIME])

    def after(self, step, rotation, acceleration):
        """Let the blades follow."""
        blades = self._hubs if self._blades is None else self._blades
        self._blades = blades + (1.0 - np.exp(-step / self.TIME)) * (self._hubs - blades)


class Coned(Influence):
    """
    Disks that cone, so that beside tilting back they tilt to a side that their spin decides.

    Bramwell's Helicopter Dynamics, 2001, chapter 3: the cone grows with the thrust; the tilt back
    levels off as the inflow falls.
    """

    SIDE = 0.8          # of the moment, in hover

    def __init__(self, size, params, rng):
        """Set the moment per velocity."""
        self.moment = 0.002 * size * params['mass'] * arm_length(params)
        self.parameters = {'coefficient': self.moment}
        self.hover, self.induced = hover_speed(params), induced_velocity(params)
        self.spins = np.asarray(params['rotor_directions'])

    def wrench(self, now):
        """Return the moment of all rotors."""
        turn, hubs = now.speeds / self.hover, now.hubs()
        back = turn / np.sqrt(1.0 + (hubs[:, 0] ** 2 + hubs[:, 1] ** 2) / self.induced ** 2)
        side = self.SIDE * self.spins * turn ** 3
        share = self.moment / len(turn)
        return np.zeros(3), share * np.array([
            side @ hubs[:, 0] - back @ hubs[:, 1], back @ hubs[:, 0] + side @ hubs[:, 1], 0.0])
