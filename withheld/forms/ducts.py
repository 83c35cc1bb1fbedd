# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Air in ducts, on bodies in the wake, over crests, from fans, and over ground in a yard."""

import numpy as np

from withheld.constants import AIR_DENSITY, arm_length, GRAVITY
from withheld.forms.air import Drag, Ground, Thrust, Wind


def induced_of(params):
    """Return the induced velocity in hover, m/s."""
    area = params['num_rotors'] * np.pi * params['rotor_radius'] ** 2
    return float(np.sqrt(params['mass'] * GRAVITY / (2.0 * AIR_DENSITY * area)))


class Ducted(Drag):
    """
    Rotors in ducts, which turn the air that they take in: its momentum is drag, at their lips.

    J. L. Pereira, Hover and wind-tunnel testing of shrouded rotors for improved micro air vehicle
    design, University of Maryland, 2008.
    """

    beside = ('blade_flapping',)

    def __init__(self, size, params, rng):
        """Set the height of the lips."""
        super().__init__(size, params, rng)
        self.induced = induced_of(params)
        self.lip = np.array([0.0, 0.0, 0.15 * arm_length(params)])

    def wrench(self, now):
        """Return force and moment."""
        turn = float(np.mean(now.speeds)) / self.hover
        across = now.air * [1.0, 1.0, 0.0]
        taken = np.sqrt(turn ** 2 + across @ across / self.induced ** 2)
        force = -self.coefficient * taken * across
        return force, np.cross(self.lip, force)


class Downwashed(Drag):
    """
    A body in the wake of its rotors, on which its own velocity and that of the wake add up.

    The download of hovering rotors on a fuselage: W. Johnson, Helicopter Theory, 1980. What it is
    in hover is part of the thrust that was measured.
    """

    beside = ('rotor_drag', 'inflow')
    WAKE = 0.4          # of the induced velocity

    def __init__(self, size, params, rng):
        """Set the velocity of the wake in hover."""
        super().__init__(size, params, rng)
        self.wake = self.WAKE * induced_of(params)

    def law(self, now):
        """Return what the coefficient is of."""
        wake = np.array([0.0, 0.0, self.wake * float(np.mean(now.speeds)) / self.hover])
        flow = now.air + wake
        return np.linalg.norm(flow) * flow - np.linalg.norm(wake) * wake


class Shedding(Drag):
    """
    A blunt body from which vortices part in turn: drag, and a force to either side.

    R. D. Blevins, Flow-Induced Vibration, 1990, chapter 3.
    """

    NUMBER, SIDE = 0.2, 0.6         # Strouhal's; of the drag

    def __init__(self, size, params, rng):
        """Set the width of the body, m."""
        super().__init__(size, params, rng)
        self.width = arm_length(params)

    def begin(self, rng):
        """Draw the phase."""
        self._phase, self._speed = rng.uniform(0.0, 2.0 * np.pi), 0.0

    def law(self, now):
        """Return what the coefficient is of."""
        x, y, _ = now.air
        self._speed = float(np.linalg.norm(now.air))
        side = self.SIDE * np.sin(self._phase)
        return self._speed * (now.air + side * np.array([-y, x, 0.0]))

    def after(self, step, rotation, acceleration):
        """Let the vortices go on."""
        self._phase += 2.0 * np.pi * self.NUMBER * self._speed / self.width * step


class Crest(Wind):
    """
    Wind over a low crest: it speeds up there, rises before and sinks behind.

    P. S. Jackson, J. C. R. Hunt, Turbulent wind flow over a low hill, Quarterly Journal of the
    Royal Meteorological Society 101, 1975.
    """

    UP, HALF = 0.6, 1.2         # of the mean, at the crest; m

    def __init__(self, size, params, rng):
        """Draw where it is."""
        super().__init__(size, params, rng)
        self.place = rng.uniform(-0.5, 0.5, 2)

    def wind(self, time, position):
        """Return the velocity of the air."""
        speed = np.linalg.norm(self.mean)
        if not speed:
            return np.zeros(3)
        on = (position[:2] - self.place) @ self.mean[:2] / speed / self.HALF
        bell = 1.0 / (1.0 + on * on)
        return (0.8 + self.UP * bell) * self.mean + np.array(
            [0.0, 0.0, -2.0 * self.UP * on * bell ** 2 * speed])


class Cycled(Wind):
    """
    Wind of a fan that is switched between two stages, and takes a second to follow.

    As tests of vehicles before fans are done in practice.
    """

    PERIOD, SWING, TIME = 8.0, 0.4, 1.0         # s; of the mean, either way; s

    def begin(self, rng):
        """Draw the phase."""
        self.phase = rng.uniform(0.0, self.PERIOD)

    def wind(self, time, position):
        """Return the velocity of the air."""
        half = 0.5 * self.PERIOD
        number, rest = divmod(time + self.phase, half)
        side = 1.0 if int(number) % 2 else -1.0
        last = 1.0 / (1.0 + np.exp(-half / self.TIME))
        return (1.0 + self.SWING * side * (
            1.0 - 2.0 * last * np.exp(-rest / self.TIME))) * self.mean


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


class Slope(Ground):
    """
    Ground that slopes, so that the rotors on one side are nearer to it, by Hayden's fit.

    J. S. Hayden, The effect of the ground on helicopter hovering power required, American
    Helicopter Society 32nd Annual Forum, 1976.
    """

    SLOPE = 0.25

    def __init__(self, size, params, rng):
        """Draw which way it rises."""
        super().__init__(size, params, rng)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.rises = self.SLOPE / self.radius * np.array([np.cos(angle), np.sin(angle), 0.0])

    def law(self, heights, now):
        """Return the gain at size 1."""
        nearer = now.places @ now.rotation.T @ self.rises
        left = np.maximum(heights - nearer, 0.5)
        return 0.5 * ((1.0 + 0.0379 * (2.0 / left) ** 2) ** (2.0 / 3.0) - 1.0)


class Recirculating(Ground):
    """
    A yard in which the wake comes back from the walls and takes away what the ground gives.

    Recirculation beside obstacles: Rotorcraft Flying Handbook, FAA-H-8083-21, 2000.
    """

    TIME, PART = 1.5, 1.4       # s; of the gain, when it has come back

    def begin(self, rng):
        """Start in air at rest."""
        self._slow, self._now = 0.0, 0.0

    def law(self, heights, now):
        """Return the gain at size 1."""
        gain = 0.25 * np.exp(-0.8 * heights)
        self._now = float(np.mean(gain))
        return gain - self.PART * self._slow

    def after(self, step, rotation, acceleration):
        """Let it come back."""
        self._slow += (1.0 - np.exp(-step / self.TIME)) * (self._now - self._slow)
