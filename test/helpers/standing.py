# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights that begin on the ground, and the same without position or velocity."""

from functools import cache

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')

WITHOUT = {'velocity': ('px', 'py', 'pz'),
           'velocity alone': ('px', 'py', 'pz', 'wx', 'wy', 'wz', 'ax', 'ay', 'az'),
           'accelerometer and gyro': ('p', 'v', 'q', 'phi', 'theta', 'psi')}


def hover_of(vehicle):
    return np.sqrt(vehicle.mass * vehicle.gravity
                   / (len(vehicle.rotors) * vehicle.thrust_coefficient))


@cache
def brisk():
    """Return a flight at 200 Hz, with all columns of motion capture, accelerometer and gyro."""
    return fly_closed_loop(VEHICLE, {}, 'lissajous', duration=8.0, rate=200.0, seed=3,
                           noise=MOCAP_IMU)


def after_another(first, then):
    """Return the record of one after the other, on one clock."""
    t = np.concatenate([first.t, first.t[-1] + first.period() + then.t - then.t[0]])
    return FlightRecord(t, {name: np.concatenate([first.columns[name], then.columns[name]])
                            for name in first.columns}, {'name': 'both'})


def standing_first(flight, spin_up=0.0, idle=0.3, lag=0.0):
    """
    Return a flight of VEHICLE after 3 s and a spin-up on the ground, with accelerometer and gyro.

    idle: speed of the rotors in hover speeds; lag: s for which the ground holds the vehicle after
    its commands are those of the flight.
    """
    period = flight.period()
    t = period * np.arange(round((3.0 + spin_up + lag) / period))
    speed = hover_of(VEHICLE) * np.where(
        t < 3.0, idle, idle + (1.0 - idle) * np.minimum((t - 3.0) / max(spin_up, 1e-9), 1.0))
    random = np.random.default_rng(8)
    columns = {name: np.zeros(len(t)) for name in flight.columns}
    columns |= {'qw': 1.0 + 0 * t, 'az': VEHICLE.gravity + 0 * t,
                'vbat': flight.columns['vbat'][0] + 0 * t,
                'pz': flight.columns['pz'][0] + 0 * t}
    for names, sigma in ((('wx', 'wy', 'wz'), 0.02), (('ax', 'ay', 'az'), 0.1),
                         (('vx', 'vy', 'vz'), 0.01)):
        for name in names:
            columns[name] = columns[name] + sigma * random.standard_normal(len(t))
    for j in range(1, 5):
        columns[f'cmd{j}'] = speed
    return after_another(FlightRecord(t, columns), flight)


def without(record, groups):
    return FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                   if not (name == 'vbat' or name.startswith(groups))},
                        dict(record.info))
