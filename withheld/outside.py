# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Effects that are outside the list: what the diagnosis must call unknown."""

import numpy as np

from withheld.influence import Influence


class Force(Influence):
    """A force that depends on time and place."""

    def force(self, time, position, velocity):
        """Return the force (3,) N in the world."""
        raise NotImplementedError

    def wrench(self, now):
        """Return the force in the body, without a moment."""
        force = self.force(now.time, now.position, now.velocity)
        return now.rotation.T @ force, np.zeros(3)


class Periodic(Force):
    """A force that swings."""

    def __init__(self, size, weight, rng):
        """Draw direction and frequency."""
        direction = rng.normal(size=3)
        self.amplitude = 0.02 * size * weight * direction / np.linalg.norm(direction)
        self.rate, self.phase = 2.0 * np.pi * rng.uniform(0.3, 1.5), rng.uniform(0.0, 6.28)

    def force(self, time, position, velocity):
        """Return the force."""
        return self.amplitude * np.sin(self.rate * time + self.phase)


class Tether(Force):
    """A spring towards a point."""

    def __init__(self, size, weight, rng):
        """Draw the point."""
        self.point = rng.uniform([-1.0, -1.0, 0.0], [1.0, 1.0, 0.3])
        self.stiffness = 0.02 * size * weight

    def force(self, time, position, velocity):
        """Return the force."""
        return self.stiffness * (self.point - position)


class Updraft(Force):
    """A force upwards about a place."""

    def __init__(self, size, weight, rng):
        """Draw the place."""
        self.place, self.width = rng.uniform(-0.5, 0.5, 2), rng.uniform(0.3, 0.6)
        self.size = 0.03 * size * weight

    def force(self, time, position, velocity):
        """Return the force."""
        away = np.sum((position[:2] - self.place) ** 2)
        return np.array([0.0, 0.0, self.size * np.exp(-0.5 * away / self.width ** 2)])


class Exponent(Influence):
    """Thrust that does not go with the square of the speed."""

    def __init__(self, size, hover, rng):
        """Draw whether the exponent is greater or less."""
        self.hover, self.change = hover, 0.1 * size * rng.choice([-1.0, 1.0])

    def gain(self, now):
        """Return the factors."""
        return np.clip(now.speeds / self.hover, 0.1, 4.0) ** self.change


class Backlash(Influence):
    """Commands with memory: the rotors follow only where the command leaves a band."""

    def __init__(self, size, hover, rng):
        """Set the width of the band."""
        self.width, self.held = 0.005 * size * hover, None

    def given(self, command):
        """Return what is followed."""
        held = command if self.held is None else self.held
        self.held = np.clip(held, command - self.width, command + self.width)
        return self.held


class Slosh(Force):
    """A load that swings in the body."""

    def __init__(self, size, mass, rng):
        """Draw how it swings."""
        self.mass = 0.02 * size * mass
        self.rate, self.damping = 2.0 * np.pi * rng.uniform(0.6, 1.4), rng.uniform(0.02, 0.1)
        self.place, self.speed, self.rotation = np.zeros(2), np.zeros(2), np.eye(3)

    def after(self, step, rotation, acceleration):
        """Swing on."""
        pull = (-self.rate ** 2 * self.place - 2.0 * self.damping * self.rate * self.speed
                - (rotation.T @ acceleration)[:2])
        self.speed = self.speed + step * pull
        self.place = self.place + step * self.speed
        self.rotation = rotation

    def force(self, time, position, velocity):
        """Return the force of the spring and damper of the load."""
        inside = self.mass * (self.rate ** 2 * self.place
                              + 2.0 * self.damping * self.rate * self.speed)
        return self.rotation @ np.array([*inside, 0.0])


class Ceiling(Influence):
    """Suction towards a plate overhead."""

    def __init__(self, size, radius, rng):
        """Draw how high it is."""
        self.size, self.radius, self.height = 0.3 * size, radius, rng.uniform(1.5, 2.5)

    def gain(self, now):
        """Return the factors."""
        gap = np.maximum(self.height - now.heights, 0.0) / self.radius
        return 1.0 + self.size / (1.0 + gap) ** 2


class Neighbours(Influence):
    """Rotors that breathe the wake of those beside them when these turn faster."""

    def __init__(self, size, hover, rng):
        """Draw how far they lean on each other."""
        self.hover, self.share = hover, 0.1 * size * rng.choice([-1.0, 1.0])

    def gain(self, now):
        """Return the factors."""
        turn = now.speeds / self.hover
        return np.clip(1.0 + self.share * (np.roll(turn, 1) - turn) * np.abs(turn), 0.3, 2.0)


KINDS = {'periodic_force': (Periodic, 'weight'), 'tether': (Tether, 'weight'),
         'updraft': (Updraft, 'weight'), 'thrust_exponent': (Exponent, 'hover'),
         'backlash': (Backlash, 'hover'), 'slosh': (Slosh, 'mass'),
         'ceiling': (Ceiling, 'radius'), 'neighbours': (Neighbours, 'hover')}
