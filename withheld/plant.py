# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The reality: rotorpy's multirotor, with effects added to its wrench and around it."""

import copy

import numpy as np
from rotorpy.vehicles.multirotor import Multirotor

from withheld.actuators import Battery, Line
from withheld.constants import cross, hover_speed, rotation_of
from withheld.influence import Instant

NO_LAG = 1e12       # s: the speeds stay where the step sets them
PART = 0.35         # of the time constant, one step of Runge-Kutta: an error of 6e-5 of the rest
SETTLED = 8.0       # time constants after which the command is reached
FINE = 0.0034       # s, the steps of motors of another form


class Reality(Multirotor):
    """
    A vehicle with effects.

    effects: {name: {parameter: value}} with the names and parameters of the project; influences:
    what else acts on it (influence.py). line, motor, battery: instead of those of the effects,
    where another form has them (actuators.py, forms/motors.py). floor: the lowest height, m, of
    the body, or None without a floor.
    """

    def __init__(self, params, effects, influences=(), line=None, motor=None, battery=None,
                 floor=None):
        """Put the effects into rotorpy's parameters, where it has them."""
        true, speeds = copy.deepcopy(params), params['num_rotors'] * hover_speed(params)
        get = {name: effects.get(name, {}) for name in NAMES}.__getitem__
        true['mass'] += get('mass_offset').get('mass', 0.0)
        for axis, key in zip('xyz', ('Ixx', 'Iyy', 'Izz'), strict=True):
            true[key] *= get('inertia_mismatch').get(f'factor_{axis}', 1.0)
        true['centre'] = np.array([get('com_offset').get(axis, 0.0) for axis in 'xyz'])
        true['k_eta'] *= get('thrust_scale').get('factor', 1.0)
        true['k_d'] = get('rotor_drag').get('coefficient', 0.0) / speeds
        true['k_z'] = get('inflow').get('axial', 0.0) / speeds
        true['k_h'] = get('inflow').get('translational', 0.0) / params['num_rotors']
        true['k_flap'] = get('blade_flapping').get('coefficient', 0.0) / speeds
        true['c_Dx'] = true['c_Dy'] = get('body_drag').get('horizontal', 0.0)
        true['c_Dz'] = get('body_drag').get('vertical', 0.0)
        for one in influences:
            one.alter(true, params)
        self.centre = true['centre']
        true['rotor_pos'] = {name: place - self.centre
                             for name, place in true['rotor_pos'].items()}
        self.lag = 0.0 if motor else get('motor_lag').get('time_constant', 0.0)
        true['tau_m'] = self.lag or NO_LAG
        super().__init__(_with_four(true))
        self.num_rotors, self.rotor_pos = true['num_rotors'], true['rotor_pos']
        self.rotor_dir = true['rotor_directions']
        self.extract_geometry()
        self._dry = self.mass
        self.hover = hover_speed(params)
        self.line = line or Line(get('actuation_delay').get('delay', 0.0))
        self.motor = motor
        self.battery = battery or Battery(0.0)
        self.steady = np.array([get('wind').get(axis, 0.0) for axis in 'xyz'])
        self.linear_drag, self.body_drag = params['linear_drag'], np.diag(self.drag_matrix)
        self.radius = params['rotor_radius']
        self.ground = get('ground_effect').get('strength', 0.0)
        self.faults = np.array([get('rotor_fault').get(f'loss_{j + 1}', 0.0)
                                for j in range(self.num_rotors)])
        self.rotor_inertia = true.get('rotor_inertia',
                                      get('rotor_gyro').get('rotor_inertia', 0.0))
        self.influences = tuple(influences)
        self.floor = floor
        self.time = 0.0
        self._turning = np.zeros(self.num_rotors)       # rad/s^2, of the rotors
        self._place = None

    def _s_dot_fn(self, t, s, cmd_rotor_speeds):
        """Return the slope (16 + n,) of a packed state, as rotorpy has it but with less ado."""
        rotation, velocity, rate, speeds = rotation_of(s[6:10]), s[3:6], s[10:13], s[16:]
        # What rotorpy's wrench does not receive.
        self._place = s[0:3], rotation, velocity
        turning = (cmd_rotor_speeds - speeds) / self.tau_m
        if self.lag:
            self._turning = turning
        force, moment = self.compute_body_wrench(rate, speeds, rotation.T @ (velocity - s[13:16]))
        x, y, z, w = s[6:10]
        p, q, r = rate
        out = np.zeros(len(s))
        out[0:3] = velocity
        out[3:6] = (self.weight + rotation @ force) / self.mass
        out[6:10] = (0.5 * (w * p - z * q + y * r), 0.5 * (z * p + w * q - x * r),
                     0.5 * (w * r - y * p + x * q), -0.5 * (x * p + y * q + z * r))
        out[10:13] = self.inv_inertia @ (moment - cross(rate, self.inertia @ rate))
        out[16:] = turning
        return out

    def compute_body_wrench(self, body_rates, rotor_speeds, body_airspeed_vector):
        """Return rotorpy's force and moment (body), and those that are added to it."""
        air, places, squares = body_airspeed_vector, self.rotor_geometry, rotor_speeds ** 2
        position, rotation, velocity = self._place
        heights = position[2] + places @ rotation[2]
        gain = (1.0 - self.faults) * self.battery.gain(rotor_speeds / self.hover)
        if self.ground:
            ratio = self.radius / (4.0 * np.maximum(heights, 0.5 * self.radius))
            gain = gain / (1.0 - np.minimum(self.ground * ratio ** 2, 0.75))
        reaction, force, moment = self.rotor_dir * squares, np.zeros(3), np.zeros(3)
        if self.influences:
            now = Instant(self.time, position, velocity, rotation, body_rates, air,
                          rotor_speeds, heights, places)
            for one in self.influences:
                gain, reaction = gain * one.gain(now), reaction * one.torque(now)
                extra = one.wrench(now)
                if extra is not None:
                    force, moment = force + extra[0], moment + extra[1]
        # Of each rotor, as in rotorpy: thrust and in-plane force, reaction, flapping.
        p, q, r = body_rates
        x = air[0] + q * places[:, 2] - r * places[:, 1]
        y = air[1] + r * places[:, 0] - p * places[:, 2]
        z = air[2] + p * places[:, 1] - q * places[:, 0]
        fx, fy = -self.k_d * rotor_speeds * x, -self.k_d * rotor_speeds * y
        fz = (self.k_eta * squares * gain + self.k_h * (x * x + y * y)
              - self.k_z * rotor_speeds * z)
        drag = self.linear_drag + self.body_drag * np.sqrt(air @ air)
        force = force + (fx.sum(), fy.sum(), fz.sum()) - drag * air
        moment = moment + (
            places[:, 1] @ fz - places[:, 2] @ fy - self.k_flap * (rotor_speeds @ y),
            places[:, 2] @ fx - places[:, 0] @ fz + self.k_flap * (rotor_speeds @ x),
            places[:, 0] @ fy - places[:, 1] @ fx + self.k_m * reaction.sum())
        if np.any(self.rotor_inertia):
            spins = self.rotor_dir @ (self.rotor_inertia * rotor_speeds)
            moment += (spins * q, -spins * p,
                       self.rotor_dir @ (self.rotor_inertia * self._turning))
        return force, moment

    def advance(self, state, command, step):
        """
        Return the packed state (16 + n,) after a step (s) with a command held.

        By Runge-Kutta of the fourth order; with a lag in parts of its time constant until the
        rotors have settled. (The midpoint rule over 10 ms turns velocity as a centre of mass that
        is g h^2 / 6, 0.2 mm, higher would.)
        """
        command = np.clip(command, self.rotor_speed_min, self.rotor_speed_max)
        s = state.copy()
        s[13:16] = self.steady + sum(one.wind(self.time, s[:3]) for one in self.influences)
        if self.motor is not None:
            return self._with_motor(s, command, step)
        rest = step
        if self.lag:
            for h in self._parts(step):
                s = self._runge_kutta(s, command, h)
                rest -= h
        if rest > 1e-9:
            self._jump(s, command)
            s = self._runge_kutta(s, command, rest)
        return s

    def _jump(self, s, command):
        # A rotor that jumps hands the change of its angular momentum to the body.
        if np.any(self.rotor_inertia):
            change = self.rotor_dir @ (self.rotor_inertia * (command - s[16:]))
            s[10:13] += self.inv_inertia[:, 2] * change
        self._turning = np.zeros(self.num_rotors)
        s[16:] = command

    def _with_motor(self, s, command, step):
        count = int(np.ceil(step / FINE - 1e-9))
        h = step / count
        for _ in range(count):
            before = s[16:].copy()
            middle = self.motor.turn(before, command, 0.5 * h)
            after = self.motor.turn(middle, command, 0.5 * h)
            self._turning = (after - before) / h
            s = self._midpoint(s, command, h, middle)
            s[16:] = after
        return s

    def _parts(self, step):
        """Return the steps until the lag is over, or until the end."""
        fast = min(step, SETTLED * self.lag)
        count = int(np.ceil(fast / (PART * self.lag) - 1e-9))
        return [fast / count] * count

    def _midpoint(self, s, command, h, speeds):
        slope = self._s_dot_fn(0.0, s, command)
        self.time += 0.5 * h
        halfway = s + 0.5 * h * slope
        halfway[16:] = speeds
        s = s + h * self._s_dot_fn(0.0, halfway, command)
        self.time += 0.5 * h
        s[6:10] /= np.linalg.norm(s[6:10])
        return s

    def _runge_kutta(self, s, command, h):
        a = self._s_dot_fn(0.0, s, command)
        self.time += 0.5 * h
        b = self._s_dot_fn(0.0, s + 0.5 * h * a, command)
        c = self._s_dot_fn(0.0, s + 0.5 * h * b, command)
        self.time += 0.5 * h
        d = self._s_dot_fn(0.0, s + h * c, command)
        s = s + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        s[6:10] /= np.linalg.norm(s[6:10])
        return s

    def hold(self, state, command, step):
        """Return the packed state after a step (s) with the command given at its beginning."""
        for one in self.influences:
            command = one.given(command)
        velocity, begin = state[3:6], self.time
        self.mass = self._dry + sum(one.mass(begin) for one in self.influences)
        self.weight = np.array([0.0, 0.0, -self.mass * self.g])
        for duration, given in self.line.pass_on(begin, command, step):
            state = self._landed(self.advance(state, given, duration))
        rotation = rotation_of(state[6:10])
        for one in self.influences:
            one.after(step, rotation, (state[3:6] - velocity) / step)
        self.time = begin + step        # free of what the parts of the steps round off
        return state

    def _landed(self, s):
        """Return the state as the floor lets it be: it takes every motion from what stands."""
        if self.floor is None or s[2] > self.floor or s[5] > 0.0:
            return s
        yaw = np.arctan2(2 * (s[9] * s[8] + s[6] * s[7]), 1 - 2 * (s[7] ** 2 + s[8] ** 2))
        s[2], s[3:6], s[10:13] = self.floor, 0.0, 0.0
        s[6:10] = 0.0, 0.0, np.sin(0.5 * yaw), np.cos(0.5 * yaw)
        return s


def _with_four(params: dict) -> dict:
    """
    Return parameters with the first four rotors alone.

    rotorpy inverts the allocation of four rotors, which nothing here uses.
    """
    places = dict(list(params['rotor_pos'].items())[:4])
    return params | {'num_rotors': 4, 'rotor_pos': places,
                     'rotor_directions': params['rotor_directions'][:4]}


NAMES = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'wind', 'inflow',
         'ground_effect', 'battery_sag', 'thrust_scale', 'mass_offset', 'inertia_mismatch',
         'com_offset', 'rotor_fault', 'rotor_gyro', 'blade_flapping', 'attitude_misalignment',
         'gyro_bias')
