# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights in closed loop: a controller on what is measured, against a reality."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from withheld.constants import hover_speed, rotation_of
from withheld.controllers import CONTROLLERS
from withheld.logs import Logging, LowPass
from withheld.sensors import declared, moved

INTEGRAL = 0.8      # 1/s, of the position error into the commanded place
FARTHEST, FASTEST = 4.0, 100.0      # m from the path, rad/s: beyond, the vehicle is lost
IDLE = 0.4          # of the speed in hover, of rotors on the floor


class Lost(Exception):
    """The vehicle did not stay on its path."""


@dataclass(frozen=True, eq=False)
class Flown:
    """
    A flight as it was.

    step s; states (N, 13) of the centre of mass; speeds (N, n) rad/s of the rotors; exact (N, 13)
    measured without noise; measured (N, 13); commands (N, n) rad/s, each held for a step;
    voltage (N,) V.
    """

    step: float
    states: np.ndarray
    speeds: np.ndarray
    exact: np.ndarray
    measured: np.ndarray
    commands: np.ndarray
    voltage: np.ndarray

    def thinned(self, every):
        """Return the flight with one of so many rows."""
        if every == 1:
            return self
        return Flown(self.step * every, *(getattr(self, name)[::every] for name in (
            'states', 'speeds', 'exact', 'measured', 'commands', 'voltage')))


def fly(reality, params, path, seconds, step, noise, rng, sensors, full_voltage=12.6,
        controller='geometric', logging=None):
    """
    Return the Flown; raises Lost.

    Args: sensors: {'tilt': (3,), 'bias': (3,)}; noise: a Noise; controller: one of CONTROLLERS;
    logging: a Logging, or None for one row per command.
    """
    logging = logging or Logging()
    step = step / logging.every
    count = round(seconds / step)
    control = CONTROLLERS[controller](params)
    smooth = LowPass(logging.low_pass, step)
    changes = noise.draw(count, step, rng)
    rotors = params['num_rotors']
    states, speeds = np.empty((count, 13)), np.empty((count, rotors))
    exact, measured = np.empty((count, 13)), np.empty((count, 13))
    commands, voltage = np.empty((count, rotors)), np.empty(count)
    aim = path.update(0.0)
    s = np.zeros(16 + rotors)
    s[0:3], s[3:6] = aim['x'], aim['x_dot']
    s[8:10] = np.sin(0.5 * aim['yaw']), np.cos(0.5 * aim['yaw'])
    hover = hover_speed(params)
    s[16:] = hover
    tilt = Rotation.from_euler('ZYX', sensors['tilt'][::-1]).as_quat()
    shift, given = np.zeros(3), np.full(rotors, hover)
    for k in range(count):
        t = k * step
        if not np.abs(s[10:13]).max() < FASTEST:
            raise Lost
        states[k], speeds[k] = s[:13], s[16:]
        exact[k] = declared(states[k], rotation_of(s[6:10]), reality.centre, tilt, sensors['bias'])
        thrust = float(np.mean((given / hover) ** 2))
        for one in reality.influences:
            exact[k] = one.measured(t, exact[k], thrust)
        measured[k] = moved(exact[k], changes[k])
        measured[k, 10:] = smooth(measured[k, 10:])
        reality.battery.drain(t, step, given / hover)
        voltage[k] = full_voltage * reality.battery.ratio
        aim = path.update(t)
        if aim.get('idle'):
            given = np.full(rotors, IDLE * hover)
        else:
            away = measured[k, :3] - aim['x']
            if not np.linalg.norm(away) < FARTHEST:
                raise Lost
            shift = np.clip(shift - INTEGRAL * step * away, -2.0, 2.0)
            now = {'x': measured[k, :3] - shift, 'v': measured[k, 3:6], 'q': measured[k, 6:10],
                   'w': measured[k, 10:]}
            given = np.clip(control.update(t, now, aim)['cmd_motor_speeds'], 0.05 * hover,
                            params['rotor_speed_max'])
        commands[k] = given
        s = reality.hold(s, given, step)
    commands = logging.logged(commands, params['rotor_speed_max'])
    return Flown(step, states, speeds, exact, measured, commands, voltage).thinned(logging.every)
