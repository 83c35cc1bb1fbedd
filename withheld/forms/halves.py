# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Packs of which each is for the rotors of one end."""

import numpy as np

from withheld.actuators import Battery


class PackPerEnd(Battery):
    """
    Two packs that are not connected, one for the rotors of either end, of which one is older.

    The old one resists more and is sooner empty, and each has the load of its own rotors, so that
    its end sinks: a moment that grows. As heavy vehicles have it, so that no fault takes all
    power; the older, the more it resists: J. Vetter and others, Ageing mechanisms in lithium-ion
    batteries, Journal of Power Sources 147, 2005. Which is where does not change between flights.
    """

    recorded = False
    beside = ('com_offset',)
    RESISTS, FALLS = 0.008, 0.008           # of the voltage, by the load of hover; in 30 s of it
    OLDER = np.array([1.3, 1.2])            # times both, of the old pack
    NEWER = np.array([0.8, 0.9])            # times both, of the other one

    def __init__(self, size, params, rng):
        """Draw which end has the old pack."""
        super().__init__(0.0, 1.8)
        places = np.array(list(params['rotor_pos'].values()))[:, :2]
        # Along the axis in whose middle there are no rotors.
        axis = int(np.argmax(np.min(np.abs(places), axis=0).round(6)))
        self.ends = np.array([places[:, axis] > 0.0, places[:, axis] <= 0.0])
        old_first = bool(rng.integers(2))
        packs = (self.OLDER, self.NEWER) if old_first else (self.NEWER, self.OLDER)
        self.resists, self.falls = size * np.transpose(packs) * [[self.RESISTS], [self.FALLS]]
        self.parameters = {'resistance': float(np.mean(self.resists))}

    def begin(self, rng):
        """Start with full packs."""
        self._taken, self.ratios = np.zeros(2), np.ones(2)

    def drain(self, time, step, speeds):
        """Go on."""
        load = np.array([np.mean(speeds[end] ** 3) for end in self.ends])
        self._taken = self._taken + load * step / 30.0
        self.ratios = 1.0 - self.resists * load - self.falls * self._taken
        self.ratio = float(np.mean(self.ratios))

    def gain(self, speeds):
        """Return the factors on the thrust of rotors at speeds (n,) of those in hover."""
        return np.maximum(self.ratios, 0.0) ** self.exponent @ self.ends
