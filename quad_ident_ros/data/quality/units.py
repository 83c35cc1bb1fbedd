# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Units other than those of the flight record format."""

import numpy as np

from quad_ident_ros.data.once import once
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import correlation, Grid
from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.attitude import body_rate, quaternion_from_euler, rotate
from quad_ident_ros.model.vehicle import Vehicle

DEGREE = np.pi / 180
RPM = 2 * np.pi / 60
SURE = 0.7      # correlation from which on a slope is taken seriously
NEAR = 1.35     # a slope is a unit's where it is within this factor
CERTAIN = 0.9   # correlation from which on a slope that is no unit's is an error
OFF = 1.5       # no gyro and no estimate is off by that factor
MOVED = 1e-3    # rad/s or m/s rms: less is rounding
OF_ROTORS = ('if the commands are speeds of rotors, give the vehicle file the thrust_coefficient, '
             'torque_coefficient and speed_max of these and take its motors out: the speeds that '
             'it has only stand for thrusts')
"""What to do about commands that do not fit to a vehicle whose signals are thrusts."""


def _is(slope: float, unit: float) -> bool:
    return unit / NEAR < slope < unit * NEAR


def _rates(record: FlightRecord) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the body rate of the attitude and the measured one, or None."""
    grid = Grid.of(record)
    if grid is None or not record.has('wx', 'wy', 'wz'):
        return None
    attitude = grid.attitude()
    if attitude is None:
        return None
    rate = grid.smooth(grid.signal('wx', 'wy', 'wz'))
    return grid.rate_of(attitude)[grid.good], rate[grid.good]


@once
def rates_in_degrees(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find a gyro in deg/s: its rates are 57.3 times those of the attitude."""
    rates = _rates(record) if record.has(*QUATERNION) else None
    if rates is None:
        return []
    sure, slope = correlation(rates[1], rates[0])
    # The sign is a matter of frames, not of units.
    if abs(sure) < SURE or not _is(abs(slope), 1 / DEGREE):
        return _other_size(rates[1], rates[0], 'wx, wy, wz', 'the rates',
                           'those of the attitude')
    return [_gyro_in_degrees(f'the rates are {abs(slope):.1f} times those of the attitude')]


def _other_size(one: np.ndarray, other: np.ndarray, where: str, these: str, those: str
                ) -> list[Finding]:
    """Find signals (N, 3) that go with others, by a factor that is of no unit."""
    sure, slope = correlation(one, other)
    moved = min(np.sqrt(np.mean(values ** 2)) for values in (one, other))
    if abs(sure) < CERTAIN or moved < MOVED or 1 / OFF < abs(slope) < OFF:
        return []
    return [Finding('scale', 'error', where,
                    f'{these} are {abs(slope):.3g} times {those}, which is not a unit',
                    'check their scale where they are written')]


def euler_in_degrees(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """
    Find phi, theta, psi in degrees, and a gyro in deg/s beside them.

    Where one of them is, the angles turn 57.3 times as fast or as slowly as the gyro says; where
    both are, the vehicle accelerates as it would at tilts of a 57.3rd.
    """
    grid = Grid.of(record)
    if grid is None or not record.has(*EULER):
        return []
    alone, euler = not record.has(*QUATERNION), grid.signal(*EULER)
    reference = None
    if record.has('wx', 'wy', 'wz'):
        reference = grid.smooth(grid.signal('wx', 'wy', 'wz'))
    elif not alone and (attitude := grid.attitude()) is not None:
        reference = grid.rate_of(attitude)
    if reference is not None:
        rate = body_rate(euler * DEGREE, grid.derivative(euler))
        sure, slope = correlation(rate[grid.good], reference[grid.good])
        if abs(sure) >= SURE and _is(abs(slope), 1 / DEGREE):
            return [_in_degrees(f'the angles turn {abs(slope):.1f} times as fast as the body')]
        if abs(sure) >= SURE and alone and _is(abs(slope), DEGREE):
            return [_gyro_in_degrees(f'the rates are {1 / abs(slope):.1f} times those of the '
                                     'angles')]
    tilted = _tilted_by_degrees(grid, euler) if alone else None
    if tilted is None:
        return []
    found = [_in_degrees(f'the vehicle accelerates {tilted:.2f} times what the angles give, read '
                         'as degrees')]
    return found + ([_gyro_in_degrees('they are those of angles in degrees')]
                    if reference is not None and abs(sure) >= SURE else [])


def _in_degrees(why: str) -> Finding:
    return Finding('euler_in_degrees', 'error', 'phi, theta, psi',
                   f'{why}: they are in degrees',
                   'multiply phi, theta and psi by pi/180, or say unit: deg in a mapping')


def _gyro_in_degrees(why: str) -> Finding:
    return Finding('rate_in_degrees', 'error', 'wx, wy, wz', f'{why}: they are in deg/s',
                   'multiply wx, wy and wz by pi/180, or say unit: deg/s in a mapping')


def _tilted_by_degrees(grid: Grid, euler: np.ndarray) -> float | None:
    """
    Return the slope of the horizontal acceleration on that of tilts in degrees, if it is about 1.

    Angles in radians have a slope of 57.3.
    """
    if grid.record.has('vx', 'vy'):
        velocity = grid.signal('vx', 'vy')
    elif grid.record.has('px', 'py'):
        velocity = grid.derivative(grid.signal('px', 'py'))
    else:
        return None
    up = rotate(quaternion_from_euler(euler * DEGREE), np.array([0.0, 0.0, 1.0]))
    sure, slope = correlation(grid.derivative(velocity)[grid.good],
                              GRAVITY * grid.smooth(up[:, :2])[grid.good])
    return slope if sure >= SURE and _is(slope, 1.0) else None


def force_in_g(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find an accelerometer in g: the mean of its magnitude is 1."""
    if not record.has('ax', 'ay', 'az'):
        return []
    size = float(np.median(np.linalg.norm(record.stack('ax', 'ay', 'az'), axis=1)))
    if not 0.6 < size < 1.6:
        return []
    return [Finding('force_in_g', 'error', 'ax, ay, az',
                    f'the specific force is {size:.2f} m/s^2 in the middle, in flight it is '
                    f'about {GRAVITY:.3g}: it is in g',
                    f'multiply ax, ay and az by {GRAVITY}, or say unit: g in a mapping')]


@once
def position_in_millimetres(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find positions, or positions and velocities, in mm."""
    grid = Grid.of(record)
    if grid is None or not record.has('vx', 'vy', 'vz'):
        return []
    velocity, remedy, other = grid.smooth(grid.signal('vx', 'vy', 'vz')), [], []
    if record.has('px', 'py', 'pz'):
        moved = grid.derivative(grid.signal('px', 'py', 'pz'))
        sure, slope = correlation(moved[grid.good], velocity[grid.good])
        other = _other_size(moved[grid.good], velocity[grid.good], 'px, py, pz',
                            'the changes of the position', 'the velocity')
        if sure > SURE and _is(slope, 1000.0):
            remedy = ['px', 'py', 'pz']
        elif sure > SURE and _is(slope, 0.001):
            remedy = ['vx', 'vy', 'vz']
    attitude = grid.attitude()
    if not remedy and attitude is not None:
        speeding = grid.derivative(grid.signal('vx', 'vy', 'vz'))[grid.good, :2]
        force = grid.acceleration(attitude)[grid.good, :2]
        sure, slope = correlation(speeding, force)
        if abs(sure) > SURE and _is(abs(slope), 1000.0):
            remedy = ['px', 'py', 'pz', 'vx', 'vy', 'vz']
    if not remedy:
        return other
    names = ', '.join(remedy)
    return [Finding('millimetres', 'error', names,
                    f'{names} change {"1000 times as fast as the other columns say"}: they are '
                    'in mm', f'divide {names} by 1000, or say unit: mm or mm/s in a mapping')]


def speeds_in_rpm(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find commands or rotor speeds in rpm: they are 9.55 times those that carry the vehicle."""
    if vehicle is None:
        return []
    hover, found = vehicle.hover_speed, []
    for prefix in ('cmd', 'rotor'):
        names = record.numbered(prefix)
        if not names:
            continue
        usual = float(np.sqrt(np.mean(np.median(record.stack(*names), axis=0) ** 2)))
        if _is(usual / hover, 1 / RPM):
            found.append(Finding(
                f'{prefix}_in_rpm', 'error', f'{names[0]} to {names[-1]}',
                f'the speeds are {usual:.0f} in the middle where {hover:.0f} rad/s carry '
                f'{vehicle.name}: they are in rpm',
                f'multiply {prefix}* by 2 pi/60, or say unit: rpm in a mapping'))
    return found
