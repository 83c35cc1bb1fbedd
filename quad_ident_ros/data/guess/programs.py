# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of programs whose names of columns mean something else than they say."""

from collections.abc import Iterable
from dataclasses import replace
import re

import numpy as np

from quad_ident_ros.data.betaflight import ORDER, QUAD_X
from quad_ident_ros.data.columns import FORCE, POSITION, RATE
from quad_ident_ros.data.guess.draft import Draft, together
from quad_ident_ros.data.guess.motion import HOVERS
from quad_ident_ros.data.guess.series import is_unit, unit_length
from quad_ident_ros.data.motor_order import about_motors
from quad_ident_ros.data.quality import frames
from quad_ident_ros.data.record import faulty, FlightRecord, QUATERNION

_CRAZYFLIE = re.compile(r'motor_m[1-4]$|state_estimate_|stabilizer_|kalman_|pm_vbat$')
RAW, ONE_G = 'g/2048', 2048.0   # of accelerometers of 16 bits over +-16 g, as Betaflight sets them


def vicon(draft: Draft) -> None:
    """
    Take the rotation in a table of Vicon's Tracker where it is a quaternion, RX, RY, RZ, RW.

    RX, RY, RZ alone are angles or a rotation vector, as the program is set, which no name shows.
    Source: Vicon Tracker, export of objects as CSV.
    """
    columns = {plain: name for name, plain in draft.names.items()}
    names = [columns.get(f'r{letter}', '') for letter in 'wxyz']
    if not {'tx', 'ty', 'tz'} <= set(columns) or '' in names[1:]:
        return
    if names[0]:
        q = draft.values(names)
        if is_unit(q):
            draft.take(QUATERNION, names, role='pose', said='attitude')
            draft.attitude = unit_length(q)
        return
    draft.guess.doubts.append(
        f'attitude: whether {together(names[1:])} are angles or a rotation vector; export the '
        'rotation as a quaternion, which has RW beside them')


def qualisys(draft: Draft) -> None:
    """
    Doubt the angles in a table of Qualisys, and name its position, which has the body's before X.

    They are turns about x, then the new y, then the new z, or as the program is set.
    Source: Qualisys Track Manager, export of bodies as TSV, rotation angles in QTM.
    """
    columns = {plain: name for name, plain in draft.names.items()}
    angles = [columns.get(name, '') for name in ('roll', 'pitch', 'yaw')]
    if 'residual' not in columns or '' in angles:
        return
    order = list(draft.names)
    before = order[order.index(columns['y']) - 1] if {'y', 'z'} <= set(columns) else ''
    if before and draft.names[before].endswith('_x'):
        draft.names[before] = 'x'
    draft.taken(angles, '')
    if not {f'q{letter}' for letter in 'wxyz'} <= set(columns):
        draft.guess.doubts.append(
            f'attitude: {together(angles)} of Qualisys are turns about x, y and z in this order, '
            'not yaw, pitch and roll, or as QTM is set; add columns qw, qx, qy, qz, of the '
            'rotation matrix Rot[0] to Rot[8]')


def motive(draft: Draft) -> None:
    """
    Turn the pose in a table of Motive where the vehicle leans as with y up, or leave it in doubt.

    The world and the bodies have y up unless the program is set otherwise, which no line shows.
    """
    if not draft.table.doubts:
        return
    up = _axis_up(draft)
    if not up:
        draft.guess.doubts += draft.table.doubts
        return
    draft.guess.said.append(f'{up} is up, by how the vehicle leans')
    if up == 'y':
        found, q = draft.columns, draft.attitude
        found['py'], found['pz'] = (replace(found['pz'], unit=f'-{found["pz"].unit or "m"}'),
                                    found['py'])
        found['qy'], found['qz'] = replace(found['qz'], unit='-1'), found['qy']
        assert q is not None    # else no axis is known to be up
        draft.attitude = np.column_stack([q[:, 0], q[:, 1], -q[:, 3], q[:, 2]])


def _axis_up(draft: Draft) -> str:
    """Return the axis, y or z, by which the pose leans as what flies does, '' in doubt."""
    if draft.t is None or draft.attitude is None or not {*POSITION, *QUATERNION} <= set(
            draft.columns):
        return ''
    there = [draft.columns[name].names[0] for name in (*POSITION, *QUATERNION)]
    seen = np.isfinite(draft.logged(there)).all(axis=1)
    columns = dict(zip((*POSITION, *QUATERNION), np.hstack(
        [draft.scaled(POSITION), draft.attitude])[seen].T, strict=True))
    t = draft.t[seen]
    good = ~faulty(t, columns)
    if good.sum() < 2:
        return ''
    return frames.axis_up(FlightRecord(t[good], {
        name: values[good] for name, values in columns.items()}, {}))[0]


def crazyflie(draft: Draft) -> None:
    """
    Name log variables of a Crazyflie by what they are, in their units.

    The state of its Kalman filter has the velocity in body axes as PX, PY, PZ; stateEstimateZ has
    mm, mm/s and mrad/s, the pitch rate with the other sign; its gyro is in deg/s where its
    accelerometer is in g. Source: log variables in Bitcraze's documentation.
    """
    columns = {plain: name for name, plain in draft.names.items()}

    def group(pattern: str, axes: Iterable[str] = 'xyz') -> list[str]:
        names = [columns.get(pattern.format(axis), '') for axis in axes]
        return names if all(name in draft.free for name in names) else []

    for pattern, meant in (('kalman_state_p{}', 'body_velocity_{}'),
                           ('kalman_state_{}', 'kalman_position_{}')):
        for axis, name in zip('xyz', group(pattern), strict=False):
            draft.names[name] = meant.format(axis)
    whole = {'': 'mm', 'v': 'mm/s'}
    for before, unit in whole.items():
        for axis, name in zip('xyz', group(f'state_estimate_z_{before}{{}}'), strict=False):
            if f'state_estimate_{before}{axis}' in columns:
                draft.taken([name], '')
            draft.names[name], draft.units[name] = f'state_estimate_{before}{axis}', unit
    gyro, force = group('gyro_{}'), group('acc_{}')
    turning = group('state_estimate_z_rate_{}', ('roll', 'pitch', 'yaw'))
    if turning and not gyro:
        draft.take(RATE, turning, 'mrad/s', role='rate', said='body rate in mrad/s, pitch with '
                   'the other sign')
        draft.columns['wy'] = replace(draft.columns['wy'], unit='-mrad/s')
    if gyro and force and any(map(_CRAZYFLIE.match, columns)):
        usual = float(np.nanmedian(np.linalg.norm(draft.values(force), axis=1)))
        if HOVERS[0] < usual < HOVERS[1] and not any(draft.units[name] for name in gyro):
            draft.units.update(dict.fromkeys(gyro, 'deg/s'))


def blackbox_decode(draft: Draft) -> None:
    """
    Take the columns of a CSV that blackbox_decode makes of a log of Betaflight.

    It writes gyro and accelerometer as they are in the log unless given a unit, and leaves
    out the header, which has the scales and the number of poles of the motors.
    Source: blackbox_decode.c of Betaflight's blackbox-tools.
    """
    columns = {plain: name for name, plain in draft.names.items()}
    if not {'loop_iteration', 'time'} <= set(columns):
        return

    def group(name: str, count: int) -> list[str]:
        names = [columns.get(f'{name}_{k}', '') for k in range(count)]
        return names if all(one in draft.free for one in names) else []

    if gyro := group('gyro_adc', 3):
        unit = draft.unit_of(gyro, ('rad/s', 'deg/s')) or 'deg/s'
        draft.take(RATE, gyro, unit, role='rate', said=f'body rate in {unit}, by blackbox_decode')
    if accelerometer := group('acc_smooth', 3):
        unit = draft.unit_of(accelerometer, ('m/s^2', 'g'))
        usual = float(np.nanmedian(np.linalg.norm(draft.values(accelerometer), axis=1)))
        if not unit and HOVERS[0] * ONE_G < usual < HOVERS[1] * ONE_G:
            unit = RAW
        if unit:
            draft.take(FORCE, accelerometer, unit, role='specific_force',
                       said=f'specific force in {unit}, by blackbox_decode')
    reckoned = [columns[name] for name in ('roll', 'pitch', 'heading') if name in columns]
    electrical = [name for plain, name in columns.items() if plain.startswith('e_rpm_')]
    for names, why in ((reckoned, 'reckoned by blackbox_decode'),
                       (electrical, 'hundreds of electrical turns a minute, of motors whose poles '
                        'the table does not have')):
        if names:
            draft.taken(names, '')
            draft.guess.said.append(f'{names[0]} to {names[-1]}: not taken, {why}')
    if group('motor', 4) and not group('motor', 5):
        draft.guess.motors = about_motors(QUAD_X, "Betaflight's order, quad X")
        draft.guess.said.append(ORDER)
