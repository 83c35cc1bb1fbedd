# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Effects that are outside the list: what the diagnosis must call unknown."""

import numpy as np

from withheld.influence import Influence


class Force(Influence):
    """A force that depends on time and place."""

    def force(self, time, position, velocity):
        """Return the force, (3,) N, in the world."""
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
        self.load = 0.02 * size * mass      # kg; an Influence has a method `mass`
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
        inside = self.load * (self.rate ** 2 * self.place
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


class Wall(Force):
    """
    A force towards an upright wall, by the flow between it and the rotors.

    It falls with the square of the distance; that a wall pulls, and over some radii, is in Paz
    and others, Journal of Wind Engineering and Industrial Aerodynamics 206, 2020.
    """

    REACH = 4.0         # radii of a rotor

    def __init__(self, size, radius, weight, rng):
        """Draw where the wall stands."""
        angle = rng.uniform(0.0, 2.0 * np.pi)
        self.towards = np.array([np.cos(angle), np.sin(angle), 0.0])
        self.distance, self.reach = rng.uniform(0.8, 1.4), self.REACH * radius
        self.size = 0.1 * size * weight

    def force(self, time, position, velocity):
        """Return the force."""
        gap = max(self.distance - position @ self.towards, 0.0)
        return self.size / (1.0 + gap / self.reach) ** 2 * self.towards


class Whirl(Force):
    """A column of turning air: a force around a place, strongest at some distance from it."""

    def __init__(self, size, weight, rng):
        """Draw the place, and which way it turns."""
        self.place, self.core = rng.uniform(-0.5, 0.5, 2), rng.uniform(0.4, 0.8)
        self.size = 0.04 * size * weight * rng.choice([-1.0, 1.0])

    def force(self, time, position, velocity):
        """Return the force, by the velocity of Rankine's vortex with a smooth core."""
        x, y = (position[:2] - self.place) / self.core
        share = 2.0 * self.size / (1.0 + x * x + y * y)
        return np.array([-share * y, share * x, 0.0])


class Stutter(Influence):
    """A rotor that loses thrust for a tenth of a second, now this one and now that one."""

    LAST, EVERY, COUNT = 0.12, 0.9, 100         # s, s on average, so many in a flight

    def __init__(self, size, rotors, rng):
        """Take how deep it is."""
        self.loss, self.rotors = min(0.05 * size, 0.9), rotors

    def begin(self, rng):
        """Draw when, and which rotor."""
        self.times = np.cumsum(rng.exponential(self.EVERY, self.COUNT))
        self.which = rng.integers(self.rotors, size=self.COUNT)

    def gain(self, now):
        """Return the factors."""
        gain, last = np.ones(self.rotors), np.searchsorted(self.times, now.time) - 1
        if last >= 0 and now.time - self.times[last] < self.LAST:
            gain[self.which[last]] -= self.loss
        return gain


class Compass(Influence):
    """
    A heading that is pulled aside by iron on board and by the currents of the motors.

    Once and twice around the horizon, and with the thrust (hard and soft iron: Gebre-Egziabher
    and others, Journal of Aerospace Engineering 19(2), 2006).
    """

    def __init__(self, size, rng):
        """Draw the harmonics."""
        self.sizes = 0.03 * size * rng.uniform(0.6, 1.0, 3) * rng.choice([-1.0, 1.0], 3)
        self.phases = rng.uniform(0.0, 2.0 * np.pi, 2)

    def measured(self, time, state, thrust):
        """Return the state with a heading that is off."""
        out = state.copy()
        x, y, z, w = state[6:10]
        yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        once, twice = np.sin(np.array([yaw, 2.0 * yaw]) + self.phases)
        off = 0.5 * float(self.sizes @ [once, twice, np.clip(thrust, 0.0, 3.0) - 1.0])
        c, s = np.cos(off), np.sin(off)         # a turn about the world's vertical
        out[6:10] = c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z
        return out


class Branches(Influence):
    """
    Branches that the vehicle brushes: short pushes aside, off the centre, now and then.

    As vehicles that fly among trees meet them in practice; each push is half a wave long.
    """

    LAST, EVERY, COUNT = 0.2, 1.2, 100          # s, s on average, so many in a flight
    AWAY = 0.5                                  # radii of a rotor, from the centre

    def __init__(self, size, weight, radius, rng):
        """Take how hard they push, N, and where, m."""
        self.push, self.away = 0.04 * size * weight, self.AWAY * radius

    def begin(self, rng):
        """Draw when, whereto, and at which side of the body."""
        self.times = np.cumsum(rng.exponential(self.EVERY, self.COUNT))
        angles = rng.uniform(0.0, 2.0 * np.pi, (2, self.COUNT))
        self.onto, self.sides = (np.column_stack([np.cos(one), np.sin(one), 0.0 * one])
                                 for one in angles)

    def wrench(self, now):
        """Return force and moment."""
        last = int(np.searchsorted(self.times, now.time)) - 1
        since = now.time - self.times[max(last, 0)]
        if last < 0 or since >= self.LAST:
            return None
        push = self.push * np.sin(np.pi * since / self.LAST) * self.onto[last]
        force = now.rotation.T @ push
        return force, np.cross(self.away * self.sides[last], force)


class Leash(Force):
    """
    A safety line, which is slack near its pole and pulls beyond its length.

    As vehicles are tied up in tests in practice; it pulls as a spring does, and never pushes.
    """

    LENGTHS, HIGH = (0.6, 0.9), 1.0         # m; m, of its end on the pole

    def __init__(self, size, weight, rng):
        """Draw where the pole is, and how long the line is."""
        self.end = np.array([*rng.uniform(-0.4, 0.4, 2), self.HIGH])
        self.length, self.stiffness = rng.uniform(*self.LENGTHS), 0.08 * size * weight

    def force(self, time, position, velocity):
        """Return the force."""
        away = self.end - position
        far = float(np.linalg.norm(away))
        taut = max(far - self.length, 0.0)
        return self.stiffness * taut * away / max(far, 1e-9)


class Recoil(Influence):
    """
    The recoil of a nozzle that cleans: now and then a jet for a second, now ahead and now aside.

    As vehicles that wash panels and facades do in practice; a jet pushes by its momentum, and its
    valve takes a moment. The nozzle is below the centre and points where the body carries it.
    """

    STAYS = np.array([(0.5, 2.0), (0.4, 1.4)])  # s: without a jet, with one
    OPENS, COUNT = 0.08, 60                     # s; far more jets than a flight has
    BELOW = 0.5                                 # radii of a rotor

    def __init__(self, size, weight, radius, rng):
        """Take how hard it pushes, N, and where, m."""
        self.push = 0.03 * size * weight
        self.place = np.array([0.0, 0.0, -self.BELOW * radius])

    def begin(self, rng):
        """Draw when it is on, and where it points."""
        self.times = np.cumsum(rng.uniform(*self.STAYS.T, (self.COUNT, 2)).ravel())
        angles = rng.uniform(0.0, 2.0 * np.pi, self.COUNT)
        self.onto = np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])

    def wrench(self, now):
        """Return force and moment."""
        last = int(np.searchsorted(self.times, now.time)) - 1
        if last < 0:
            return None
        since, on = now.time - self.times[last], last % 2 == 0
        part = np.exp(-since / self.OPENS)
        force = self.push * (1.0 - part if on else part) * self.onto[last // 2]
        return force, np.cross(self.place, force)


class Keel(Influence):
    """
    A balloon on a mast above and as much ballast below: no weight, but a moment towards upright.

    It grows with the lean, as that of a keel does: H. Lamb, Statics, 1912, on bodies that float.
    """

    def __init__(self, size, weight, radius, rng):
        """Take the moment, N m, for a lean of 1 rad."""
        self.moment = 0.03 * size * weight * radius

    def wrench(self, now):
        """Return the moment, which turns the body's vertical to the world's."""
        x, y, _ = now.rotation[2]
        return np.zeros(3), self.moment * np.array([-y, x, 0.0])


class Twisted(Influence):
    """
    A frame that a crash has twisted: all rotors lean around it, and their thrust turns the body.

    Each leans across its own arm, the same way around, so that nothing pushes the body aside. As
    arms of tube turn in their clamps in practice.
    """

    def __init__(self, size, weight, radius, hover, rng):
        """Draw which way around, and take the moment, N m, of the thrust in hover."""
        self.moment = 0.01 * size * weight * radius * rng.choice([-1.0, 1.0])
        self.hover = hover

    def wrench(self, now):
        """Return the moment, which is about the body's vertical."""
        thrust = float(np.mean((now.speeds / self.hover) ** 2))
        return np.zeros(3), np.array([0.0, 0.0, self.moment * thrust])


class Flywheel(Influence):
    """
    A wheel or a scanner that spins on board at one speed: the body resists a turn of its axis.

    By its angular momentum, as a gyrostat (P. C. Hughes, Spacecraft Attitude Dynamics, 1986); it
    pushes nowhere, and not even a moment is left where nothing turns.
    """

    LEANS = 0.3                 # rad, at most, of its axis

    def __init__(self, size, weight, radius, rng):
        """Draw which way it spins, and how its axis leans; take its momentum, (3,) N m s."""
        axis = np.array([*self.LEANS * rng.uniform(-0.7, 0.7, 2), 1.0])
        axis *= rng.choice([-1.0, 1.0]) / np.linalg.norm(axis)
        self.momentum = 0.002 * size * weight * radius * axis

    def wrench(self, now):
        """Return the moment that it takes to turn its axis along."""
        return np.zeros(3), np.cross(self.momentum, now.rate)


class Carousel(Force):
    """
    A hall that turns around, as one aboard a ship in a turn: all is told in its frame.

    Each velocity is pushed across by Coriolis's force, and what is away from the axis outwards: H.
    Goldstein, Classical Mechanics, 1980, chapter 4. The hall takes its air along.
    """

    def __init__(self, size, mass, rng):
        """Draw which way it turns, and where its axis is; take its rate, rad/s."""
        self.load = mass            # kg; an Influence has a method `mass`
        self.rate = 0.025 * size * rng.choice([-1.0, 1.0])
        self.axis = rng.uniform(-0.5, 0.5, 2)

    def force(self, time, position, velocity):
        """Return the force."""
        outwards = self.rate ** 2 * (position[:2] - self.axis)
        across = 2.0 * self.rate * np.array([velocity[1], -velocity[0]])
        return self.load * np.array([*(outwards + across), 0.0])


class Sandbag(Force):
    """
    A line with a sandbag on the ground, which slides once the line pulls hard enough.

    So the line is slack, then taut as a spring is, and then pulls by the friction of the bag,
    which is as much as its weight, and by that where the flight lifts it. As vehicles are secured
    in first flights in practice. A spring and what slides: L. Prandtl, Ein Gedankenmodell zur
    kinetischen Theorie der festen Koerper, Zeitschrift fuer Angewandte Mathematik und Mechanik 8,
    1928.
    """

    LENGTHS, GIVES = (1.4, 1.6), 0.08     # m; m, by which the line is longer as the bag slides
    BEGINS = 0.3                            # m from the middle, at most, along either axis

    def __init__(self, size, weight, rng):
        """Draw how long the line is; take how hard it pulls at most, N."""
        self.length, self.most = rng.uniform(*self.LENGTHS), 0.03 * size * weight

    def begin(self, rng):
        """Draw where the bag lies."""
        self.bag = np.array([*rng.uniform(-self.BEGINS, self.BEGINS, 2), 0.0])
        self._place = self.bag

    def force(self, time, position, velocity):
        """Return the force."""
        self._place = position
        away = self.bag - position
        far = float(np.linalg.norm(away))
        taut = np.clip((far - self.length) / self.GIVES, 0.0, 1.0)
        return self.most * taut * away / max(far, 1e-9)

    def after(self, step, rotation, acceleration):
        """Let the bag slide until the line holds it no more."""
        away = (self.bag - self._place)[:2]
        far, high = float(np.linalg.norm(away)), self._place[2]
        reach = np.sqrt(max((self.length + self.GIVES) ** 2 - high ** 2, 0.0))
        if far > reach:
            self.bag = np.array([*(self._place[:2] + reach / far * away), 0.0])


class Bent(Influence):
    """
    A motor that a crash has bent aside: its thrust pushes the body across its arm, and turns it.

    As the end of an arm of plate bends, or a tube turns in one clamp, in practice: mostly across
    the arm, to either side. The other rotors stand upright.
    """

    ASIDE = 0.5                 # rad, at most, from across the arm

    def __init__(self, size, rotors, weight, hover, rng):
        """Draw which motor it is, and whereto it leans; take how far, rad."""
        self.rotor = int(rng.integers(rotors))
        self.aside = rng.uniform(-self.ASIDE, self.ASIDE) + np.pi * rng.integers(2)
        self.lean, self.lift, self.hover = 0.04 * size, weight / rotors, hover

    def wrench(self, now):
        """Return what the lean changes of the force of the rotor, and the moment of that."""
        place = now.places[self.rotor]
        angle = np.arctan2(place[1], place[0]) + 0.5 * np.pi + self.aside
        sine, cosine = np.sin(self.lean), np.cos(self.lean)
        thrust = self.lift * (now.speeds[self.rotor] / self.hover) ** 2
        force = thrust * np.array([sine * np.cos(angle), sine * np.sin(angle), cosine - 1.0])
        return force, np.cross(place, force)


class Turret(Influence):
    """
    A turret with a camera that looks elsewhere now and then: its reaction turns the body back.

    It pans about the body's vertical and tilts about where it looks across, and each turn starts
    and stops with the least jerk (T. Flash, N. Hogan, The coordination of arm movements, Journal
    of Neuroscience 5(7), 1985), so that it leaves no momentum. Its centre is where its axes meet.
    """

    LASTS, EVERY, COUNT = 0.6, (0.8, 2.0), 60       # s; s, from turn to turn; far more than needed
    PANS, TILTS = 1.5, 1.0                          # rad, from ahead, and downwards, at most

    def __init__(self, size, weight, radius, rng):
        """Take its inertia, kg m^2."""
        self.inertia = 0.0004 * size * weight * radius

    def begin(self, rng):
        """Draw when it turns, and whereto."""
        self.times = np.cumsum(rng.uniform(*self.EVERY, self.COUNT))
        pans = rng.uniform(-self.PANS, self.PANS, self.COUNT + 1)
        tilts = rng.uniform(0.0, self.TILTS, self.COUNT + 1)
        middle = 0.5 * (pans[1:] + pans[:-1])
        across, tilted = np.column_stack([-np.sin(middle), np.cos(middle)]), np.diff(tilts)
        self.turns = np.column_stack([tilted[:, None] * across, np.diff(pans)])

    def wrench(self, now):
        """Return the moment."""
        last = int(np.searchsorted(self.times, now.time)) - 1
        part = (now.time - self.times[max(last, 0)]) / self.LASTS
        if last < 0 or part >= 1.0:
            return None
        slope = 60.0 * part * (1.0 - part) * (1.0 - 2.0 * part) / self.LASTS ** 2
        return np.zeros(3), -self.inertia * slope * self.turns[last]


class Roped(Force):
    """
    A rope that is spanned across the hall, and runs through a ring on the vehicle.

    It pulls equally to either end, so that it holds the vehicle little along itself, and across
    the more, the further it is drawn aside: by its tension at first, and then by how much longer
    it gets. A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations, 1979, on strings; as vehicles are
    secured in first flights in practice.
    """

    SPAN, HIGH = 5.0, (0.8, 1.2)    # m; m, of its ends over ground
    ASIDE = 0.3                     # m, at most, from the middle of the field
    STIFF = 4.0                     # 1/m, of the tension: how much more it is by its length

    def __init__(self, size, weight, rng):
        """Draw where it is spanned; take its tension, N."""
        angle, aside = rng.uniform(0.0, np.pi), rng.uniform(-self.ASIDE, self.ASIDE)
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        middle = np.array([-aside * along[1], aside * along[0], rng.uniform(*self.HIGH)])
        self.ends = middle + 0.5 * self.SPAN * np.array([along, -along])
        self.tension = 0.025 * size * weight

    def force(self, time, position, velocity):
        """Return the force."""
        onto = self.ends - position
        far = np.maximum(np.linalg.norm(onto, axis=1), 1e-9)
        longer = max(float(np.sum(far)) - self.SPAN, 0.0)
        return self.tension * (1.0 + self.STIFF * longer) * ((1.0 / far) @ onto)


class Hoops(Influence):
    """
    Guards around the rotors, which the body has to sweep through the air at each turn.

    They stand in the wake, so that slow turns are braked in proportion, and fast ones with the
    square. S. F. Hoerner, Fluid-Dynamic Drag, 1965, chapter 3. About the vertical they are thin,
    and what they drag of the flight is in the file.
    """

    WAKE, THIN = 2.0, 0.3       # rad/s: of a turn as fast as the wake in hover; of the moment

    def __init__(self, size, weight, radius, hover, rng):
        """Take the moment, N m, of a turn of 1 rad/s in hover."""
        self.moment, self.hover = 0.003 * size * weight * radius, hover

    def wrench(self, now):
        """Return the moment."""
        wake = float(np.mean(now.speeds)) / self.hover
        fast = np.hypot(wake, float(np.linalg.norm(now.rate)) / self.WAKE)
        return np.zeros(3), -self.moment * fast * now.rate * [1.0, 1.0, self.THIN]


class Wand(Influence):
    """
    Motion capture that was calibrated with another wand than it was told: all lengths are off.

    Places and velocities are, and attitudes and rates are not. P. Merriaux and others, A study of
    Vicon system positioning performance, Sensors 17(7), 2017, on what such a calibration decides.
    """

    def __init__(self, size, rng):
        """Draw whether lengths are too long or too short."""
        self.off = 0.01 * size * rng.choice([-1.0, 1.0])

    def measured(self, time, state, thrust):
        """Return the state with lengths that are off."""
        out = state.copy()
        out[:6] *= 1.0 + self.off
        return out


class Pushed(Force):
    """
    People who push with a pole now and then, to see whether the controller holds.

    As laboratories show that disturbances are rejected: each push is half a sine of the time,
    level, in a direction of its own.
    """

    PAUSE, LASTS, COUNT = (0.8, 2.5), (0.15, 0.45), 60      # s; s; far more than a flight has

    def __init__(self, size, weight, rng):
        """Take how hard a push is at most, N."""
        self.most = 0.06 * size * weight

    def begin(self, rng):
        """Draw when the pushes begin, how long they last, whereto and how hard they are."""
        self.lasts = rng.uniform(*self.LASTS, self.COUNT)
        self.begins = np.cumsum(rng.uniform(*self.PAUSE, self.COUNT) + self.lasts) - self.lasts
        angles = rng.uniform(0.0, 2.0 * np.pi, self.COUNT)
        level = np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
        self.pushes = self.most * rng.uniform(0.5, 1.0, (self.COUNT, 1)) * level

    def force(self, time, position, velocity):
        """Return the force."""
        last = max(int(np.searchsorted(self.begins, time)) - 1, 0)
        share = np.clip((time - self.begins[last]) / self.lasts[last], 0.0, 1.0)
        return np.sin(np.pi * share) * self.pushes[last]


class HeightThatFollows(Influence):
    """A height that is off, and that the estimator follows in a TIME, s, with the climb of it."""

    def begin(self, rng):
        """Start with a height that is right."""
        self._off, self._last = 0.0, None

    def followed(self, time, state, goal):
        """Return the state (13,) with a height that comes to be off by a goal, m."""
        step = 0.0 if self._last is None else time - self._last
        self._last = time
        self._off = goal + np.exp(-step / self.TIME) * (self._off - goal)
        out = state.copy()
        out[2] += self._off
        out[5] += (goal - self._off) / self.TIME
        return out


class Barometer(HeightThatFollows):
    """
    A height from a barometer in the flow: the pressure there is not that of air at rest.

    In air that does not move, it is off by a share of the dynamic pressure, another one for each
    side that the flow comes from; the estimator follows in a moment, and so its climb is off as
    well. As PX4 makes up for (EKF2_PCOEF_XP and others); W. Gracey, Measurement of Aircraft Speed
    and Altitude, NASA Reference Publication 1046, 1980.
    """

    TIME = 0.15                 # s, in which the estimator follows

    def __init__(self, size, rng):
        """Draw for flow from ahead, behind, left and right what the height is off, s^2/m."""
        self.shares = 0.002 * size * rng.uniform(0.4, 1.0, (2, 2)) * rng.choice([-1.0, 1.0])

    def measured(self, time, state, thrust):
        """Return the state with a height and a climb that are off."""
        x, y, z, w = state[6:10]
        vx, vy, vz = state[3:6]
        along = np.array([
            (1 - 2 * (y * y + z * z)) * vx + 2 * (x * y + z * w) * vy + 2 * (x * z - y * w) * vz,
            2 * (x * y - z * w) * vx + (1 - 2 * (x * x + z * z)) * vy + 2 * (y * z + x * w) * vz])
        goal = float(np.sum(np.where(along > 0.0, *self.shares.T) * along ** 2))
        return self.followed(time, state, goal)


class Retractor(Force):
    """
    A safety line from a reel overhead, which pays out by itself and locks where it is pulled fast.

    As the belts of cars do: the reel pulls lightly, and once locked the line pulls as a spring
    does, until it is slack again. Standard EN 360 on retractable arresters of falls, with which
    heavy vehicles are secured in first flights, too.
    """

    HIGH, ASIDE = 3.5, 0.4              # m; m from the middle, at most, along either axis
    LOCKS, LIGHT = 0.6, 0.02            # m/s; of the pull, at 1 m of stretch, what the reel pulls

    def __init__(self, size, weight, rng):
        """Draw where the reel is; take how stiff the line is, N/m."""
        self.reel = np.array([*rng.uniform(-self.ASIDE, self.ASIDE, 2), self.HIGH])
        self.stiffness = 0.012 * size * weight

    def begin(self, rng):
        """Start unlocked."""
        self._held, self._far, self._pays = None, 0.0, 0.0

    def force(self, time, position, velocity):
        """Return the force."""
        away = self.reel - position
        self._far = max(float(np.linalg.norm(away)), 1e-9)
        self._pays = -float(away @ velocity) / self._far
        longer = 0.0 if self._held is None else max(self._far - self._held, 0.0)
        return self.stiffness * (self.LIGHT + longer) * away / self._far

    def after(self, step, rotation, acceleration):
        """Lock the reel, or let it go."""
        if self._held is None and self._pays > self.LOCKS:
            self._held = self._far
        elif self._held is not None and self._far < self._held:
            self._held = None


class Glitch(Influence):
    """
    Places by satellites that are reflected for a while: the estimate is drawn aside, and back.

    The filter of the autopilot believes it by and by, in places as in velocities. P. D. Groves,
    Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2013, on paths
    that are reflected; as between houses in practice.
    """

    STAYS = np.array([(0.5, 1.8), (1.0, 2.5)])  # s: on the spot, aside
    TIME, COUNT, UP = 0.5, 40, 1.5      # s, of the filter; far more than needed; of the vertical

    def __init__(self, size, rng):
        """Take how far aside, m."""
        self.far = 0.04 * size

    def begin(self, rng):
        """Draw when, and whereto."""
        self.times = np.cumsum(rng.uniform(*self.STAYS.T, (self.COUNT, 2)).ravel())
        aside = rng.normal(size=(self.COUNT, 3)) * [1.0, 1.0, self.UP]
        aside *= self.far / np.linalg.norm(aside, axis=1)[:, None]
        self.jumps = np.stack([aside, -aside], axis=1).reshape(-1, 3)

    def measured(self, time, state, thrust):
        """Return the state as the filter has it."""
        past = self.times <= time
        left = np.exp(-(time - self.times[past]) / self.TIME)
        out = state.copy()
        out[:3] += (1.0 - left) @ self.jumps[past]
        out[3:6] += left @ self.jumps[past] / self.TIME
        return out


class Lead(Influence):
    """
    A stiff lead to the ground, of power or data, which each turn of the heading winds up.

    It turns the vehicle back as a rod in torsion does, about the vertical, until it slips in its
    clamp. S. Timoshenko, Strength of Materials, 1955, chapter 11; as vehicles fly in a laboratory
    from a supply on the ground. What it weighs is in the file.
    """

    GIVES, WOUND = 1.5, 0.8     # rad, by which it is wound as it slips; rad, at most, at first

    def __init__(self, size, weight, radius, rng):
        """Take the moment, N m, of a turn of 1 rad."""
        self.moment = 0.008 * size * weight * radius

    def begin(self, rng):
        """Draw how it is wound."""
        self._wound, self._last = rng.uniform(-self.WOUND, self.WOUND), None

    def wrench(self, now):
        """Return the moment, which is about the world's vertical."""
        wound = self._slipped(now.rotation)
        return np.zeros(3), -self.moment * wound * now.rotation[2]

    def after(self, step, rotation, acceleration):
        """Wind it up, or let it slip."""
        self._wound, self._last = self._slipped(rotation), rotation

    def _slipped(self, rotation):
        """Return how far, rad, it is wound now, after the turn since the last step."""
        if self._last is None:
            self._last = rotation
        ahead, before = rotation[:2, 0], self._last[:2, 0]
        turned = np.arctan2(before[0] * ahead[1] - before[1] * ahead[0], before @ ahead)
        return float(np.clip(self._wound + turned, -self.GIVES, self.GIVES))


class Rangefinder(HeightThatFollows):
    """
    A height over ground from a rangefinder that looks down, where boxes stand on the floor.

    Over a box it is too little by as much as the box is high; the estimator follows in a moment,
    and takes what it follows for a climb or a descent. Where it looks goes with the lean, for
    which the range is made up for. As of vehicles that fly by optical flow indoors: D. Honegger,
    L. Meier, P. Tanskanen, M. Pollefeys, An open source and open hardware embedded metric optical
    flow CMOS camera, ICRA 2013.
    """

    COUNT, FIELD = 8, 1.2               # m, from the middle, at most, along either axis
    WIDE = (0.25, 0.45)                 # m, half of a side
    TIME = 0.15                         # s, in which the estimator follows

    def __init__(self, size, rng):
        """Draw where the boxes stand, and how wide and how high they are, m."""
        self.places = rng.uniform(-self.FIELD, self.FIELD, (self.COUNT, 2))
        self.wide = rng.uniform(*self.WIDE, (self.COUNT, 2))
        self.high = 0.02 * size * rng.uniform(0.5, 1.0, self.COUNT)

    def measured(self, time, state, thrust):
        """Return the state with a height and a climb that are off."""
        x, y, z, w = state[6:10]
        upright = max(1.0 - 2.0 * (x * x + y * y), 0.3)
        aside = 2.0 * np.array([x * z + y * w, y * z - x * w]) / upright
        spot = state[:2] - max(state[2], 0.0) * aside
        over = np.all(np.abs(spot - self.places) < self.wide, axis=1)
        goal = -float(np.max(self.high * over))
        return self.followed(time, state, goal)


class Sticks(Influence):
    """
    A safety pilot whose sticks are added to what the program commands, and not in the log.

    Now and then the pilot corrects, about one axis of the body: to one side, and back with less.
    As where a program flies through the trainer's port of a transmitter, or the autopilot adds the
    sticks; people move between places with the least jerk (T. Flash, N. Hogan, Journal of
    Neuroscience 5(7), 1985).
    """

    PAUSE, LASTS, COUNT = (0.4, 1.8), (0.2, 0.6), 80    # s; s; far more than a flight has
    BACK, YAW = 0.6, 0.3        # of a correction: what comes back; of the moment, about the axis z

    def __init__(self, size, weight, radius, rng):
        """Take the moment, N m, at most."""
        self.most = 0.02 * size * weight * radius

    def begin(self, rng):
        """Draw when the pilot corrects, and by how much about which axis."""
        self.lasts = rng.uniform(*self.LASTS, self.COUNT)
        self.begins = np.cumsum(rng.uniform(*self.PAUSE, self.COUNT) + self.lasts) - self.lasts
        axes = rng.choice(3, self.COUNT, p=[0.4, 0.4, 0.2])
        sizes = self.most * rng.uniform(0.5, 1.0, self.COUNT) * rng.choice([-1, 1], self.COUNT)
        self.moments = sizes[:, None] * (np.eye(3) * [1.0, 1.0, self.YAW])[axes]

    def wrench(self, now):
        """Return the moment."""
        last = max(int(np.searchsorted(self.begins, now.time)) - 1, 0)
        part = 2.0 * np.clip((now.time - self.begins[last]) / self.lasts[last], 0.0, 1.0)
        share = part % 1.0 if part < 2.0 else 0.0
        stick = 16.0 * share ** 2 * (1.0 - share) ** 2 * (1.0 if part < 1.0 else -self.BACK)
        return np.zeros(3), stick * self.moments[last]


class MovingBase(Influence):
    """
    Places that satellites show from a receiver on a boat, which waves lift and sway.

    The log has places and velocities from there, as where a boat is at anchor and nobody logs its
    own motion. Heave is that of two regular waves; what sways is half of it. T. I. Fossen,
    Handbook of Marine Craft Hydrodynamics and Motion Control, 2011, chapter 8.
    """

    PERIODS, SWAY = ((2.0, 3.5), (3.5, 6.0)), 0.5       # s; of the heave, along one direction

    def __init__(self, size, rng):
        """Draw the waves; size 1 is an acceleration of 0.15 m/s^2 in each."""
        self.rates = 2.0 * np.pi / np.array([rng.uniform(*span) for span in self.PERIODS])
        self.high = 0.15 * size / self.rates ** 2
        heading = rng.uniform(0.0, 2.0 * np.pi)
        self.along = np.array([self.SWAY * np.cos(heading), self.SWAY * np.sin(heading), 1.0])

    def begin(self, rng):
        """Draw where the waves are, (heave, sway)."""
        self.phases = rng.uniform(0.0, 2.0 * np.pi, (2, 2))

    def base(self, time):
        """Return where the receiver is, m, and how fast it moves, m/s, each (3,)."""
        angles = self.rates * time + self.phases
        place, speed = np.sin(angles) @ self.high, np.cos(angles) @ (self.high * self.rates)
        return self.along * place[[1, 1, 0]], self.along * speed[[1, 1, 0]]

    def measured(self, time, state, thrust):
        """Return the state as it is seen from the boat."""
        place, speed = self.base(time)
        out = state.copy()
        out[:3] -= place
        out[3:6] -= speed
        return out


# Each with what of the vehicle its size is measured by.
KINDS = {'periodic_force': (Periodic, 'weight'), 'tether': (Tether, 'weight'),
         'updraft': (Updraft, 'weight'), 'thrust_exponent': (Exponent, 'hover'),
         'backlash': (Backlash, 'hover'), 'slosh': (Slosh, 'mass'),
         'ceiling': (Ceiling, 'radius'), 'neighbours': (Neighbours, 'hover'),
         'wall': (Wall, 'radius', 'weight'), 'whirl': (Whirl, 'weight'),
         'stutter': (Stutter, 'rotors'), 'compass': (Compass,),
         'branches': (Branches, 'weight', 'radius'), 'leash': (Leash, 'weight'),
         'recoil': (Recoil, 'weight', 'radius'), 'keel': (Keel, 'weight', 'radius'),
         'twisted': (Twisted, 'weight', 'radius', 'hover'),
         'flywheel': (Flywheel, 'weight', 'radius'), 'carousel': (Carousel, 'mass'),
         'sandbag': (Sandbag, 'weight'), 'bent': (Bent, 'rotors', 'weight', 'hover'),
         'turret': (Turret, 'weight', 'radius'), 'roped': (Roped, 'weight'),
         'hoops': (Hoops, 'weight', 'radius', 'hover'), 'wand': (Wand,),
         'pushed': (Pushed, 'weight'), 'barometer': (Barometer,),
         'retractor': (Retractor, 'weight'), 'glitch': (Glitch,),
         'lead': (Lead, 'weight', 'radius'), 'rangefinder': (Rangefinder,),
         'moving_base': (MovingBase,), 'sticks': (Sticks, 'weight', 'radius')}
