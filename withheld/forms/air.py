# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag, wind, inflow, flapping and ground effect by laws that are not the library's."""

import numpy as np

from withheld.constants import arm_length, hover_speed, induced_velocity
from withheld.influence import Influence


class Drag(Influence):
    """A force on the body that depends on its velocity through the air."""

    def __init__(self, size, params, rng):
        """Set the coefficient, kg/s."""
        self.coefficient = 0.08 * size * params['mass']
        self.parameters = {'coefficient': self.coefficient}
        self.hover = hover_speed(params)

    def wrench(self, now):
        """Return the drag, without a moment."""
        return -self.coefficient * self.law(now), np.zeros(3)


class Saturating(Drag):
    """Linear drag that grows less beyond 2.5 m/s, the same at all rotor speeds."""

    def law(self, now):
        """Return what the coefficient is of."""
        return now.air / np.sqrt(1.0 + now.air @ now.air / 2.5 ** 2)


class Offset(Drag):
    """Linear drag that acts on a point off the centre, so that it turns the vehicle, too."""

    def __init__(self, size, params, rng):
        """Draw the point."""
        super().__init__(size, params, rng)
        self.point = 0.2 * arm_length(params) * (
            rng.choice([-1.0, 1.0], 3) * rng.uniform(0.5, 1.0, 3))

    def wrench(self, now):
        """Return force and moment."""
        force = -self.coefficient * now.air
        return force, np.cross(self.point, force)

    beside = ('blade_flapping',)


class Steeper(Drag):
    """Drag with the power 1.25 of the velocity."""

    beside = ('body_drag',)

    def law(self, now):
        """Return what the coefficient is of."""
        return (now.air @ now.air) ** 0.125 * now.air


class Skewed(Drag):
    """Linear drag with axes that are not the body's, and with the root of the rotor speed."""

    def __init__(self, size, params, rng):
        """Draw the axes."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.3, 0.8)
        c, s = np.cos(angle), np.sin(angle)
        axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        self.matrix = axes @ np.diag([1.35, 0.65, 0.3]) @ axes.T

    def law(self, now):
        """Return what the coefficient is of."""
        return np.sqrt(np.mean(now.speeds) / self.hover) * (self.matrix @ now.air)


class Power16(Drag):
    """Drag with the power 1.6 of the velocity: between a body's and rotors'."""

    beside = ('rotor_drag',)

    def law(self, now):
        """Return what the coefficient is of."""
        return (now.air @ now.air) ** 0.3 * now.air


class Plates(Drag):
    """A plate across each axis, each with the square of its own component."""

    def law(self, now):
        """Return what the coefficient is of."""
        return np.array([1.2, 0.8, 1.5]) * np.abs(now.air) * now.air


class Crisis(Drag):
    """A drag coefficient that falls as the flow clings longer."""

    beside = ('rotor_drag',)

    def law(self, now):
        """Return what the coefficient is of."""
        speed = np.linalg.norm(now.air)
        return speed / (1.0 + speed / 4.0) * now.air


class Plate(Drag):
    """A body like a tilted plate: drag, and a force along its normal, which lifts."""

    beside = ('inflow',)

    def __init__(self, size, params, rng):
        """Draw the normal."""
        super().__init__(size, params, rng)
        normal = np.array([*rng.uniform(-0.2, 0.2, 2), 1.0])
        self.normal = normal / np.linalg.norm(normal)

    def law(self, now):
        """Return what the coefficient is of."""
        speed = np.linalg.norm(now.air)
        return 0.6 * speed * now.air + 0.8 * speed * (self.normal @ now.air) * self.normal


class Wind(Influence):
    """Air that moves."""

    def __init__(self, size, params, rng):
        """Draw the direction."""
        along = rng.choice([-1.0, 1.0], 2) * rng.uniform(0.3, 1.0, 2)
        self.mean = 0.7 * size * np.array([*along, 0.0])
        self.parameters = dict(zip('xyz', self.mean.tolist(), strict=True))


class Profile(Wind):
    """A logarithmic profile over the ground, and light turbulence of a second or so."""

    ROUGH, TIME, SHARE = 0.02, 1.0, 0.08        # m, s, share of the mean

    def begin(self, rng):
        """Take the flight's own draws."""
        self._rng, self._gust = rng, np.zeros(3)

    def wind(self, time, position):
        """Return the velocity of the air; that of 2 m height is the mean."""
        height = np.log1p(max(position[2], 0.0) / self.ROUGH) / np.log1p(2.0 / self.ROUGH)
        return height * self.mean + self._gust

    def after(self, step, rotation, acceleration):
        """Let the turbulence go on."""
        keep = np.exp(-step / self.TIME)
        self._gust = keep * self._gust + np.sqrt(1.0 - keep ** 2) * (
            self.SHARE * np.linalg.norm(self.mean) * self._rng.normal(size=3))


class Turning(Wind):
    """A wind that swings about its direction by 20 degrees, once in half a minute."""

    def wind(self, time, position):
        """Return the velocity of the air."""
        angle = 0.35 * np.sin(2.0 * np.pi * time / 30.0)
        c, s = np.cos(angle), np.sin(angle)
        x, y, z = self.mean
        return np.array([c * x - s * y, s * x + c * y, z])


class Sheltered(Wind):
    """A profile with a power of the height, and a speed that swings by a seventh."""

    def wind(self, time, position):
        """Return the velocity of the air."""
        height = (max(position[2], 0.02) / 2.0) ** 0.2
        return height * (1.0 + 0.14 * np.sin(2.0 * np.pi * time / 11.0)) * self.mean


class Shear(Wind):
    """A wind that is stronger on one side."""

    def wind(self, time, position):
        """Return the velocity of the air."""
        return (1.0 + 0.2 * np.clip(position[1], -2.0, 2.0)) * self.mean


class Thrust(Influence):
    """Thrust of each rotor that depends on its flow, as a factor on that at rest."""

    def __init__(self, size, params, rng):
        """Take what velocities are measured by."""
        self.size = size
        self.hover = hover_speed(params)
        self.radius = params['rotor_radius']
        self.parameters = {'size': size}
        self.induced = induced_velocity(params)


class Momentum(Thrust):
    """
    Blade elements with the induced velocity that momentum theory asks for.

    thrust = c1 w^2 - c2 w (vz + vi), 2 rho A vi sqrt(vx^2 + vy^2 + (vz + vi)^2) = thrust; c1 is
    such that at rest the thrust is the nominal one. Share of c2: at size 1 a hundredth.
    """

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.05)
        hubs = now.hubs() / self.induced
        across, along = hubs[:, 0] ** 2 + hubs[:, 1] ** 2, hubs[:, 2]
        c2 = 0.01 * self.size
        flow = turn.copy()      # of the induced velocity in hover, which is that at rest
        for _ in range(8):
            thrust = (1.0 + c2) * turn ** 2 - c2 * turn * (along + flow)
            flow = 0.5 * (flow + np.maximum(thrust, 0.01) / np.sqrt(
                across + (along + flow) ** 2 + 1e-3))
        return ((1.0 + c2) * turn ** 2 - c2 * turn * (along + flow)) / turn ** 2


class Following(Thrust):
    """Thrust that answers the axial velocity as the inflow builds up, in a tenth of a second."""

    TIME = 0.1

    def begin(self, rng):
        """Start at rest."""
        self._slow, self._now = np.zeros(2), np.zeros(2)

    def gain(self, now):
        """Return the factors."""
        self._now = np.array([now.air[2], now.air[0] ** 2 + now.air[1] ** 2])
        turn = np.maximum(now.speeds / self.hover, 0.05)
        return 1.0 + 0.012 * self.size * (
            -self._slow[0] / turn + 0.2 * self._slow[1] / turn ** 2)

    def after(self, step, rotation, acceleration):
        """Let the inflow follow."""
        self._slow = self._slow + (1.0 - np.exp(-step / self.TIME)) * (self._now - self._slow)


class FlatTable(Thrust):
    """
    A thrust coefficient that hardly falls at first and then with the square, as in wind tunnels.

    Curves of small propellers over the advance ratio are flat at rest (Brandt and Selig, AIAA
    2011-1255); across, the gain goes with the speed rather than with its square.
    """

    def gain(self, now):
        """Return the factors."""
        turn = self.radius * np.maximum(now.speeds, 0.05 * self.hover)
        hubs = now.hubs() / (0.1 * turn[:, None])
        axial, across = hubs[:, 2], np.hypot(hubs[:, 0], hubs[:, 1])
        return 1.0 + 0.02 * self.size * np.clip(
            -2.5 * axial * np.abs(axial) + 0.4 * across, -10.0, 10.0)


class Shadowed(Thrust):
    """
    Rotors at the back that fly in the wake of those in front, which costs them thrust.

    Their loss and the moment that comes of it in edgewise flight: Misiorowski, Gandhi, Oberai,
    AIAA Journal 57(10), 2019. Climbing costs all of them thrust.
    """

    beside = ('blade_flapping',)

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.05)
        flow = np.array([*now.air[:2], 0.0]) / self.induced
        speed = np.sqrt(flow @ flow)
        reach = np.max(np.abs(now.places))
        behind = np.maximum(-now.places @ flow / (reach * max(speed, 1e-9)), 0.0)
        climb = now.hubs()[:, 2] / (self.induced * turn)
        return 1.0 - 0.012 * self.size * (climb + 1.5 * behind * speed / (1.0 + speed ** 2))


class TiltedDisk(Influence):
    """Disks that tilt with the velocity: a moment of their hubs, and thrust that leans back."""

    beside = ('rotor_drag',)

    def __init__(self, size, params, rng):
        """Set the moment per velocity, and the lean that goes with it."""
        self.hover, self.count = hover_speed(params), params['num_rotors']
        self.moment = 0.002 * size * params['mass'] * arm_length(params)
        self.lean = self.moment / (0.3 * arm_length(params)) / self.count
        self.parameters = {'coefficient': self.moment}

    def wrench(self, now):
        """Return force and moment of all rotors."""
        hubs, turn = now.hubs(), np.maximum(now.speeds / self.hover, 0.1)
        moment = np.zeros(3)
        share = self.moment / self.count / turn     # stiff hubs: the tilt falls with the speed
        moment[0], moment[1] = -share @ hubs[:, 1], share @ hubs[:, 0]
        force = -self.lean * turn[:, None] * hubs * [1.0, 1.0, 0.0]
        return force.sum(axis=0), moment + np.cross(now.places, force).sum(axis=0)


class CrossFlapping(Influence):
    """A moment with the square of the rotor speed that levels off, a fifth of it across."""

    def __init__(self, size, params, rng):
        """Set the moment per velocity."""
        self.hover = hover_speed(params)
        self.moment = 0.002 * size * params['mass'] * arm_length(params)
        self.cross = 0.2 * rng.choice([-1.0, 1.0])
        self.parameters = {'coefficient': self.moment}

    def wrench(self, now):
        """Return the moment."""
        share = self.moment * np.mean((now.speeds / self.hover) ** 2)
        x, y, _ = now.air / np.sqrt(1.0 + now.air @ now.air / 9.0)
        return np.zeros(3), share * np.array([self.cross * x - y, x + self.cross * y, 0.0])


class Ground(Influence):
    """Thrust that grows towards the ground, by the height over the radius of the rotors."""

    def __init__(self, size, params, rng):
        """Take what heights and velocities are measured by."""
        self.size, self.radius = size, params['rotor_radius']
        self.parameters = {'size': size}
        self.induced = induced_velocity(params)

    def gain(self, now):
        """Return the factors."""
        return 1.0 + self.size * self.law(np.maximum(now.heights / self.radius, 0.5), now)


class Rational(Ground):
    """A rational law of the mean of each rotor's height and that of all: they share a cushion."""

    def law(self, heights, now):
        """Return the gain at size 1."""
        shared = 0.5 * (heights + np.mean(heights))
        return 0.06 / (1.0 + (shared / 1.2) ** 2)


class Cushion(Ground):
    """A cushion that holds up to 2.5 radii, then fades."""

    def law(self, heights, now):
        """Return the gain at size 1."""
        return 0.05 / (1.0 + np.exp((heights - 2.5) / 0.5))


class Swept(Ground):
    """A power law that fades with the forward speed, as the wake is swept behind."""

    def law(self, heights, now):
        """Return the gain at size 1."""
        forward = (now.air[0] ** 2 + now.air[1] ** 2) / self.induced ** 2
        return 0.04 * heights ** -1.5 / (1.0 + forward)


class Bounded(Ground):
    """Nothing from four radii on, below it with the square of what is missing."""

    def law(self, heights, now):
        """Return the gain at size 1."""
        return 0.07 * np.maximum(1.0 - heights / 4.0, 0.0) ** 2
