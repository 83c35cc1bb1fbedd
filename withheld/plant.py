# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The reality: rotorpy's multirotor, with what it lacks put into its wrench and around it."""

import copy

import numpy as np
from rotorpy.vehicles.multirotor import Multirotor

from withheld.vehicles import hover_speed

NO_LAG = 1e12       # s: the speeds stay where the step sets them
PART = 0.7          # of the time constant, one step of Runge-Kutta: 0.3 % of what is left
SETTLED = 8.0       # time constants after which the command is reached


class Reality(Multirotor):
    """
    A vehicle with effects.

    effects: {name: {parameter: value}} with the names and parameters of the project, or one of
    `outside` (see outside.py) as the object `stranger`.
    """

    def __init__(self, params, effects, stranger=None):
        """Put the effects into rotorpy's parameters, where it has them."""
        true, speeds = copy.deepcopy(params), params['num_rotors'] * hover_speed(params)
        get = {name: effects.get(name, {}) for name in NAMES}.__getitem__
        true['mass'] += get('mass_offset').get('mass', 0.0)
        for axis, key in zip('xyz', ('Ixx', 'Iyy', 'Izz'), strict=True):
            true[key] *= get('inertia_mismatch').get(f'factor_{axis}', 1.0)
        self.centre = np.array([get('com_offset').get(axis, 0.0) for axis in 'xyz'])
        true['rotor_pos'] = {name: place - self.centre
                             for name, place in true['rotor_pos'].items()}
        true['k_eta'] *= get('thrust_scale').get('factor', 1.0)
        true['k_d'] = get('rotor_drag').get('coefficient', 0.0) / speeds
        true['k_z'] = get('inflow').get('axial', 0.0) / speeds
        true['k_h'] = get('inflow').get('translational', 0.0) / params['num_rotors']
        true['k_flap'] = get('blade_flapping').get('coefficient', 0.0) / speeds
        true['c_Dx'] = true['c_Dy'] = get('body_drag').get('horizontal', 0.0)
        true['c_Dz'] = get('body_drag').get('vertical', 0.0)
        self.lag = get('motor_lag').get('time_constant', 0.0)
        true['tau_m'] = self.lag or NO_LAG
        super().__init__(true)
        self.delay = get('actuation_delay').get('delay', 0.0)
        self.wind = np.array([get('wind').get(axis, 0.0) for axis in 'xyz'])
        self.linear_drag = params['linear_drag']
        self.radius = params['rotor_radius']
        self.ground = get('ground_effect').get('strength', 0.0)
        self.faults = np.array([get('rotor_fault').get(f'loss_{j + 1}', 0.0)
                                for j in range(self.num_rotors)])
        self.sag = get('battery_sag').get('exponent', 0.0)
        self.rotor_inertia = get('rotor_gyro').get('rotor_inertia', 0.0)
        self.stranger = stranger
        self.voltage_ratio = 1.0        # of the voltage to the full one, at this moment
        self.time = 0.0
        self._command = None
        self._place = None

    def _s_dot_fn(self, t, s, cmd_rotor_speeds):
        # What rotorpy's wrench does not get told.
        self._place = s[0:3], rotation_of(s[6:10]), s[3:6]
        self._command = cmd_rotor_speeds
        return super()._s_dot_fn(t, s, cmd_rotor_speeds)

    def compute_body_wrench(self, body_rates, rotor_speeds, body_airspeed_vector):
        """Return rotorpy's force and moment (body), and those of what it lacks."""
        force, moment = super().compute_body_wrench(body_rates, rotor_speeds,
                                                    body_airspeed_vector)
        force = force - self.linear_drag * body_airspeed_vector
        position, rotation, velocity = self._place
        gain = (1.0 - self.faults) * self.voltage_ratio ** self.sag
        if self.ground:
            height = position[2] + self.rotor_geometry @ rotation[2]
            ratio = self.radius / (4.0 * np.maximum(height, 0.5 * self.radius))
            gain = gain / (1.0 - np.minimum(self.ground * ratio ** 2, 0.75))
        if self.stranger is not None:
            gain = gain * self.stranger.gain(rotor_speeds)
            force = force + rotation.T @ self.stranger.force(self.time, position, velocity)
        extra = self.k_eta * rotor_speeds ** 2 * (gain - 1.0)
        force[2] += extra.sum()
        moment[0] += self.rotor_geometry[:, 1] @ extra
        moment[1] -= self.rotor_geometry[:, 0] @ extra
        if self.rotor_inertia:
            spins = self.rotor_inertia * (self.rotor_dir @ rotor_speeds)
            moment[0] += spins * body_rates[1]
            moment[1] -= spins * body_rates[0]
            if self.lag:
                moment[2] += self.rotor_inertia * (
                    self.rotor_dir @ (self._command - rotor_speeds)) / self.lag
        return force, moment

    def advance(self, state, command, step):
        """
        Return the packed state (20,) after a step (s) with a command held.

        By the midpoint rule, which is exact for what a held command brings about but for turns of
        milliradians; with a lag by Runge-Kutta of the fourth order in parts of its time constant.
        """
        command = np.clip(command, self.rotor_speed_min, self.rotor_speed_max)
        s = state.copy()
        s[13:16] = self.wind
        left = step
        if self.lag:
            for h in self._parts(step):
                s = self._runge_kutta(s, command, h)
                left -= h
        if left > 1e-9:
            s[16:] = command
            s = self._midpoint(s, command, left)
        return s

    def _parts(self, step):
        """Return the steps until the lag is over, or until the end."""
        fast = min(step, SETTLED * self.lag)
        count = int(np.ceil(fast / (PART * self.lag) - 1e-9))
        return [fast / count] * count

    def _midpoint(self, s, command, h):
        slope = self._s_dot_fn(0.0, s, command)
        self.time += 0.5 * h
        s = s + h * self._s_dot_fn(0.0, s + 0.5 * h * slope, command)
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

    def hold(self, state, command, earlier, step):
        """
        Return the packed state after a step (s) with the command given at its beginning.

        Args: earlier: commands of the steps before, the last one last, as many as the delay needs.
        """
        whole = int(self.delay / step + 1e-9)
        part = self.delay - whole * step
        given = [command, *reversed(earlier)]
        old, new = given[min(whole + 1, len(given) - 1)], given[min(whole, len(given) - 1)]
        velocity = state[3:6]
        if part > 1e-6:
            state = self.advance(state, old, part)
        state = self.advance(state, new, step - part)
        if self.stranger is not None:
            self.stranger.after(step, rotation_of(state[6:10]), (state[3:6] - velocity) / step)
        return state


def rotation_of(q):
    """Return the matrix (3, 3) of a quaternion x, y, z, w that is nearly of unit length."""
    x, y, z, w = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


NAMES = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'wind', 'inflow',
         'ground_effect', 'battery_sag', 'thrust_scale', 'mass_offset', 'inertia_mismatch',
         'com_offset', 'rotor_fault', 'rotor_gyro', 'blade_flapping', 'attitude_misalignment',
         'gyro_bias')
