# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""DataFlash logs of ArduPilot that tests make themselves."""

import struct

import numpy as np

from quad_ident_ros.data import frames
from quad_ident_ros.model.attitude import euler_from_quaternion

CODES = {'b': 'b', 'B': 'B', 'h': 'h', 'H': 'H', 'i': 'i', 'I': 'I', 'f': 'f', 'd': 'd',
         'n': '4s', 'N': '16s', 'Z': '64s', 'c': 'h', 'C': 'H', 'e': 'i', 'E': 'I', 'L': 'i',
         'M': 'b', 'q': 'q', 'Q': 'Q', 'a': '64s', 'g': 'e'}
FACTORS = {'c': 100.0, 'C': 100.0, 'e': 100.0, 'E': 100.0, 'L': 1e7}
TYPES = {
    'PARM': (64, 'QNf', 'TimeUS,Name,Value'),
    'MSG': (65, 'QZ', 'TimeUS,Message'),
    'ATT': (66, 'QccccCC', 'TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw'),
    'XKQ': (67, 'QBffff', 'TimeUS,C,Q1,Q2,Q3,Q4'),
    'XKF1': (68, 'QBccCfffffff', 'TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD'),
    'IMU': (69, 'QBffffff', 'TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ'),
    'RCOU': (70, 'QHHHHHHHH', 'TimeUS,C1,C2,C3,C4,C5,C6,C7,C8'),
    'ESC': (71, 'QBff', 'TimeUS,Instance,RPM,RawRPM'),
    'BAT': (72, 'QBff', 'TimeUS,Inst,Volt,Curr'),
    'GPS': (73, 'QBBIHLLefff', 'TimeUS,I,Status,GMS,GWk,Lat,Lng,Alt,Spd,GCrs,VZ'),
    'POS': (74, 'QLLfff', 'TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt'),
    'RATE': (75, 'Qffffff', 'TimeUS,RDes,R,PDes,P,YDes,Y'),
}


def dataflash(messages, types=TYPES):
    """Return the bytes of a log of messages (type, values), preceded by its definitions."""
    data = _definition(128, 89, 'FMT', 'BBnNZ', 'Type,Length,Name,Format,Columns')
    for name, (number, letters, fields) in types.items():
        size = struct.calcsize('<' + ''.join(CODES[letter] for letter in letters))
        data += _definition(number, 3 + size, name, letters, fields)
    rows = []
    for name, values in messages:
        number, letters, _ = types[name]
        cast = [value.encode() if isinstance(value, str) else float(value) if letter in 'fdg'
                else round(float(value) * FACTORS.get(letter, 1))
                for letter, value in zip(letters, values, strict=True)]
        rows.append(struct.pack('<BBB' + ''.join(CODES[letter] for letter in letters), 0xA3, 0x95,
                                number, *cast))
    return data + b''.join(rows)


def _definition(number, size, name, letters, fields):
    return struct.pack('<BBBBB4s16s64s', 0xA3, 0x95, 128, number, size, name.encode(),
                       letters.encode(), fields.encode())


def copter(record, pwm, channels=(1, 2, 3, 4), start=2.0, frame=(1, 1),
           banner='ArduCopter V4.5.7 (2a3dc4b7)'):
    """
    Return the messages (type, values) of a flight of ArduCopter in NED and FRD, by their stamps.

    Args: record (FLU in ENU); pwm (N, n) us of the motors; channels: the output of each motor.
    """
    t = np.round((start + record.t) * 1e6).astype(np.int64)
    q = frames.attitude(record.stack('qw', 'qx', 'qy', 'qz'), 'NED', 'FRD')
    angles = np.degrees(euler_from_quaternion(q))
    place = frames.world_vector(record.stack('px', 'py', 'pz'), 'NED')
    speed = frames.world_vector(record.stack('vx', 'vy', 'vz'), 'NED')
    rate = frames.body_vector(record.stack('wx', 'wy', 'wz'), 'FRD')
    force = frames.body_vector(record.stack('ax', 'ay', 'az'), 'FRD')
    rpm = record.stack(*(f'cmd{k + 1}' for k in range(pwm.shape[1]))) * 30 / np.pi
    outputs = np.zeros((len(record), 8))
    outputs[:, [channel - 1 for channel in channels]] = pwm
    parameters = {'FRAME_CLASS': frame[0], 'FRAME_TYPE': frame[1], 'MOT_PWM_MIN': 1000,
                  'MOT_THST_EXPO': 0.65, 'SERVO9_FUNCTION': 51,
                  **{f'SERVO{channel}_FUNCTION': 33 + k for k, channel in enumerate(channels)}}
    messages = [('PARM', (t[0] - 1000, name, value)) for name, value in parameters.items()]
    messages.append(('MSG', (t[0] - 900, banner)))
    for k, stamp in enumerate(t):
        messages += [
            ('IMU', (stamp, 0, *rate[k], *force[k])),
            ('IMU', (stamp, 1, *(rate[k] + 0.5), *force[k])),
            ('XKQ', (stamp, 0, *q[k])), ('XKQ', (stamp, 1, 1, 0, 0, 0)),
            ('XKF1', (stamp, 0, *angles[k][:2], angles[k][2] % 360, *speed[k], 0, *place[k])),
            ('XKF1', (stamp, 1, 0, 0, 0, 0, 0, 0, 0, 9, 9, 9)),
            ('ATT', (stamp, 0, angles[k][0], 0, angles[k][1], 0, angles[k][2] % 360)),
            ('RCOU', (stamp, *outputs[k])),
            *(('ESC', (stamp, channels[m] - 1, rpm[k, m], 0)) for m in range(pwm.shape[1])),
            *([('BAT', (stamp, 0, record.columns['vbat'][k], 1.0))] if k % 10 == 0 else []),
        ]
    return messages
