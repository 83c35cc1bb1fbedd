# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotors that burn fuel, each with an engine of its own."""

import numpy as np

from withheld.actuators import Motor
from withheld.constants import hover_speed
from withheld.forms.motors import TIME


class Carburetted(Motor):
    """
    Rotors with engines, of whose fuel a part wets the pipe first and comes as it evaporates.

    So a change begins fast and ends slowly, and downwards nothing but the propeller brakes. C. F.
    Aquino, Transient A/F control characteristics of the 5 liter central fuel injection engine,
    SAE 810494, 1981; E. Hendricks, S. C. Sorenson, Mean value modelling of spark ignition
    engines, SAE 900616, 1990. As heavy sprayers have it in practice. The torque is that of the
    fuel that burns, against the square of the speed.
    """

    WETS = 0.5          # of the fuel
    SPEED = 0.3         # of the mean time: the rotor, by a small change; the rest is the fuel

    def __init__(self, size, params, rng):
        """Set the mean time of a small change in hover."""
        self.parameters = {'time': TIME * size}
        self.hover, self._film = hover_speed(params), None

    def turn(self, speeds, command, step):
        """Return the speeds, by the solution for the mean torque of the step."""
        time = self.parameters['time']
        if not time:
            return command
        turn, asked = speeds / self.hover, (command / self.hover) ** 2
        before = turn ** 2 if self._film is None else self._film
        dries = (1.0 - self.SPEED) / self.WETS * time
        self._film = asked + (before - asked) * np.exp(-step / dries)
        # What dries, on average over the step.
        film = asked - (self._film - before) * dries / step
        goal = np.sqrt(np.maximum((1.0 - self.WETS) * asked + self.WETS * film, 1e-12))
        grows = np.tanh(goal * step / (2.0 * self.SPEED * time))
        return self.hover * goal * (turn + goal * grows) / (goal + turn * grows)
