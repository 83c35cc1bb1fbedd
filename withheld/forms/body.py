# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Masses, inertia, rotors and sensors that differ otherwise than by one factor or offset."""

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.constants import arm_length, hover_speed
from withheld.influence import Influence

AXES = ('Ixx', 'Iyy', 'Izz')
PRODUCTS = ('Ixy', 'Ixz', 'Iyz')


def signs(rng, count):
    """Return as many (count,) of 1 and -1, drawn."""
    return rng.choice([-1.0, 1.0], count)


def inertia_of(params):
    """Return the matrix (3, 3) kg m^2 of rotorpy's parameters."""
    xx, yy, zz = (params[key] for key in AXES)
    xy, xz, yz = (params[key] for key in PRODUCTS)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def set_inertia(params, matrix):
    """Write a matrix (3, 3) kg m^2 into rotorpy's parameters."""
    params.update({key: float(matrix[k, k]) for k, key in enumerate(AXES)})
    params.update(Ixy=float(matrix[0, 1]), Ixz=float(matrix[0, 2]), Iyz=float(matrix[1, 2]))


def add_mass(true, mass, place):
    """Add a point mass (kg) at a place (3,) m from the body origin to rotorpy's parameters."""
    before, total = true['centre'], true['mass'] + mass
    away = np.asarray(place) - before
    reduced = true['mass'] * mass / total       # Steiner, about the common centre
    set_inertia(true, inertia_of(true) + reduced * (
        away @ away * np.eye(3) - np.outer(away, away)))
    true['mass'], true['centre'] = total, before + mass / total * away


class _Load(Influence):
    """A mass somewhere."""

    comparable = True
    beside = ('com_offset', 'inertia_mismatch')

    def alter(self, true, params):
        """Add it."""
        add_mass(true, self.parameters['mass'], self.place)


class Payload(_Load):
    """A payload below the centre, a little to one side."""

    def __init__(self, size, params, rng):
        """Draw where it hangs."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.place = arm_length(params) * np.array([*0.03 * rng.uniform(-1.0, 1.0, 2), -0.5])


class OtherBattery(_Load):
    """A battery that is heavier or lighter than that of the file, below and behind."""

    def __init__(self, size, params, rng):
        """Draw which."""
        self.parameters = {'mass': 0.007 * size * params['mass'] * float(signs(rng, 1)[0])}
        self.place = arm_length(params) * np.array([-0.08 * rng.uniform(0.5, 1.0), 0.0, -0.15])


class Dropped(Influence):
    """A payload at the centre that falls off midway."""

    def __init__(self, size, params, rng):
        """Set its mass."""
        self.parameters = {'mass': 0.007 * size * params['mass']}

    def begin(self, rng):
        """Draw when, s."""
        self.when = rng.uniform(6.0, 11.0)

    def mass(self, time):
        """Return its mass until then."""
        return self.parameters['mass'] if time < self.when else 0.0


class Products(Influence):
    """Moments of inertia that differ, about axes that are not the body's."""

    def __init__(self, size, params, rng):
        """Draw the factors and the turn."""
        self.factors = np.exp(0.1 * size * rng.uniform(0.4, 1.0, 3) * signs(rng, 1))
        self.turn = 0.04 * min(size, 8.0) * rng.normal(size=3)
        self.parameters = {f'factor_{axis}': float(self.factors[k])
                           for k, axis in enumerate('xyz')}

    def alter(self, true, params):
        """Scale the moments, then turn the axes."""
        axes = Rotation.from_rotvec(self.turn).as_matrix()
        root = np.sqrt(self.factors)
        set_inertia(true, axes @ (root[:, None] * inertia_of(true) * root) @ axes.T)


class TorqueCoefficient(Influence):
    """Another torque coefficient: motion sees its ratio to the inertia about z."""

    comparable = True

    def __init__(self, size, params, rng):
        """Draw whether it is greater or less."""
        self.parameters = {'factor_z': float(np.exp(0.08 * size * signs(rng, 1)[0]))}

    def alter(self, true, params):
        """Change it."""
        true['k_m'] /= self.parameters['factor_z']


class Coupled(Influence):
    """A second inertia about each axis, which something couples to that of the body."""

    def __init__(self, size, params, rng):
        """Draw how much of it each axis has."""
        self.shares = 0.12 * size * rng.uniform(0.6, 1.0, 3)
        self.parameters = {'share': 0.12 * size}

    def alter(self, true, params):
        """Take the inertia that it goes with."""
        self.loads = self.shares * [true[key] for key in AXES]


class HeldBehind(Coupled):
    """A second inertia that is pulled after the body by what it is behind, as through springs."""

    FINE = 0.005        # s, the steps

    def begin(self, rng):
        """Start at rest, not behind."""
        self._behind, self._turning, self._rate = np.zeros(3), np.zeros(3), np.zeros(3)

    def turns(self):
        """Return the slope (3,) of its rate, rad/s^2, by what it is behind and both rates."""
        raise NotImplementedError

    def wrench(self, now):
        """Return the moment that pulls it, on the body."""
        self._rate = now.rate
        return np.zeros(3), -self.loads * self.turns()

    def after(self, step, rotation, acceleration):
        """Let it follow."""
        count = int(np.ceil(step / self.FINE - 1e-9))
        for _ in range(count):
            self._turning = self._turning + step / count * self.turns()
            self._behind = self._behind + step / count * (self._rate - self._turning)


class Entrained(Coupled):
    """
    Inertia that the body drags along through friction, as liquid in a tank or a loose harness.

    Each axis turns a second inertia through a viscous coupling: slow turns have all of it to
    move, fast ones nothing but its friction (the viscous ring of P. C. Hughes, Spacecraft Attitude
    Dynamics, 1986; liquids: R. A. Ibrahim, Liquid Sloshing Dynamics, 2005).
    """

    TIME = 0.05         # s, of the coupling

    def begin(self, rng):
        """Start at rest."""
        self._turning, self._rate = np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of the friction."""
        self._rate = now.rate
        return np.zeros(3), self.loads / self.TIME * (self._turning - now.rate)

    def after(self, step, rotation, acceleration):
        """Let it follow."""
        self._turning = self._turning + (1.0 - np.exp(-step / self.TIME)) * (
            self._rate - self._turning)


class Sprung(Coupled):
    """
    Inertia held by a spring, as a camera on rubber dampers: slow turns take it along, fast not.

    A second inertia about each axis on a torsion spring with a damper (J. P. Den Hartog,
    Mechanical Vibrations, 1956, section 3.2).
    """

    FREQUENCY = 2.0 * np.pi * 4.0       # rad/s, of the inertia on its spring
    DAMPING = 0.3                       # of the critical one

    def begin(self, rng):
        """Start at rest."""
        self._angle, self._turning, self._rate = np.zeros(3), np.zeros(3), np.zeros(3)

    def wrench(self, now):
        """Return the moment of spring and damper."""
        self._rate = now.rate
        return np.zeros(3), self.loads * self._pull()

    def after(self, step, rotation, acceleration):
        """Let it swing."""
        self._turning = self._turning - step * self._pull()
        self._angle = self._angle + step * (self._turning - self._rate)

    def _pull(self):
        """Return the moment on the body over the inertia, 1/s^2."""
        return self.FREQUENCY * (self.FREQUENCY * self._angle + 2.0 * self.DAMPING * (
            self._turning - self._rate))


class Outriggers(Influence):
    """Masses moved outwards along one axis across the body: more inertia about the others."""

    def __init__(self, size, params, rng):
        """Draw the axis."""
        angle = rng.uniform(0.0, np.pi)
        self.axis = np.array([np.cos(angle), np.sin(angle), 0.15])
        self.size = 0.12 * size
        self.parameters = {'share': self.size}

    def alter(self, true, params):
        """Add the inertia without a mass."""
        spread = self.axis @ self.axis * np.eye(3) - np.outer(self.axis, self.axis)
        set_inertia(true, inertia_of(true) + self.size * true['Ixx'] * spread)


class Centre(Influence):
    """A centre of mass that is off by as much on average."""

    def __init__(self, size, params, rng):
        """Draw where it is on average."""
        along = np.array([*signs(rng, 2) * rng.uniform(0.3, 1.0, 2), rng.uniform(-0.3, 0.3)])
        self.centre = 0.002 * size * arm_length(params) * along
        self.parameters = dict(zip('xyz', self.centre.tolist(), strict=True))
        self.thrust = params['k_eta']

    def alter(self, true, params):
        """Put the centre where it is on average."""
        true['centre'] = true['centre'] + self.centre


class Sliding(Centre):
    """A centre of mass that slides on in flight, as of a battery that is not fixed."""

    def wrench(self, now):
        """Return the moment of the thrust about a centre that is between 0.8 and 1.2 of it."""
        x, y, _ = self.centre * np.clip(0.4 * (now.time / 20.0 - 0.5), -0.2, 0.2)
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])


class Elastic(Influence):
    """A centre of mass that yields to the load, as of a battery that hangs in soft straps."""

    def __init__(self, size, params, rng):
        """Draw where it is."""
        along = np.array([*signs(rng, 2) * rng.uniform(0.3, 1.0, 2), 0.0])
        self.centre = 0.002 * size * arm_length(params) * along
        self.parameters = dict(zip('xyz', self.centre.tolist(), strict=True))
        self.thrust, self.hover = params['k_eta'], hover_speed(params)

    def wrench(self, now):
        """Return the moment of the thrust about a centre that goes with the thrust."""
        turn = np.mean((now.speeds / self.hover) ** 2)
        x, y, _ = float(np.clip(turn, 0.0, 3.0)) * self.centre
        lift = self.thrust * np.sum(now.speeds ** 2)
        return np.zeros(3), lift * np.array([-y, x, 0.0])


class Sloped(Influence):
    """A thrust curve that is off by a factor, which grows with the speed."""

    def __init__(self, size, params, rng):
        """Draw whether it is more or less."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        return 1.0 + self.share * (1.0 + 1.5 * (np.clip(now.speeds / self.hover, 0.3, 2.0) - 1.0))


class Levelling(Influence):
    """
    A thrust coefficient that falls off below the speed of hover and is level above it.

    As blades at low Reynolds numbers have it, whose coefficient rises with the speed and then
    levels off (Deters, Ananda, Selig, AIAA 2014-2151, figures of small rotors at rest): a kink,
    where a power law is smooth.
    """

    SLOPE = 6.0

    def __init__(self, size, params, rng):
        """Draw whether it is more or less."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.hover = hover_speed(params)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        below = np.clip(1.0 - now.speeds / self.hover, 0.0, 0.7)
        return 1.0 + self.share * (1.0 + self.SLOPE * below)


class Fault(Influence):
    """One rotor that is weaker."""

    def __init__(self, size, params, rng):
        """Draw the rotor."""
        self.rotor, self.loss = int(rng.integers(params['num_rotors'])), 0.005 * size
        self.parameters = {f'loss_{self.rotor + 1}': self.loss}
        self.hover = hover_speed(params)

    def losing(self, now, change):
        """Return factors (n,): the loss times change(its speed over that in hover)."""
        gain = np.ones(len(now.speeds))
        turn = np.clip(now.speeds[self.rotor] / self.hover, 0.2, 3.0)
        gain[self.rotor] -= self.loss * change(turn)
        return gain


class Chipped(Fault):
    """A loss that grows with the square of the speed."""

    def gain(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: turn ** 2)


class Incipient(Fault):
    """
    A loss that grows during the flight, from half of its mean to half as much again.

    Faults that drift, beside those that jump: e.g. Zhang and Jiang, Annual Reviews in Control
    32(2), 2008.
    """

    def gain(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: 0.5 + min(now.time / 20.0, 1.0))

    def torque(self, now):
        """Return the factors: the motor turns more slowly."""
        return self.gain(now)


class Dragging(Fault):
    """A loss of the same force at every speed, with half of it in the torque."""

    def gain(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: turn ** -2)

    def torque(self, now):
        """Return the factors."""
        return self.losing(now, lambda turn: 0.5 * turn ** -2)


class Unequal(Influence):
    """Rotors of unequal inertia."""

    def __init__(self, size, params, rng):
        """Draw how they differ."""
        self.parameters = {'rotor_inertia': 0.002 * size * params['Ixx']}
        self.shares = 1.0 + 0.2 * rng.uniform(-1.0, 1.0, params['num_rotors'])

    def alter(self, true, params):
        """Set them."""
        true['rotor_inertia'] = self.parameters['rotor_inertia'] * self.shares


class HeavyPair(Influence):
    """The rotors of one spin are heavier, so that momentum remains in hover."""

    def __init__(self, size, params, rng):
        """Draw which."""
        self.parameters = {'rotor_inertia': 0.002 * size * params['Ixx']}
        self.shares = 1.0 + 0.15 * signs(rng, 1)[0] * np.asarray(params['rotor_directions'])

    def alter(self, true, params):
        """Set them."""
        true['rotor_inertia'] = self.parameters['rotor_inertia'] * self.shares


class Tilt(Influence):
    """A frame of measurement that is tilted."""

    def __init__(self, size, params, rng):
        """Draw the direction."""
        along = np.array([*signs(rng, 2) * rng.uniform(0.3, 1.0, 2), rng.uniform(-0.3, 0.3)])
        self.angles = 0.008 * size * along
        self.parameters = dict(zip(('roll', 'pitch', 'yaw'), self.angles.tolist(), strict=True))
        self.size, self.draws = size, rng.normal(size=6)

    def tilted(self, state, share=1.0):
        """Return the state with a tilted attitude, and the tilt."""
        tilt = Rotation.from_euler('ZYX', share * self.angles[::-1])
        out = state.copy()
        out[6:10] = (Rotation.from_quat(state[6:10]) * tilt).as_quat()
        return out, tilt.as_matrix()


class BlockWithLever(Tilt):
    """Attitude and rate of a block that sits askew and away from the body origin."""

    comparable = True
    beside = ('com_offset',)

    def __init__(self, size, params, rng):
        """Draw where it sits."""
        super().__init__(size, params, rng)
        self.lever = 0.02 * min(size, 5.0) * arm_length(params) * self.draws[:3]

    def measured(self, time, state, thrust):
        """Return what the block says."""
        out, tilt = self.tilted(state)
        rotation = Rotation.from_quat(state[6:10])
        out[:3] += rotation.apply(self.lever)
        out[3:6] += rotation.apply(np.cross(state[10:], self.lever))
        out[10:] = tilt.T @ state[10:]
        return out


class Creeping(Tilt):
    """An attitude whose tilt grows in flight, from 0.8 to 1.2 of its mean in 20 s."""

    def measured(self, time, state, thrust):
        """Return what is said."""
        return self.tilted(state, 0.8 + 0.4 * min(time / 20.0, 1.0))[0]


class SkewedBlock(Tilt):
    """A tilted block whose gyroscope has axes that are not quite at right angles, nor alike."""

    def measured(self, time, state, thrust):
        """Return what the block says."""
        out, tilt = self.tilted(state)
        a, b, c, d, e, f = 0.004 * min(self.size, 3.0) * self.draws
        out[10:] = (np.eye(3) + [[a, b, c], [0.0, d, e], [0.0, 0.0, f]]) @ tilt.T @ state[10:]
        return out


class SoftMount(Tilt):
    """An attitude from a soft mount: the thrust bends it."""

    def measured(self, time, state, thrust):
        """Return what is said."""
        return self.tilted(state, 0.7 + 0.3 * float(np.clip(thrust, 0.0, 3.0)))[0]


class Bias(Influence):
    """A rate that is off."""

    def __init__(self, size, params, rng):
        """Draw the direction."""
        direction = rng.normal(size=3)
        self.bias = 0.03 * size * direction / np.linalg.norm(direction)
        self.parameters = dict(zip('xyz', self.bias.tolist(), strict=True))

    def measured(self, time, state, thrust):
        """Return what the gyroscope says."""
        out = state.copy()
        out[10:] += self.share(time, thrust) * self.bias
        return out


class Warming(Bias):
    """A bias that settles as the sensor warms."""

    def share(self, time, thrust):
        """Return the share of the bias."""
        return 0.8 + 0.6 * np.exp(-time / 8.0)


class Wandering(Bias):
    """A bias that wanders slowly, otherwise in each flight."""

    def begin(self, rng):
        """Draw the phases."""
        self.phases = rng.uniform(0.0, 6.28, 3)

    def share(self, time, thrust):
        """Return the shares of the bias by axis."""
        return 1.0 + 0.25 * np.sin(2.0 * np.pi * time / 25.0 + self.phases)


class Rectified(Bias):
    """A bias that grows with the thrust, as the gyroscope takes vibration for rate."""

    def share(self, time, thrust):
        """Return the share of the bias."""
        return 0.5 + 0.5 * float(np.clip(thrust, 0.0, 3.0))
