# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A load that hangs into water, and one on ropes of wire."""

import numpy as np

from withheld.constants import GRAVITY
from withheld.influence import Influence


class Immersed(Influence):
    """
    A long sonde on a line, which hangs into water where the flight is low: that carries some.

    What is below has to move water along and to part it. C. Koparan, A. B. Koc, C. V. Privette, C.
    B. Sawyer, In situ water quality measurements using an unmanned aerial vehicle (UAV) system,
    Water 10(3), 2018. The line is always taut.
    """

    beside = ('unknown',)               # what height changes of it is no mass
    OWN, FLOATS = 1.35, 0.8             # of the mean: all of it, in air; less, where all is below
    HALF, LONG = 0.9, 0.8               # m, of the vehicle, where half is below; m
    ALONG, PARTS = 0.3, 0.5             # of the mean: water; 1/m, of the square of the velocity

    def __init__(self, size, params, rng):
        """Set the mean."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def alter(self, true, params):
        """Add what it has in air."""
        true['mass'] += self.OWN * self.parameters['mass']

    def begin(self, rng):
        """Start at rest."""
        self._rises = 0.0

    def wrench(self, now):
        """Return what the water carries, and what it takes to move in it."""
        below = float(np.clip(0.5 + (self.HALF - now.position[2]) / self.LONG, 0.0, 1.0))
        up = float(now.velocity[2])
        force = self.parameters['mass'] * below * (
            self.FLOATS * GRAVITY - self.ALONG * self._rises - self.PARTS * abs(up) * up)
        return now.rotation.T @ [0.0, 0.0, force], np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Take the acceleration."""
        self._rises = float(acceleration[2])


class Isolated(Influence):
    """
    A camera under loops of wire rope, whose strands stick at first and then slide on each other.

    So it is stiff for small moves and soft for large ones, and rubs. M. L. Tinker, M. A. Cutchins,
    Damping phenomena in a wire rope vibration isolation system, Journal of Sound and Vibration
    157(1), 1992; by the law of Bouc and Wen, along the body's vertical.
    """

    comparable = True
    beside = ('unknown',)               # what swings of it is no mass
    FREQUENCY = 2.0 * np.pi * 3.0       # rad/s, as long as they stick
    SOFT, SLIDES = 0.25, 0.8            # of the stiffness, as they slide; m/s^2, where they do
    DAMPING, FINE = 0.03, 0.0025        # of the critical one; s, the steps

    def __init__(self, size, params, rng):
        """Set the mass."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.play = self.SLIDES / ((1.0 - self.SOFT) * self.FREQUENCY ** 2)     # m

    def alter(self, true, params):
        """Add the mass as if it were fixed."""
        true['mass'] += self.parameters['mass']

    def begin(self, rng):
        """Hang at rest, from where all is measured."""
        self._place, self._speed, self._stuck, self._pull = 0.0, 0.0, 0.0, 0.0

    def wrench(self, now):
        """Return what the ropes pull by other than a fixed mass would."""
        off = self.parameters['mass'] * (self._pull - self._held())
        return np.array([0.0, 0.0, off]), np.zeros(3)

    def after(self, step, rotation, acceleration):
        """Let it swing, and the strands slide."""
        self._pull = float(rotation[:, 2] @ (acceleration + [0.0, 0.0, GRAVITY])) - GRAVITY
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._speed += step / count * (self._held() - self._pull)
            self._place += step / count * self._speed
            slides = abs(self._speed) * self._stuck / self.play
            self._stuck += step / count * (self._speed - slides)

    def _held(self):
        """Return what holds it beside its weight, m/s^2, upwards."""
        rope = self.SOFT * self._place + (1.0 - self.SOFT) * self._stuck
        return -self.FREQUENCY * (self.FREQUENCY * rope + 2.0 * self.DAMPING * self._speed)
