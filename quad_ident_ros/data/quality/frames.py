# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames other than those of the flight record format, found by what must agree."""

import numpy as np

from quad_ident_ros.data.frames import body_vector, world_vector
from quad_ident_ros.data.once import once
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import correlation, explained, Grid, is_rather, WIDTH
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.attitude import conjugate, rotate
from quad_ident_ros.model.vehicle import Vehicle

SURE, BETTER = 0.7, 0.3   # correlation that an explanation needs, and its lead
STILL = 1e-6              # rad/s rms: an attitude that does not turn, but for rounding
TURNED = 0.003            # share of its power by which a velocity in body axes is off at least
STRANGE = 0.5             # correlation under which position and velocity do not go together
SLOW = 0.3                # m/s rms under which noise may hide that they do
HEADING = np.radians([5, 35])   # off for a warning and an error: on a circle, clocks that are
                                # 40 ms apart turn the force by as much
LEVEL = 0.05                # m/s^2 rms, a lean of 0.3 deg: less is rounding or noise
LIKE_SIZE = 1.35            # within this factor two forces are one, drag and lags apart
CLEAR = 0.9                 # correlation from which on it shows to a degree how far it is off
DRAGGED = np.radians([45, 100])     # where no force is measured: drag on a circle looks alike
LEANS, UPRIGHT = 0.9, 0.5   # correlation of the lean with the force where up is right, and wrong
LEAN_OVER = 0.3     # s: noise of an acceleration that is twice a slope counts for little
STANDS = 0.5        # of its length, by which the axis that is up in the body points up in flight
LEAN_SIZE = 0.5, 2.0    # of the lean over that of the force: noise and drag make less of it
TURN = ('turn the world into ENU (x east, y north, z up) and the body into FLU, or say '
        'world: NED, body: FRD in a mapping')


def _reorder(q: np.ndarray) -> np.ndarray:
    return q[:, [3, 0, 1, 2]]


READINGS = {
    'as it is': lambda q: q,
    'x, y, z, w': _reorder,
    'world to body': conjugate,
    'x, y, z, w and world to body': lambda q: conjugate(_reorder(q)),
}
"""What the four quaternion columns may hold, and how to make body to world, w first, of it."""


def readings(grid: Grid) -> dict[str, tuple[np.ndarray, float]]:
    """Return reading -> (attitude (N, 4), correlation of its rate with the gyro's)."""
    q = grid.attitude()
    if q is None or not grid.record.has(*QUATERNION):
        return {} if q is None else {'as it is': (q, 1.0)}
    found = {}
    gyro = (grid.smooth(grid.signal('wx', 'wy', 'wz'))[grid.good]
            if grid.record.has('wx', 'wy', 'wz') else None)
    if gyro is None or _still(grid.rate_of(q)[grid.good]):
        return {'as it is': (q, 1.0)}
    for name, read in READINGS.items():
        attitude = read(q)
        found[name] = attitude, correlation(grid.rate_of(attitude)[grid.good], gyro)[0]
    return found


def _still(rate: np.ndarray) -> bool:
    return np.sqrt(np.mean(rate ** 2)) < STILL


@once
def best_reading(record: FlightRecord) -> tuple[str, np.ndarray] | tuple[None, None]:
    """
    Return (name, attitude on the Grid) of the reading of a record to go by, or twice None.

    As it is, unless another is far better.
    """
    grid = Grid.of(record)
    found = {} if grid is None else readings(grid)
    if not found:
        return None, None
    best = max(found, key=lambda name: found[name][1])
    if found[best][1] < SURE or found[best][1] < found['as it is'][1] + BETTER:
        best = 'as it is'
    return best, found[best][0]


@once
def quaternion(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find quaternions in another order or direction, and rates about other body axes."""
    grid = Grid.of(record)
    if grid is None or not record.has(*QUATERNION, 'wx', 'wy', 'wz'):
        return []
    name, attitude = best_reading(record)
    if name is None or attitude is None:
        return []
    rate = grid.rate_of(attitude)[grid.good]
    if _still(rate):
        return []
    if name != 'as it is':
        code = {'x, y, z, w': 'quaternion_order', 'world to body': 'quaternion_inverse'}
        return [Finding(
            code.get(name, 'quaternion_order_and_inverse'), 'error', 'qw, qx, qy, qz',
            f'attitude and gyro agree only if the columns are read as {name}',
            'write the quaternion body to world with the scalar first, or name its columns in a '
            'mapping in their order (q: [...], quaternion: xyzw; unit: "-1" reverses a sign)')]
    gyro = grid.smooth(grid.signal('wx', 'wy', 'wz'))[grid.good]
    other = correlation(body_vector(rate, 'FRD'), gyro)[0]
    if other >= SURE and other >= correlation(rate, gyro)[0] + BETTER:
        return [Finding('frame_rate', 'error', 'wx, wy, wz',
                        'attitude and gyro disagree in the sign of y and z: one of them is in '
                        'FRD', 'turn y and z of the one in FRD')]
    return [Finding('frame_sign', 'error', f'w{axis}',
                    f'the gyro has the opposite sign to the rotation of the attitude about {axis}',
                    f'reverse the sign of w{axis}, or turn the attitude to FLU; in a mapping of a '
                    'table unit: -rad/s or -deg reverses that of a column')
            for axis in _opposed(rate, gyro)]


def rate_in_world(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find rates about the axes of the world: turned back by the attitude they are the body's."""
    grid = Grid.of(record)
    if grid is None or not record.has(*QUATERNION, 'wx', 'wy', 'wz'):
        return []
    name, attitude = best_reading(record)
    if attitude is None or name != 'as it is':
        return []
    rate, gyro = grid.rate_of(attitude)[grid.good], grid.signal('wx', 'wy', 'wz')
    if _still(rate) or not is_rather(
            rate, grid.smooth(gyro)[grid.good],
            grid.smooth(rotate(conjugate(attitude), gyro))[grid.good], WIDTH / grid.period):
        return []
    return [Finding('rate_in_world', 'error', 'wx, wy, wz',
                    'attitude and rate agree only if the rate is rotated back by the attitude: it '
                    'is about the axes of the world, not of the body',
                    'publish the twist in body axes (base_link), or rotate the rates by the '
                    'inverse of the attitude')]


@once
def _force_is_of_world(record: FlightRecord) -> bool:
    """
    Return whether the specific force of a record is along the axes of the world.

    As it is, it then is how the velocity changes, less gravity, and turned by the attitude it is
    not. Without velocity and position, the thrust tells, which is along z of the body: turned
    back by the attitude the force is, too. Drag cannot look so, for it pushes a body that leans
    to the other side. A vehicle that hardly leans and turns shows less of it than of noise.
    """
    grid = Grid.of(record)
    if grid is None or not record.has('ax', 'ay', 'az'):
        return False
    name, attitude = best_reading(record)
    if attitude is None or name != 'as it is':
        return False
    force, together = grid.signal('ax', 'ay', 'az'), WIDTH / grid.period
    if record.has('vx', 'vy', 'vz'):
        speeding = grid.derivative(grid.signal('vx', 'vy', 'vz'))
    elif record.has('px', 'py', 'pz'):
        speeding = grid.derivative(grid.derivative(grid.signal('px', 'py', 'pz')))
    else:
        along, back = (_about_mean(grid.smooth(values)[grid.good, :2])
                       for values in (force, rotate(conjugate(attitude), force)))
        return (bool(np.sqrt(np.mean((back - along) ** 2)) > LEVEL)
                and is_rather(np.zeros_like(along), along, back, together))
    needed = speeding[grid.good] + np.array([0.0, 0.0, GRAVITY])
    given, turned = (grid.smooth(values)[grid.good]
                     for values in (force, rotate(attitude, force)))
    # An attitude of another heading misses it as well: then the force is not that either.
    sure, slope = correlation(_about_mean(needed[:, :2]), _about_mean(given[:, :2]))
    return (sure > SURE and abs(np.log(slope)) < np.log(LIKE_SIZE)
            and is_rather(needed, turned, given, together))


def _about_mean(values: np.ndarray) -> np.ndarray:
    return values - values.mean(axis=0)


def force_in_world(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find specific forces along the axes of the world: they need no turn by the attitude."""
    if not _force_is_of_world(record):
        return []
    return [Finding('force_in_world', 'error', 'ax, ay, az',
                    'the specific force is what the vehicle does only if it is not rotated by the '
                    'attitude: it is along the axes of the world, not of the body',
                    'give what the accelerometer measures, along the axes of the body, or rotate '
                    'ax, ay and az by the inverse of the attitude')]


def _opposed(one: np.ndarray, other: np.ndarray) -> list[str]:
    """Return the axes, of x, y and z, along which signals (N, k) have opposite signs."""
    return [axis for k, axis in zip(range(one.shape[1]), 'xyz', strict=False)
            if correlation(one[:, k:k + 1], other[:, k:k + 1])[0] < -SURE]


@once
def world(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find records in NED or FRD: the specific force points up in flight."""
    grid = Grid.of(record)
    if grid is None:
        return []
    _, attitude = best_reading(record)
    if attitude is None:
        return _height(record)
    if not record.has('ax', 'ay', 'az'):
        return _motion(grid, attitude)
    force = grid.force()
    size = np.median(np.linalg.norm(force, axis=1))
    body_up = np.median(force[:, 2]) / size if size > 0 else 1.0
    world_up = np.median(rotate(attitude, force)[:, 2]) / size if size > 0 else 1.0
    frd, ned = bool(body_up < -0.5), bool(world_up < -0.5)
    if not frd and not ned and _force_is_of_world(record):
        return []       # what the force says of velocity and heading is then wrong
    if frd or ned:
        what = ' and '.join(['the body axes are FRD'] * frd + ['the world axes are NED'] * ned)
        return [Finding('frame_ned' if ned else 'frame_frd', 'error',
                        'position, velocity, attitude, rate, specific force',
                        f'the specific force points down in flight: {what}',
                        TURN)]
    return _motion(grid, attitude)


def axis_up(record: FlightRecord) -> tuple[str, float, float]:
    """
    Return which axis points up in the world and in the body alike, z or y, or '' if that is open.

    Behind it the correlations of the lean with the force, with z up and with y up: the thrust is
    along the up axis of the body, so what that leans by is how the position bends.
    """
    grid, attitude = Grid.of(record), best_reading(record)[1]
    if grid is None or attitude is None or not record.has('px', 'py', 'pz'):
        return '', 0.0, 0.0
    bend = grid.derivative(grid.derivative(grid.signal('px', 'py', 'pz')))
    alike, fits = [], []
    for up in ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]):
        level = np.flatnonzero(np.array(up) == 0.0)
        force = bend + GRAVITY * np.array(up)
        force /= np.linalg.norm(force, axis=1, keepdims=True)
        lean = rotate(attitude, np.tile(up, (len(grid.t), 1)))
        one, other = (grid.smooth(values[:, level], LEAN_OVER)[grid.good]
                      for values in (lean, force))
        likeness, size = correlation(one - one.mean(axis=0), other - other.mean(axis=0))
        alike.append(likeness)
        # On a wide circle, nose first, the y axis of the body is along the force, too, but level.
        fits.append(likeness > LEANS and float(np.median(lean @ up)) > STANDS
                    and LEAN_SIZE[0] < size < LEAN_SIZE[1])
    for k, axis in enumerate('zy'):
        if fits[k] and alike[1 - k] < UPRIGHT:
            return axis, alike[0], alike[1]
    return '', alike[0], alike[1]


def y_up(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find a world whose y axis is up, with a body whose own y is up, as motion capture has."""
    up, with_z, with_y = axis_up(record)
    if up != 'y':
        return []
    return [Finding(
        'frame_y_up', 'error', 'position and attitude',
        'the vehicle leans into the way that it goes only where y is the axis that points up '
        f'(correlation {with_y:.2f}, with z up {with_z:.2f})',
        'export it with z up, or name the columns in a mapping: py and qy the z of the file with '
        'the other sign (unit: -m or -mm; "-1"), pz and qz its y; likewise a velocity')]


def _motion(grid: Grid, attitude: np.ndarray) -> list[Finding]:
    """Find velocities whose changes contradict attitude and specific force."""
    if not grid.record.has('vx', 'vy', 'vz'):
        return _height(grid.record)
    speeding = grid.derivative(grid.signal('vx', 'vy', 'vz'))[grid.good]
    force = grid.acceleration(attitude)[grid.good]
    if not grid.record.has('ax', 'ay', 'az'):
        # The thrust is then only known to lie along z of the body: its tilt decides.
        speeding, force = speeding[:, :2], force[:, :2]
    sure = correlation(speeding, force)[0]
    turned = [Finding('frame_sign', 'error', f'p{axis}, v{axis}',
                      f'tilt and thrust push the vehicle along {axis} against the direction in '
                      'which its velocity changes',
                      f'reverse the sign of p{axis} and v{axis}, or turn the attitude')
              for axis in _opposed(speeding, force)]
    if sure > SURE:     # a height below zero is then no more than another origin
        return turned or _heading(speeding, force) if grid.record.has('ax', 'ay', 'az') else []
    heading = _heading(speeding, force)
    if sure < -SURE and not (heading and grid.record.has('ax', 'ay', 'az')):
        return [Finding('frame_ned', 'error', 'position, velocity, attitude, rate',
                        'the thrust pushes down: the world axes are NED and those of the body FRD',
                        'turn the world into ENU (x east, y north, z up) and the body into FLU')]
    if heading:
        return heading
    swapped = speeding[:, [1, 0]] if speeding.shape[1] == 2 else world_vector(speeding, 'NED')
    if correlation(swapped, force)[0] < max(SURE, sure + BETTER):
        return turned or _height(grid.record)
    return [Finding('frame_ned', 'error', 'position, velocity',
                    'velocity and specific force agree only if the velocity is read as NED',
                    'turn position and velocity into ENU (x east, y north, z up)')]


def _heading(speeding: np.ndarray, force: np.ndarray) -> list[Finding]:
    """Find attitudes whose heading counts from another direction than position and velocity."""
    made, given = (one[:, 0] + 1j * one[:, 1] for one in (speeding, force))
    size = np.sqrt(np.sum(np.abs(made) ** 2) * np.sum(np.abs(given) ** 2))
    turn, mirrored = np.sum(made * np.conj(given)), abs(np.sum(made * given))
    angle = np.angle(turn)
    measured = speeding.shape[1] == 3
    low, high = HEADING if measured else DRAGGED
    least = CLEAR if measured and abs(angle) < high else SURE
    if not (abs(turn) > least * size and abs(turn) > mirrored + BETTER * size
            and abs(angle) > low):
        return []
    return [Finding('heading', 'error' if abs(angle) > high else 'warning',
                    'position, velocity, attitude',
                    'velocity and thrust agree only if the attitude is turned about z of the '
                    f'world by {np.degrees(angle):.0f} deg: its heading is not measured from '
                    'the x axis of the position',
                    'take position and attitude from one source, or turn the attitude by this; '
                    'a diagnosis estimates what remains (attitude_misalignment, form heading)')]


def _height(record: FlightRecord) -> list[Finding]:
    if not record.has('pz'):
        return []
    height = float(np.median(record.columns['pz']))
    if height > -0.3:
        return []
    return [Finding('frame_ned', 'warning', 'pz',
                    f'the median height is {height:.2f} m: below ground, or z points down',
                    'turn NED into ENU, or measure pz from the ground')]


def signs(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find axes along which position and velocity have opposite signs."""
    grid = Grid.of(record)
    if grid is None or not record.has('px', 'py', 'pz', 'vx', 'vy', 'vz'):
        return []
    moved = grid.derivative(grid.signal('px', 'py', 'pz'))[grid.good]
    velocity = grid.smooth(grid.signal('vx', 'vy', 'vz'))[grid.good]
    return [Finding('frame_sign', 'error', f'p{axis}, v{axis}',
                    f'the position along {axis} decreases while the velocity is positive: one of '
                    'them has the wrong sign', 'turn both into ENU (x east, y north, z up)')
            for axis in _opposed(moved, velocity)]


def velocity_in_body(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find velocities in body axes: turned by the attitude they are what the position does."""
    grid = Grid.of(record)
    if grid is None or not record.has('px', 'py', 'pz', 'vx', 'vy', 'vz'):
        return []
    _, attitude = best_reading(record)
    if attitude is None:
        return []
    moved = grid.derivative(grid.signal('px', 'py', 'pz'))[grid.good]
    velocity = grid.signal('vx', 'vy', 'vz')
    as_it_is, to_world, to_body = (grid.smooth(values)[grid.good] for values in (
        velocity, rotate(attitude, velocity), rotate(conjugate(attitude), velocity)))
    missed, turned, back = (1.0 - explained(moved, values)
                            for values in (as_it_is, to_world, to_body))
    in_world = missed >= TURNED and back <= 0.1 and back <= 0.25 * min(missed, turned)
    if in_world or is_rather(moved, as_it_is, to_body, WIDTH / grid.period):
        return [Finding('velocity_in_world', 'error', 'vx, vy, vz',
                        'position and velocity agree only if the velocity is rotated back by the '
                        'attitude: it was read as one in body axes, and is one in world axes',
                        'publish the twist in body axes (base_link), or say frame: world of the '
                        'velocity in a mapping')]
    if missed < TURNED or turned > 0.1 or turned > 0.25 * missed:
        return _strangers(moved, as_it_is)
    return [Finding('velocity_in_body', 'error', 'vx, vy, vz',
                    'position and velocity agree only if the velocity is rotated by the attitude: '
                    'it is in body axes',
                    'rotate the velocity into the world, or say frame: body of it in a mapping')]


def _strangers(moved: np.ndarray, velocity: np.ndarray) -> list[Finding]:
    """Find a position and a velocity (N, 3) that do not belong together."""
    alike = correlation(moved, velocity)[0]
    fast = min(np.sqrt(np.mean(np.sum(values ** 2, axis=1))) for values in (moved, velocity))
    if alike > STRANGE or fast < SLOW:
        return []
    return [Finding('velocity_other', 'warning', 'vx, vy, vz',
                    'position and velocity do not agree (correlation '
                    f'{alike:.2f}): they belong to different frames, clocks or vehicles',
                    'say frame: world or body of the velocity in a mapping, or leave it out')]


CHECKS = (y_up, quaternion, world, velocity_in_body, rate_in_world,
          force_in_world, signs)
