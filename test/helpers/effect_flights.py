# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Short flights of a vehicle with effects, as the tests of the effects fly them."""

from dataclasses import replace

import numpy as np

from quad_ident_ros.effects.registry import EFFECTS, NULL, SLICES, vector
from quad_ident_ros.model.actuators import actuated
from quad_ident_ros.model.attitude import quaternion_from_euler
from quad_ident_ros.model.dynamics import Course, predict
from quad_ident_ros.model.rigid_body import derivatives, INPUT, rotor_table, vehicle_vector
from quad_ident_ros.model.vehicle import load_vehicle, Rotor

IRIS = load_vehicle('iris')
# No two axes alike, drag on all of them.
VEHICLE = replace(IRIS, inertia=(0.03, 0.026, 0.055), linear_drag=(0.11, 0.12, 0.13),
                  rotational_drag=(1e-3, 2e-3, 3e-3))
BARE = replace(VEHICLE, linear_drag=(0.0, 0.0, 0.0), rotational_drag=(0.0, 0.0, 0.0))
HEXA = replace(VEHICLE, name='hexa', rotors=tuple(
    Rotor((0.3 * np.cos(angle), 0.25 * np.sin(angle), 0.02 * k), 1 if k % 2 else -1)
    for k, angle in enumerate(np.arange(6) * np.pi / 3 + 0.2)))

# Each effect, of a size that shows within a second.
ALL = {'motor_lag': {'time_constant': 0.05}, 'actuation_delay': {'delay': 0.017},
       'rotor_drag': {'coefficient': 0.3}, 'body_drag': {'horizontal': 0.05, 'vertical': 0.08},
       'wind': {'x': 3.0, 'y': -2.0, 'z': 0.7},
       'inflow': {'axial': 0.4, 'translational': 0.02}, 'ground_effect': {'strength': 4.0},
       'battery_sag': {'per_volt': 0.1, 'per_second': 0.01}, 'thrust_scale': {'factor': 1.05},
       'mass_offset': {'mass': 0.1},
       'inertia_mismatch': {'factor_x': 1.2, 'factor_y': 0.9, 'factor_z': 1.1},
       'com_offset': {'x': 0.01, 'y': -0.02, 'z': 0.015}, 'rotor_fault': {'loss_2': 0.1},
       'rotor_gyro': {'rotor_inertia': 5e-5}, 'blade_flapping': {'coefficient': 0.02},
       'attitude_misalignment': {'roll': 0.03, 'pitch': -0.02, 'yaw': 0.1},
       'gyro_bias': {'x': 0.02, 'y': -0.03, 'z': 0.01}}
assert set(ALL) == set(EFFECTS)


def hover_speed(vehicle):
    """Return the speed, rad/s, at which the rotors of a nominal vehicle carry it."""
    return np.sqrt(vehicle.mass * vehicle.gravity
                   / (len(vehicle.rotors) * vehicle.thrust_coefficient))


def state(position=(0, 0, 1), velocity=(0, 0, 0), euler=(0, 0, 0), rate=(0, 0, 0)):
    """Return a state, (13,)."""
    return np.concatenate([position, velocity, quaternion_from_euler(np.array(euler, float)),
                           rate]).astype(float)


def steps(vehicle, seconds=1.0, period=0.01, seed=1):
    """Return a Course whose commands change every few samples, around hover."""
    t = np.arange(round(seconds / period) + 1) * period
    random = np.random.default_rng(seed)
    changes = random.uniform(0.9, 1.1, (len(t) // 8 + 1, len(vehicle.rotors)))
    commands = hover_speed(vehicle) * np.repeat(changes, 8, axis=0)[:len(t)]
    return Course(t, np.ascontiguousarray(commands), 0.5 * t)


def held(vehicle, speeds, seconds=1.0, period=0.01):
    """Return a Course of speeds, a number or (n,) rad/s, that are held."""
    t = np.arange(round(seconds / period) + 1) * period
    commands = np.tile(np.broadcast_to(speeds, len(vehicle.rotors)).astype(float), (len(t), 1))
    return Course(t, commands, np.zeros(len(t)))


def roll(vehicle, effects, course, start):
    """Return the recorded states (N, 13) of a flight along a course."""
    theta = vector(effects, vehicle)
    return predict(vehicle, theta, course, start[None], [0], len(course.t) - 1)[0]


def accelerations(vehicle, start, speeds):
    """Return how velocity and rate change, (6,) m/s^2 and rad/s^2, at rotor speeds (1, n)."""
    out = np.empty((1, 13))
    derivatives(vehicle_vector(vehicle)[:, None], rotor_table(vehicle),
                vector(vehicle.effects, vehicle), np.zeros(1), start[None], speeds,
                np.zeros((1, speeds.shape[1])), np.zeros((1, INPUT)), out)
    return np.array([*out[0, 3:6], *out[0, 10:]])


def acted(t, commands, delay=0.0, lag=0.0):
    """Return what delayed and lagging rotors do: followed, speeds (N, n), added (N, 3, n)."""
    theta = NULL.copy()
    theta[SLICES['actuation_delay']], theta[SLICES['motor_lag']] = delay, lag
    return tuple(each[0] for each in actuated(t, t, commands, theta[None])[:3])
