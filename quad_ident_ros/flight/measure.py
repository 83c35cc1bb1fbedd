# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What motion capture, IMU and autopilot record of a flight: noise, delays, rates and faults."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import scipy

from quad_ident_ros.model.attitude import product, turn


@dataclass(frozen=True)
class Noise:
    """Standard deviations: m, m/s, rad, rad/s, m/s^2, share of the rotor speed, V."""

    position: float = 0.0
    velocity: float = 0.0
    attitude: float = 0.0
    rate: float = 0.0
    force: float = 0.0
    rotor: float = 0.0
    voltage: float = 0.0


@dataclass(frozen=True)
class Stream:
    """
    How a sensor's samples come into the record.

    delay s, which grows by drift s/s; rate Hz of its own, None for the record's; held: each sample
    stays until the next one (stale samples), otherwise the record lies between two.
    """

    delay: float = 0.0
    drift: float = 0.0
    rate: float | None = None
    held: bool = True

    def times(self, t: np.ndarray) -> np.ndarray:
        """Return the times, (N,), of what is recorded at t (N,) s; before the flight its start."""
        return np.maximum(t - self.delay - self.drift * (t - t[0]), t[0])

    def latest(self, t: np.ndarray) -> np.ndarray:
        """Return the times (N,) of the sensor's latest samples before those."""
        return np.floor(self.times(t) * self.rate + 1e-9) / self.rate


@dataclass(frozen=True)
class Sensors:
    """
    What is measured, and how well.

    white noise is new at each sample; coloured noise is a Gauss-Markov process of first order
    with correlation_time s. mocap gives position, velocity and attitude, imu rate and force.
    differentiated: velocity is the difference of measured positions; lost: share of rows that are
    missing; glitches 1/s at which the attitude jumps by glitch_angle rad for glitch_time s;
    voltage, rotors: whether vbat and rotor speeds are recorded.
    """

    white: Noise = field(default_factory=Noise)
    coloured: Noise = field(default_factory=Noise)
    correlation_time: float = 0.5
    mocap: Stream = field(default_factory=Stream)
    imu: Stream = field(default_factory=Stream)
    differentiated: bool = False
    lost: float = 0.0
    glitches: float = 0.0
    glitch_angle: float = 0.3
    glitch_time: float = 0.05
    voltage: bool = True
    rotors: bool = True


CLEAN = Sensors()
MOCAP_IMU = Sensors(
    white=Noise(position=5e-4, velocity=0.01, attitude=2e-3, rate=0.01, force=0.1, rotor=2e-3,
                voltage=0.01),
    coloured=Noise(position=5e-4, velocity=5e-3, attitude=2e-3, rate=2e-3, force=0.02))
FAULTY = Sensors(
    white=MOCAP_IMU.white, coloured=MOCAP_IMU.coloured,
    mocap=Stream(delay=0.02, drift=2e-4, rate=60.0), imu=Stream(delay=0.004),
    differentiated=True, lost=0.01, glitches=0.2, voltage=False, rotors=False)
SENSORS = {'clean': CLEAN, 'mocap_imu': MOCAP_IMU, 'faulty': FAULTY}

Course: TypeAlias = Callable[[np.ndarray], np.ndarray]   # of times (N,) s

_WIDTHS = {'position': 3, 'velocity': 3, 'attitude': 3, 'rate': 3, 'force': 3}


def gauss_markov(rng: np.random.Generator, count: int, width: int, step: float, time: float
                 ) -> np.ndarray:
    """Return unit Gauss-Markov noise (count, width), stationary from the first sample on."""
    keep = np.exp(-step / time)
    noise = rng.standard_normal((count, width))
    noise[1:] *= np.sqrt(1 - keep ** 2)
    return scipy.signal.lfilter([1.0], [1.0, -keep], noise, axis=0)


def errors_of(sensors: Sensors, count: int, step: float, seed: int) -> np.ndarray:
    """Return the errors of position, velocity, attitude, rate and force, (count, 15)."""
    rng = np.random.default_rng([seed, 2])
    columns = []
    for name, width in _WIDTHS.items():
        white = rng.standard_normal((count, width))
        slow = gauss_markov(rng, count, width, step, sensors.correlation_time)
        columns.append(getattr(sensors.white, name) * white
                       + getattr(sensors.coloured, name) * slow)
    return np.concatenate(columns, axis=1)


def measured(sensors: Sensors, t: np.ndarray, states: np.ndarray, forces: np.ndarray,
             errors: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """
    Return the states (N, 13) and forces (N, 3) recorded at t (N,) s, and which rows exist.

    Args: states (N, 13) recorded without noise and delay; forces (N, 3) m/s^2; errors: see
    errors_of.
    """
    rng = np.random.default_rng([seed, 3])
    states, forces = np.asarray(states), np.asarray(forces)
    out = np.concatenate([_shown(sensors.mocap, t, _pose(t, states)),
                          _shown(sensors.imu, t, _linear(t, states[:, 10:]))], axis=1)
    forces = _shown(sensors.imu, t, _linear(t, forces))
    out[:, 6:10] /= np.linalg.norm(out[:, 6:10], axis=1, keepdims=True)
    fresh = _fresh(sensors.mocap, t)
    out[:, :6] += errors[fresh, :6]
    out[:, 6:10] = product(out[:, 6:10], turn(errors[fresh, 6:9] + _glitches(sensors, t, rng)))
    fresh = _fresh(sensors.imu, t)
    out[:, 10:] += errors[fresh, 9:12]
    forces += errors[fresh, 12:15]
    if sensors.differentiated:
        out[:, 3:6] = np.gradient(out[:, :3], t, axis=0)
    rows = rng.random(len(t)) >= sensors.lost
    rows[[0, -1]] = True
    return out, forces, rows


def _shown(stream: Stream, t: np.ndarray, sample: Course) -> np.ndarray:
    """Return what stands in the record at t (N,) of a sensor that gives sample(times)."""
    at = stream.times(t)
    if stream.rate is None:
        return sample(at)
    before = stream.latest(t)
    if stream.held:
        return sample(before)
    share = ((at - before) * stream.rate)[:, None]
    return (1 - share) * sample(before) + share * sample(before + 1 / stream.rate)


def _fresh(stream: Stream, t: np.ndarray) -> np.ndarray:
    """Return the row (N,) whose error each row has: that of the sensor's sample it shows."""
    if stream.rate is None or not stream.held:
        return np.arange(len(t))
    _, first, which = np.unique(stream.latest(t), return_index=True, return_inverse=True)
    return first[which]


def _pose(t: np.ndarray, states: np.ndarray) -> Course:
    """Return position, velocity and quaternion as a function of time, between samples too."""
    spin = product(states[:, 6:10], np.pad(states[:, 10:], ((0, 0), (1, 0)))) / 2
    place = scipy.interpolate.CubicHermiteSpline(t, states[:, :3], states[:, 3:6])
    attitude = scipy.interpolate.CubicHermiteSpline(t, states[:, 6:10], spin)
    velocity = _linear(t, states[:, 3:6])
    return lambda at: np.concatenate([place(np.minimum(at, t[-1])), velocity(at),
                                      attitude(np.minimum(at, t[-1]))], axis=1)


def _linear(t: np.ndarray, values: np.ndarray) -> Course:
    """Return columns as a function of time, straight between samples."""
    return lambda at: np.stack([np.interp(at, t, column) for column in values.T], axis=1)


def _glitches(sensors: Sensors, t: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return the jumps of the attitude as rotation vectors (N, 3) rad."""
    jumps = np.zeros((len(t), 3))
    for begin in rng.uniform(t[0], t[-1], rng.poisson(sensors.glitches * (t[-1] - t[0]))):
        axis = rng.standard_normal(3)
        inside = (t >= begin) & (t < begin + sensors.glitch_time)
        jumps[inside] = sensors.glitch_angle * axis / np.linalg.norm(axis)
    return jumps
