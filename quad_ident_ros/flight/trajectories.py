# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Trajectories from rest to rest, scaled to the vehicle, to the duration and to a seed."""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike
import scipy

from quad_ident_ros import schema
from quad_ident_ros.model.vehicle import Vehicle

KNOT = 0.01     # s between the knots of the spline that a trajectory is

Wanted: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Scale:
    """
    What a vehicle can fly in a duration.

    length m of a usual amplitude; acceleration m/s^2 and yaw_acceleration rad/s^2 of a usual
    manoeuvre; radius m of the rotors; altitude m at which flights begin; duration s.
    """

    length: float
    acceleration: float
    yaw_acceleration: float
    radius: float
    altitude: float
    duration: float

    def fade(self, t: np.ndarray, longer: float = 1.0) -> np.ndarray:
        """Return a factor (N,) that rises smoothly from 0 to 1 and falls to 0 at the end."""
        time = min(longer * math.sqrt(10 * self.length / self.acceleration), self.duration / 3)
        return smooth(t / time) * smooth((self.duration - t) / time)

    def pace(self, amplitude: float, share: float) -> float:
        """Return the frequency, rad/s, at which an amplitude (m) takes a share of acceleration."""
        return math.sqrt(share * self.acceleration / amplitude)


Course: TypeAlias = Callable[[np.ndarray, Scale, np.random.Generator], np.ndarray]


def scale_of(vehicle: Vehicle, duration: float) -> Scale:
    """Return the Scale of a vehicle: lengths as the root of its size, half of its free thrust."""
    weight = vehicle.mass * vehicle.gravity
    most = len(vehicle.rotors) * vehicle.thrust_coefficient * vehicle.speed_max ** 2
    acceleration = min(max(0.5 * vehicle.gravity * (most / weight - 1), 0.5), 4.5)
    length = min(math.sqrt(vehicle.arm_length / 0.05), acceleration * (duration / 6) ** 2 / 10)
    yaw = (0.3 * vehicle.torque_coefficient / vehicle.thrust_coefficient * weight
           / vehicle.inertia[2])
    radius = vehicle.rotor_radius or 0.4 * vehicle.arm_length
    return Scale(length, acceleration, min(yaw, 5.0), radius, 1.5 * length + 10 * radius, duration)


def smooth(x: np.ndarray) -> np.ndarray:
    """Return a step over 0 <= x <= 1, of which three derivatives are 0 at both ends."""
    x = np.clip(x, 0.0, 1.0)
    return x ** 4 * (35 - 84 * x + 70 * x ** 2 - 20 * x ** 3)


def _course(t: np.ndarray, x: ArrayLike = 0.0, y: ArrayLike = 0.0, z: ArrayLike = 0.0,
            yaw: ArrayLike = 0.0) -> np.ndarray:
    """Return a course (N, 4) of what moves."""
    return np.stack(np.broadcast_arrays(*(np.asarray(each, float) + 0 * t
                                          for each in (x, y, z, yaw))), axis=-1)


def _heading(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return a heading (N,) that turns slowly to and fro by 0.6 to 1 rad."""
    slow = 2 * np.pi / min(12.0, scale.duration)
    return rng.uniform(0.6, 1.0) * np.sin(slow * t) * scale.fade(t)


def hover(t: np.ndarray, _scale: Scale, _rng: np.random.Generator) -> np.ndarray:
    """Return a place."""
    return _course(t)


def steps(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return steps to places and headings drawn by chance, each after a rest, and back at last."""
    course, here, now = np.zeros((len(t), 4)), np.zeros(4), 0.5
    while True:
        size = [*np.full(3, 0.6 * scale.length), 0.8]
        there = rng.uniform(-1, 1, 4) * size
        moves = [max(0.6, _time_of_step(scale, target - source))
                 for source, target in ((here, there), (there, 0 * there))]
        last = now + moves[0] + 0.8 + moves[1] > scale.duration - 0.2
        if last:
            there = np.zeros(4)
            moves = [min(max(0.6, _time_of_step(scale, here)), scale.duration - now)]
        course += smooth((t - now) / moves[0])[:, None] * (there - here)
        if last:
            return course
        here, now = there, now + moves[0] + 0.8


def _time_of_step(scale: Scale, change: np.ndarray) -> float:
    """Return how long a step takes at the usual acceleration, s; 7.5 is the most of smooth''."""
    return math.sqrt(7.5 * max(float(np.linalg.norm(change[:3])) / scale.acceleration,
                               float(abs(change[3])) / scale.yaw_acceleration))


def circle(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return a circle, to the left or to the right."""
    radius = scale.length * rng.uniform(0.6, 1.0)
    angle = scale.pace(radius, rng.uniform(0.4, 0.8)) * t * rng.choice([-1, 1])
    angle = angle + rng.uniform(0, 2 * np.pi)
    fade = scale.fade(t, 2.0)
    return _course(t, fade * radius * np.cos(angle), fade * radius * np.sin(angle),
                   yaw=_heading(t, scale, rng))


def figure8(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return a lying eight, in a direction drawn by chance."""
    radius = scale.length * rng.uniform(0.7, 1.0)
    angle = scale.pace(2 * radius, rng.uniform(0.4, 0.8)) * t
    turn, fade = rng.uniform(0, 2 * np.pi), scale.fade(t, 2.0)
    along, across = fade * radius * np.sin(angle), fade * 0.5 * radius * np.sin(2 * angle)
    return _course(t, along * np.cos(turn) - across * np.sin(turn),
                   along * np.sin(turn) + across * np.cos(turn), yaw=_heading(t, scale, rng))


def lissajous(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return three oscillations whose frequencies have no common measure."""
    radii = scale.length * rng.uniform(0.6, 1.0, 3) * [1.0, 1.0, 0.4]
    paces = [scale.pace(radius, share) for radius, share in zip(radii, (0.3, 0.45, 0.2),
                                                                strict=True)]
    fade = scale.fade(t, 2.0)
    swings = [fade * radius * np.sin(pace * t + rng.uniform(0, 2 * np.pi))
              for radius, pace in zip(radii, paces, strict=True)]
    x, y, z = swings
    return _course(t, x, y, z, _heading(t, scale, rng))


def _chirp(t: np.ndarray, scale: Scale, slowest: float, share: float) -> np.ndarray:
    """Return a chirp (N,) whose frequency rises fivefold and whose acceleration stays `share`."""
    rise = math.log(5) / scale.duration
    pace = slowest * np.exp(rise * t)
    return share / pace ** 2 * np.sin((pace - slowest) / rise) * scale.fade(t)


def _chirp_along(axis: str) -> Course:
    def chirp(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
        share = rng.uniform(*(0.3, 0.5) if axis == 'z' else (0.4, 0.7))
        slowest = scale.pace(0.6 * scale.length, share)
        return _course(t, **{axis: _chirp(t, scale, slowest, share * scale.acceleration)})

    chirp.__doc__ = f'Return a chirp along {axis}.'
    return chirp


def chirp_yaw(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return a chirp of the heading."""
    share = rng.uniform(0.4, 0.7) * scale.yaw_acceleration
    return _course(t, yaw=_chirp(t, scale, math.sqrt(share / 0.8), share))


def vertical(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return climbs and descents, slow and fast ones at once."""
    slow, fast = scale.length * rng.uniform(0.5, 0.8), scale.length * rng.uniform(0.1, 0.2)
    return _course(t, z=scale.fade(t, 2.0) * (
        slow * np.sin(scale.pace(slow, 0.3) * t)
        + fast * np.sin(scale.pace(fast, 0.3) * t + rng.uniform(0, 2 * np.pi))))


def low_passes(t: np.ndarray, scale: Scale, rng: np.random.Generator) -> np.ndarray:
    """Return passes to and fro, 1.2 to 5 rotor radii over the ground."""
    radius = scale.length * rng.uniform(0.6, 1.0)
    fade, slow = scale.fade(t, 2.0), 2 * np.pi / min(7.0, scale.duration / 2)
    low = scale.radius * (1.2 + 3.8 * (0.5 - 0.5 * np.cos(slow * t))) + 0.02 * scale.length
    along = fade * radius * np.sin(scale.pace(radius, rng.uniform(0.3, 0.5)) * t)
    turn = rng.uniform(0, 2 * np.pi)
    return _course(t, along * np.cos(turn), along * np.sin(turn), fade * (low - scale.altitude))


TRAJECTORIES: dict[str, Course] = {
    'hover': hover, 'steps': steps, 'circle': circle, 'figure8': figure8, 'lissajous': lissajous,
    **{f'chirp_{axis}': _chirp_along(axis) for axis in 'xyz'}, 'chirp_yaw': chirp_yaw,
    'vertical': vertical, 'low_passes': low_passes}
"""Each (t (N,), scale, rng) -> x, y, z, yaw (N, 4) from the start, which is at the altitude."""


def plan(name: str, vehicle: Vehicle, duration: float, seed: int
         ) -> Callable[[np.ndarray], Wanted]:
    """
    Return the trajectory of a name as a function of t (N,) s.

    It returns position (N, 3) m, velocity, acceleration, jerk (world), yaw (N,) rad and yaw rate;
    they are those of a spline of fifth order, so that they are derivatives of one another.
    Raises InputError for an unknown name.
    """
    schema.check_keys('trajectory', {name: None}, TRAJECTORIES)
    scale, rng = scale_of(vehicle, duration), np.random.default_rng([seed, 1])
    knots = np.linspace(0.0, duration, max(8, round(duration / KNOT) + 1))
    course = TRAJECTORIES[name](knots, scale, rng)
    course[:, 2] += scale.altitude
    spline = scipy.interpolate.make_interp_spline(knots, course, k=5)
    derivatives = [spline, *(spline.derivative(order) for order in (1, 2, 3))]

    def trajectory(t: np.ndarray) -> Wanted:
        place, speed, change, jerk = (each(np.clip(t, 0.0, duration)) for each in derivatives)
        return (place[..., :3], speed[..., :3], change[..., :3], jerk[..., :3], place[..., 3],
                speed[..., 3])

    return trajectory
