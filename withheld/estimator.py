# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
States as real logs have them: out of an estimator, which the controller flies on, too.

A case takes one of the `SETUPS` of its part and flies an `EstimatedWorld` where other cases fly a
`World`: the same arguments, and `setup=SETUPS['development'][0]`. Its Flown has the estimates as
`measured`; `exact` is what sensors without noise would have shown, so that the strength of an
effect is measured against what the estimator makes of it (realities.size_of), as everywhere.

An inertial measurement unit (IMU) at 500 Hz gives the mean rate and specific force of each step,
with bias, white noise and the vibration of the rotors; position, and velocity or attitude or
heading, come more seldom and late. The filter integrates the former and is corrected by the
latter. What is recorded: its position, velocity and attitude, and the gyro behind a low pass and
without the estimated bias.
"""

from collections import deque
from dataclasses import dataclass, replace
from functools import partial
import math

import numpy as np
from scipy.signal import butter
from scipy.spatial.transform import Rotation

from withheld.constants import cross, GRAVITY, hover_speed, rotation_of
from withheld.controllers import CONTROLLERS
from withheld.fly import FARTHEST, FASTEST, Flown, IDLE, INTEGRAL, Lost
from withheld.logs import Logging
from withheld.realities import World

UP = np.array([0.0, 0.0, 1.0])
BEFORE = 1.0        # s flown before the record begins: by then a filter has settled


@dataclass(frozen=True)
class Imu:
    """
    An inertial measurement unit.

    rate Hz; gyro rad/s and accelerometer m/s^2, deviations of the white noise of a sample;
    gyro_bias rad/s and accelerometer_bias m/s^2, deviations of what calibration left on each
    axis, drawn per flight; shaking (rad/s, m/s^2): amplitude of the vibration of one rotor in
    hover, which goes with the square of its speed.
    """

    rate: float = 500.0
    gyro: float = 0.01
    accelerometer: float = 0.15
    gyro_bias: float = 0.005
    accelerometer_bias: float = 0.03
    shaking: tuple = (0.03, 0.5)


@dataclass(frozen=True)
class Aid:
    """
    What corrects the estimate.

    rate Hz; latency s; deviations of position m, velocity m/s, attitude rad, heading rad; None
    where it does not measure that.
    """

    rate: float
    latency: float
    position: float
    velocity: float | None = None
    attitude: float | None = None
    heading: float | None = None


@dataclass(frozen=True)
class Setup:
    """
    An autopilot with its sensors.

    make_filter(start, aid) returns the filter; assumed s, the latency that it takes for true;
    cutoff Hz and order of the low pass of the gyro; control Hz, a multiple of the record's rate.
    """

    imu: Imu
    aid: Aid
    make_filter: object
    assumed: float
    cutoff: float
    order: int
    control: float


@dataclass
class Estimate:
    """
    Position (3,) m, velocity (3,) m/s, rotation (3, 3) body to world, biases (3,) of the IMU.

    Its arrays are replaced, never written to: to keep one is to copy it.
    """

    position: np.ndarray
    velocity: np.ndarray
    rotation: np.ndarray
    gyro_bias: np.ndarray
    accelerometer_bias: np.ndarray

    def propagate(self, gyro, force, step):
        """Integrate the mean rate rad/s and specific force m/s^2 of a step of s."""
        rate, force = gyro - self.gyro_bias, force - self.accelerometer_bias
        half = exponential(0.5 * step * rate)
        middle = self.rotation @ half
        velocity = self.velocity + step * (middle @ force - GRAVITY * UP)
        self.position = self.position + 0.5 * step * (self.velocity + velocity)
        self.velocity, self.rotation = velocity, middle @ half
        return rate, force


class ErrorStateFilter:
    """
    Kalman filter of the error of an estimate (J. Solà, arXiv:1711.02508, with local angles).

    The error (15,): position, velocity, rotation (body), bias of the gyro, of the accelerometer.
    Args: estimate; aid; gyro rad/s and accelerometer m/s^2: deviations of a sample that it
    takes for true; walks (rad/s, m/s^2) of the biases per root second; trust: what the aid's
    deviations are multiplied by.
    """

    def __init__(self, estimate, aid, gyro, accelerometer, walks, trust=1.0):
        """Begin with an estimate that is nearly right."""
        self.now, self.aid, self.trust = estimate, aid, trust
        self.noise = np.repeat([0.0, accelerometer, gyro, 0.0, 0.0], 3) ** 2
        self.walk = np.repeat([0.0, 0.0, 0.0, *walks], 3) ** 2
        self.covariance = np.diag(np.repeat([0.02, 0.05, 0.01, 0.005, 0.05], 3) ** 2)

    def propagate(self, gyro, force, step):
        """Integrate a sample of the IMU."""
        before = self.now.rotation
        rate, force = self.now.propagate(gyro, force, step)
        moves = np.eye(15)
        moves[0:3, 3:6] = step * np.eye(3)
        moves[3:6, 6:9] = -step * before @ hat(force)
        moves[3:6, 12:15] = -step * before
        moves[6:9, 6:9] -= step * hat(rate)
        moves[6:9, 9:12] = -step * np.eye(3)
        self.covariance = moves @ self.covariance @ moves.T
        self.covariance[np.diag_indices(15)] += step ** 2 * self.noise + step * self.walk

    def correct(self, seen, then):
        """Take in what was seen, {name: value}, of the time at which the estimate was `then`."""
        rows, changes, deviations = [], [], []
        for name, value in seen.items():
            change, row = ROWS[name](value, then)
            rows.append(row)
            changes.append(change)
            deviations.append(np.full(len(change), self.trust * getattr(self.aid, name)))
        row, change = np.concatenate(rows), np.concatenate(changes)
        spread = row @ self.covariance @ row.T + np.diag(np.concatenate(deviations) ** 2)
        gain = np.linalg.solve(spread, row @ self.covariance).T
        self.covariance = self.covariance - gain @ row @ self.covariance
        self.covariance = 0.5 * (self.covariance + self.covariance.T)
        error, now = gain @ change, self.now
        now.position = now.position + error[0:3]
        now.velocity = now.velocity + error[3:6]
        now.rotation = now.rotation @ exponential(error[6:9])
        now.gyro_bias = now.gyro_bias + error[9:12]
        now.accelerometer_bias = now.accelerometer_bias + error[12:15]


class ComplementaryFilter:
    """
    Observer with fixed gains, of the third order in position.

    The attitude as in R. Mahony, T. Hamel and J.-M. Pflimlin, IEEE Trans. Autom. Control (2008).
    Args: estimate; aid; level 1/s, towards the accelerometer's vertical, or towards the measured
    attitude where the aid has it; turn 1/s, towards the measured heading; bias 1/s^2, of the
    gyro; settle s, time constant of the position; blend s, of the velocity towards a measured one.
    """

    def __init__(self, estimate, aid, level, turn, bias, settle, blend=None):
        """Begin with an estimate that is nearly right."""
        self.now, self.aid = estimate, aid
        self.level, self.turn, self.bias = level, turn, bias
        self.settle, self.blend = settle, blend

    def propagate(self, gyro, force, step):
        """Integrate a sample of the IMU."""
        if self.aid.attitude is None:
            now = self.now
            felt = force - now.accelerometer_bias
            off = cross(felt / np.sqrt(felt @ felt), now.rotation.T @ UP)
            now.gyro_bias = now.gyro_bias - step * self.bias * off
            gyro = gyro + self.level * off
        self.now.propagate(gyro, force, step)

    def correct(self, seen, then):
        """Take in what was seen, {name: value}, of the time at which the estimate was `then`."""
        now, step = self.now, 1.0 / self.aid.rate
        change = {name: ROWS[name](value, then)[0] for name, value in seen.items()}
        away, share = change['position'], step / self.settle
        now.position = now.position + 3.0 * share * away
        now.velocity = now.velocity + 3.0 * share / self.settle * away
        now.accelerometer_bias = (now.accelerometer_bias
                                  - share / self.settle ** 2 * now.rotation.T @ away)
        if 'velocity' in change:
            now.velocity = now.velocity + step / self.blend * change['velocity']
        if 'attitude' in change:
            now.rotation = now.rotation @ exponential(step * self.level * change['attitude'])
            now.gyro_bias = now.gyro_bias - step * self.bias * change['attitude']
        if 'heading' in change:
            about = now.rotation.T @ UP
            now.rotation = now.rotation @ exponential(step * self.turn * change['heading'] * about)


class LowPass:
    """A Butterworth low pass of samples (3,): cutoff Hz, order, rate Hz; begins at `value`."""

    def __init__(self, cutoff, order, rate, value):
        """Begin at rest at a value."""
        self.b, self.a = butter(order, cutoff, fs=rate)
        self.held = [value * (np.sum(self.b[i:]) - np.sum(self.a[i:]))
                     for i in range(1, order + 1)]

    def __call__(self, value):
        """Return the output for the next sample."""
        out = self.b[0] * value + self.held[0]
        after = [*self.held[1:], np.zeros_like(value)]
        self.held = [self.b[i + 1] * value - self.a[i + 1] * out + after[i]
                     for i in range(len(after))]
        return out


def hat(v):
    """Return the matrix (3, 3) of the cross product with v."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def exponential(v):
    """Return the rotation (3, 3) about v (3,) by its length, rad."""
    x, y, z = v.tolist()
    square = x * x + y * y + z * z
    angle = math.sqrt(square)
    s, c = (math.sin(angle) / angle, (1.0 - math.cos(angle)) / square) if angle > 1e-4 else (
        1.0 - square / 6.0, 0.5 - square / 24.0)
    return np.array([[1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y],
                     [c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x],
                     [c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)]])


def logarithm(rotation):
    """Return the rotation vector (3,) of a rotation (3, 3) of less than half a turn."""
    v = 0.5 * np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0],
                        rotation[1, 0] - rotation[0, 1]])
    sine, cosine = math.sqrt(v @ v), 0.5 * (rotation[0, 0] + rotation[1, 1] + rotation[2, 2] - 1.0)
    return v if sine < 1e-12 else v * (math.atan2(sine, cosine) / sine)


def quaternion_of(rotation):
    """Return x, y, z, w of a rotation (3, 3): column of its outer square that is the largest."""
    m, trace = rotation, np.trace(rotation)
    square = np.empty((4, 4))
    square[:3, :3] = m + m.T
    square[:3, 3] = square[3, :3] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    square[np.arange(3), np.arange(3)] += 1.0 - trace
    square[3, 3] = 1.0 + trace
    q = square[:, np.argmax(np.diag(square))]
    return q / np.sqrt(q @ q)


def heading_of(rotation):
    """Return the angle about the vertical of the body's x axis."""
    return np.arctan2(rotation[1, 0], rotation[0, 0])


def _block(first):
    out = np.zeros((3, 15))
    out[:, first:first + 3] = np.eye(3)
    return out


PLACE, SPEED, TURN = _block(0), _block(3), _block(6)


def _heading_row(value, then):
    change = (value - heading_of(then.rotation) + np.pi) % (2.0 * np.pi) - np.pi
    x, y = then.rotation[:2, 0]
    row = np.zeros((1, 15))
    row[0, 7] = (y * then.rotation[0, 2] - x * then.rotation[1, 2]) / (x * x + y * y)
    row[0, 8] = (x * then.rotation[1, 1] - y * then.rotation[0, 1]) / (x * x + y * y)
    return np.array([change]), row


# Of what is seen: how far it is from an estimate, and how that grows with the error (15,).
ROWS = {'position': lambda value, then: (value - then.position, PLACE),
        'velocity': lambda value, then: (value - then.velocity, SPEED),
        'attitude': lambda value, then: (logarithm(then.rotation.T @ value), TURN),
        'heading': _heading_row}


class _Sensors:
    """The IMU and the aid of one flight, at the body origin."""

    def __init__(self, setup, centre, tilt, hover, rng):
        self.setup, self.centre, self.hover, self.rng = setup, centre, hover, rng
        self.tilt = Rotation.from_euler('ZYX', tilt[::-1]).as_matrix()
        # Without a measured attitude the sensor block as a whole sits askew.
        self.block = np.eye(3) if setup.aid.attitude is not None else self.tilt
        imu = setup.imu
        self.bias = (imu.gyro_bias * rng.normal(size=3),
                     imu.accelerometer_bias * rng.normal(size=3))
        self.phases = rng.uniform(0.0, 2.0 * np.pi, 4)

    def at(self, s):
        """Return position and velocity of the body origin, and the rotation (3, 3)."""
        rotation = rotation_of(s[6:10])
        return (s[:3] - rotation @ self.centre,
                s[3:6] - rotation @ cross(s[10:13], self.centre), rotation)

    def imu(self, before, after, speeds, step):
        """Return mean rate and specific force of a step between two of `at`, as measured."""
        imu, rng = self.setup.imu, self.rng
        turn = logarithm(before[2].T @ after[2])
        middle = before[2] @ exponential(0.5 * turn)
        force = middle.T @ ((after[1] - before[1]) / step + GRAVITY * UP)
        self.phases = self.phases + step * speeds
        size = (speeds / self.hover) ** 2
        wave = np.array([size @ np.cos(self.phases), size @ np.sin(self.phases),
                         0.5 * size @ np.cos(2.0 * self.phases)])
        return (self.block.T @ turn / step + self.bias[0] + imu.gyro * rng.normal(size=3)
                + imu.shaking[0] * wave,
                self.block.T @ force + self.bias[1] + imu.accelerometer * rng.normal(size=3)
                + imu.shaking[1] * wave)

    def aid(self, place):
        """Return {name: value} of what the aid measures at one of `at`."""
        aid, rng = self.setup.aid, self.rng
        rotation = place[2] @ self.tilt
        seen = {'position': place[0] + aid.position * rng.normal(size=3)}
        if aid.velocity is not None:
            seen['velocity'] = place[1] + aid.velocity * rng.normal(size=3)
        if aid.attitude is not None:
            seen['attitude'] = rotation @ exponential(aid.attitude * rng.normal(size=3))
        if aid.heading is not None:
            seen['heading'] = heading_of(rotation) + aid.heading * rng.normal()
        return seen

    def exact(self, state, place, bias):
        """Return what sensors without noise show (13,) of a state (13,) and its `at`."""
        return np.concatenate([place[0], place[1], quaternion_of(place[2] @ self.tilt),
                               self.block.T @ state[10:] + bias])


class _Seldom:
    """
    A line that is given a command only every so many steps, as the controller gives it.

    Reality.hold hands the same command over in each step of the IMU; a delay that differs from
    command to command must not be drawn anew for it.
    """

    def __init__(self, line, every):
        """Take the line and the number of steps."""
        self.line, self.every, self._calls, self._parts = line, every, 0, []

    def pass_on(self, time, command, step):
        """Return [(duration s, command (n,))] that fill the step."""
        if self._calls % self.every == 0:
            self._parts = self.line.pass_on(time, command, self.every * step)
        self._calls += 1
        out, rest = [], step
        while self._parts and rest > 1e-9:
            (duration, held), *after = self._parts
            now = min(duration, rest)
            out.append((now, held))
            rest -= now
            self._parts = after if duration - now < 1e-9 else [(duration - now, held), *after]
        return out


def fly_on_estimate(reality, params, path, seconds, step, setup, rng, sensors,
                    full_voltage=12.6, controller='geometric', logging=None):
    """
    Return the Flown of a controller that flies on an estimate; raises Lost.

    Args as of fly.fly, but for setup: a Setup, in the place of the noise; of logging only the bits
    of a command count. sensors['bias'] is added to the recorded gyro: an autopilot that logs it
    without correction. sensors['tilt'] is that of the measured attitude, and where none is
    measured that of the whole sensor block. What the influences do to measurements they do to
    the estimate.
    """
    h = 1.0 / setup.imu.rate
    first, every, turns = (round(span / h) for span in (BEFORE, step, 1.0 / setup.control))
    late, assumed, pause = (round(span / h) for span in (setup.aid.latency, setup.assumed,
                                                         1.0 / setup.aid.rate))
    total = first + every * round(seconds / step)
    control, hover = CONTROLLERS[controller](params), hover_speed(params)
    reality.line = _Seldom(reality.line, turns)
    aim, s = path.update(0.0), np.zeros(20)
    s[0:3], s[3:6] = aim['x'], aim['x_dot']
    s[8:10] = np.sin(0.5 * aim['yaw']), np.cos(0.5 * aim['yaw'])
    s[16:] = hover
    on_board = _Sensors(setup, reality.centre, sensors['tilt'], hover, rng)
    place = on_board.at(s)
    estimate = Estimate(place[0], place[1], place[2] @ on_board.tilt, np.zeros(3), np.zeros(3))
    filtered = setup.make_filter(estimate, setup.aid)
    smooth = LowPass(setup.cutoff, setup.order, setup.imu.rate, np.zeros(3))
    places, thoughts = deque([place], late + 1), deque([replace(estimate)], assumed + 1)
    rate, shift, given = np.zeros(3), np.zeros(3), np.full(4, hover)
    logged = {name: [] for name in ('states', 'speeds', 'exact', 'measured', 'commands',
                                    'voltage')}
    for k in range(total):
        t = k * h
        if not np.abs(s[10:13]).max() < FASTEST:
            raise Lost
        if k:
            after = on_board.at(s)
            gyro, force = on_board.imu(place, after, s[16:], h)
            filtered.propagate(gyro, force, h)
            rate, place = smooth(gyro) - estimate.gyro_bias + sensors['bias'], after
            places.append(place)
            thoughts.append(replace(estimate))
            if k >= late and (k - late) % pause == 0:
                filtered.correct(on_board.aid(places[0]), thoughts[0])
        reality.battery.drain(t, h, given / hover)
        recorded = k >= first and (k - first) % every == 0
        if recorded or k % turns == 0:
            thrust = float(np.mean((given / hover) ** 2))
            measured = np.concatenate([estimate.position, estimate.velocity,
                                       quaternion_of(estimate.rotation), rate])
            exact = on_board.exact(s[:13], place, sensors['bias'])
            for one in reality.influences:
                measured, exact = (one.measured(t, x, thrust) for x in (measured, exact))
        if k % turns == 0:
            aim = path.update(t)
            away = measured[:3] - aim['x']
            if aim.get('idle'):
                given = np.full(4, IDLE * hover)
            elif not np.linalg.norm(away) < FARTHEST:
                raise Lost
            else:
                shift = np.clip(shift - INTEGRAL / setup.control * away, -2.0, 2.0)
                now = {'x': measured[:3] - shift, 'v': measured[3:6], 'q': measured[6:10],
                       'w': measured[10:]}
                given = np.clip(control.update(t, now, aim)['cmd_motor_speeds'], 0.05 * hover,
                                params['rotor_speed_max'])
        if recorded:
            for name, value in zip(logged, (s[:13], s[16:], exact, measured, given,
                                            full_voltage * reality.battery.ratio), strict=True):
                logged[name].append(value)
        s = reality.hold(s, given, h)
    logged = {name: np.array(values) for name, values in logged.items()}
    told = (logging or Logging()).told(logged['commands'], params['rotor_speed_max'])
    return Flown(step=step, **logged | {'commands': told})


class EstimatedWorld(World):
    """A World whose flights are flown on an estimate; `setup` takes the place of the noise."""

    def __init__(self, *args, setup, **options):
        """Take a World's arguments, and a Setup."""
        super().__init__(*args, **options)
        self.setup = setup

    def fly(self, path, seconds, step, noise, rng, voltage, charge=1.0):
        """Return the Flown along a path; noise is not used."""
        setting, reality = self.setting, self.reality(rng, charge)
        return fly_on_estimate(reality, setting.told, path, seconds, step, self.setup, rng,
                               self._sensors(), voltage, setting.controller, setting.logging)


# Two sensors and two filters, paired otherwise for the evaluation, with other gains throughout.
SETUPS = {
    'development': (
        Setup(Imu(), Aid(100.0, 0.008, 0.001, attitude=0.004),
              partial(ErrorStateFilter, gyro=0.05, accelerometer=0.8, walks=(1e-3, 1e-2)),
              assumed=0.006, cutoff=60.0, order=1, control=100.0),
        Setup(Imu(gyro=0.005, accelerometer=0.1, gyro_bias=0.0005),
              Aid(10.0, 0.1, 0.02, velocity=0.04, heading=0.02),
              partial(ComplementaryFilter, level=0.05, turn=0.5, bias=5e-4, settle=1.0, blend=0.5),
              assumed=0.1, cutoff=80.0, order=2, control=250.0)),
    'evaluation': (
        Setup(Imu(gyro=0.006, accelerometer=0.1, shaking=(0.05, 0.8)),
              Aid(20.0, 0.08, 0.03, velocity=0.05, heading=0.03),
              partial(ErrorStateFilter, gyro=0.03, accelerometer=0.4, walks=(5e-4, 5e-3),
                      trust=1.5),
              assumed=0.08, cutoff=50.0, order=1, control=500.0),
        Setup(Imu(gyro=0.015, accelerometer=0.2, shaking=(0.02, 0.3)),
              Aid(50.0, 0.012, 0.0015, attitude=0.006),
              partial(ComplementaryFilter, level=4.0, turn=0.0, bias=2.0, settle=0.3),
              assumed=0.012, cutoff=40.0, order=2, control=100.0)),
}
