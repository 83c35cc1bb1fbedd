# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Micro-SD logs of a Crazyflie that tests make themselves."""

import struct
from zlib import crc32

STAMP = {1: ('<HI', 1e3), 2: ('<HQ', 1e6)}


def usdlog(events, version=2, checksum=True, claims=None):
    """
    Return the bytes of a log.

    Args: events list of (id, name, (variable with type, ...), t (n,) s, rows (n, k)); rows are
    written in the order of their stamps; claims: the number of kinds of events that the header
    tells, by default that of events.
    """
    count = len(events) if claims is None else claims
    data = struct.pack('<BHH', 0xBC, version, count)
    for number, name, variables, _, _ in events:
        data += struct.pack('<H', number) + name.encode() + b'\0'
        data += struct.pack('<H', len(variables))
        data += b''.join(variable.encode() + b'\0' for variable in variables)
    layout, per_second = STAMP[version]
    rows = []
    for number, _, variables, t, values in events:
        kinds = ''.join(variable[-2] for variable in variables)
        for stamp, row in zip(t, values, strict=True):
            cast = [float(value) if kind in 'efd' else round(value)
                    for kind, value in zip(kinds, row, strict=True)]
            rows.append((stamp, struct.pack(layout, number, round(stamp * per_second))
                         + struct.pack('<' + kinds, *cast)))
    data += b''.join(row for _, row in sorted(rows, key=lambda row: row[0]))
    return data + struct.pack('<I', crc32(data)) if checksum else data


def crazyflie_events(record, motors, start=3.0):
    """Return the events of a record (FLU in ENU) and its motors (n, 4): IMU, state, battery."""
    import numpy as np
    columns = record.columns
    t = start + record.t
    degrees = np.degrees(record.stack('wx', 'wy', 'wz'))
    force = record.stack('ax', 'ay', 'az') / 9.80665
    fixed = ('acc.x(f)', 'acc.y(f)', 'acc.z(f)', 'gyro.x(f)', 'gyro.y(f)', 'gyro.z(f)',
             'motor.m1(H)', 'motor.m2(H)', 'motor.m3(H)', 'motor.m4(I)')
    state = tuple(f'stateEstimate.{name}(f)' for name in
                  ('x', 'y', 'z', 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz'))
    slow = slice(None, None, 20)
    return [
        (0xFFFF, 'fixedFrequency', fixed, t, np.hstack([force, degrees, motors])),
        (3, 'estimate', state, t, record.stack('px', 'py', 'pz', 'vx', 'vy', 'vz', 'qw', 'qx',
                                               'qy', 'qz')),
        (7, 'battery', ('pm.vbat(e)', 'pm.state(b)'), t[slow],
         np.stack([columns['vbat'][slow], 0 * t[slow]], axis=-1)),
        (8, 'landed', (), t[-1:], np.zeros((1, 0))),
    ]


def packed(quaternion):
    """Return attitudes (n, 4), scalar first, as the numbers (n,) that a Crazyflie logs."""
    found = []
    for w, x, y, z in quaternion:
        values = [x, y, z, w]
        largest = max(range(4), key=lambda k: abs(values[k]))
        turned = values[largest] < 0
        bits = f'{largest:02b}'
        for k, value in enumerate(values):
            if k != largest:
                size = int(511 * abs(value) * 2 ** 0.5 + 0.5)
                bits += f'{int((value < 0) != turned)}{size:09b}'
        found.append(int(bits, 2))
    return found
