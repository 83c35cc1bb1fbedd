# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights in closed loop: rotorpy's controller on what is measured, against a reality."""

from dataclasses import dataclass

import numpy as np
from rotorpy.controllers.quadrotor_control import SE3Control

from withheld.sensors import declared, moved

INTEGRAL = 0.8      # 1/s, of the position error into the place that is told
FARTHEST = 4.0      # m from the path: then the vehicle is lost
FULL, EMPTY = 1.0, 0.88


class Lost(Exception):
    """The vehicle did not stay on its path."""


@dataclass(frozen=True, eq=False)
class Flown:
    """
    A flight as it was.

    step s; states (N, 13) of the centre of mass; speeds (N, 4) rad/s of the rotors; exact (N, 13)
    measured without noise; measured (N, 13); commands (N, 4) rad/s, each held for a step;
    voltage (N,) V.
    """

    step: float
    states: np.ndarray
    speeds: np.ndarray
    exact: np.ndarray
    measured: np.ndarray
    commands: np.ndarray
    voltage: np.ndarray


def controller_of(params):
    """Return rotorpy's controller of the nominal vehicle, with gains that bear a delay."""
    control = SE3Control({**params, 'kp_att': 150.0, 'kd_att': 20.0})
    control.kp_pos, control.kd_pos = np.array([4.0, 4.0, 6.0]), np.array([3.2, 3.2, 4.5])
    return control


def fly(reality, params, path, seconds, step, noise, rng, sensors, full_voltage=12.6, sag=0.0):
    """
    Return the Flown; raises Lost.

    Args: sensors: {'tilt': (3,), 'bias': (3,)}; noise: a Noise; sag: share of the voltage that
    is lost over 30 s.
    """
    count = round(seconds / step)
    control = controller_of(params)
    changes = noise.draw(count, step, rng)
    states, speeds = np.empty((count, 13)), np.empty((count, 4))
    exact, measured = np.empty((count, 13)), np.empty((count, 13))
    commands, voltage = np.empty((count, 4)), np.empty(count)
    aim = path.update(0.0)
    s = np.zeros(20)
    s[0:3], s[3:6] = aim['x'], aim['x_dot']
    s[8:10] = np.sin(0.5 * aim['yaw']), np.cos(0.5 * aim['yaw'])
    hover = np.sqrt(params['mass'] * 9.81 / (4 * params['k_eta']))
    s[16:] = hover
    shift, earlier, given = np.zeros(3), [np.full(4, hover)] * 60, None
    for k in range(count):
        t = k * step
        states[k], speeds[k] = s[:13], s[16:]
        exact[k] = declared(states[k:k + 1], reality.centre, **sensors)[0]
        measured[k] = moved(exact[k:k + 1], changes[k:k + 1])[0]
        load = 0.0 if given is None else float(np.mean(given / hover) ** 3 - 1.0)
        reality.voltage_ratio = 1.0 - sag * (t / 30.0 + 0.03 * load)
        voltage[k] = full_voltage * reality.voltage_ratio
        aim = path.update(t)
        away = measured[k, :3] - aim['x']
        if not np.linalg.norm(away) < FARTHEST:
            raise Lost
        shift = np.clip(shift - INTEGRAL * step * away, -2.0, 2.0)
        now = {'x': measured[k, :3] - shift, 'v': measured[k, 3:6], 'q': measured[k, 6:10],
               'w': measured[k, 10:]}
        given = np.clip(control.update(t, now, aim)['cmd_motor_speeds'], 0.05 * hover,
                        params['rotor_speed_max'])
        commands[k] = given
        stranger = reality.stranger
        followed = given if stranger is None else stranger.given(given)
        s = reality.hold(s, followed, earlier[-int(reality.delay / step + 2):], step)
        earlier.append(followed)
    return Flown(step, states, speeds, exact, measured, commands, voltage)
