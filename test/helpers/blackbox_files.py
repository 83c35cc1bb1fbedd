# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Blackbox logs of Betaflight that tests make themselves."""

import numpy as np

FIELDS = ('loopIteration', 'time', 'axisI[0]', 'axisI[1]', 'axisI[2]', 'rcCommand[0]',
          'rcCommand[1]', 'rcCommand[2]', 'rcCommand[3]', 'vbatLatest', 'amperageLatest', 'rssi',
          'gyroADC[0]', 'gyroADC[1]', 'gyroADC[2]', 'accSmooth[0]', 'accSmooth[1]',
          'accSmooth[2]', 'imuQuaternion[0]', 'imuQuaternion[1]', 'imuQuaternion[2]', 'motor[0]',
          'motor[1]', 'motor[2]', 'motor[3]', 'eRPM[0]', 'eRPM[1]', 'eRPM[2]', 'eRPM[3]')
_FREE = 9 * (0,)    # gyroADC, accSmooth, imuQuaternion
INTRA = {'predictor': (0, 0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, *_FREE, 11, 5, 5, 5, 0, 0, 0, 0),
         'encoding': (1, 1, 0, 0, 0, 0, 0, 0, 1, 3, 0, 1, *_FREE, 1, 0, 0, 0, 1, 1, 1, 1)}
INTER = {'predictor': (6, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, *(9 * (3,)), 3, 3, 3, 3, 1, 1, 1, 1),
         'encoding': (9, 0, 7, 7, 7, 8, 8, 8, 8, 6, 6, 6, *_FREE, 0, 0, 0, 0, 0, 0, 0, 0)}
VBATREF, LEAST, INTERVAL, KEY = 1600, 48, 2, 16
"""Headers vbatref and the first of motorOutput; loops between frames; frames between I frames."""

HEADERS = {'Firmware type': 'Betaflight',
           'Firmware revision': 'Betaflight 4.5.1 (77d01ba3b) STM32F7X2',
           'Craft name': 'Müller', 'I interval': INTERVAL * KEY, 'P interval': f'1/{INTERVAL}',
           'minthrottle': 1070, 'gyro_scale': '0x3f800000', 'motorOutput': f'{LEAST},2047',
           'acc_1G': 2048, 'vbatref': VBATREF, 'motor_poles': 14, 'blackbox_high_resolution': 0}


def blackbox(rows, ended=True, **headers):
    """Return the bytes of a log of rows (n, fields) of integers, with other headers added."""
    definitions = {'Field I name': FIELDS, 'Field I signed': [0] * len(FIELDS),
                   **{f'Field I {key}': value for key, value in INTRA.items()},
                   **{f'Field P {key}': value for key, value in INTER.items()},
                   'Field S name': ('flightModeFlags', 'stateFlags'), 'Field S signed': (0, 0),
                   'Field S predictor': (0, 0), 'Field S encoding': (1, 1)}
    lines = {'Product': 'Blackbox flight data recorder by Nicholas Sherlock', 'Data version': 2,
             **{key: ','.join(map(str, value)) for key, value in definitions.items()},
             **HEADERS, **{key.replace('_P_', 'P '): value for key, value in headers.items()}}
    data = ''.join(f'H {key}:{value}\n' for key, value in lines.items()).encode()
    last = older = None
    for k, row in enumerate(np.asarray(rows).tolist()):
        if k % KEY == 0:
            data += b'I' + _intra(row)
            last = older = row
        else:
            data += b'P' + _inter(row, last, older)
            last, older = row, last
        if k % (4 * KEY) == 3:
            data += b'S' + _unsigned(1) + _unsigned(300)
    return data + (b'E\xffEnd of log\0' if ended else b'')


def rows_of(record, motors, poles=14, start=7_000_000):
    """Return the rows of a record (FLU in ENU) at whole counts, and motors (N, 4) of outputs."""
    from quad_ident_ros.model.attitude import conjugate, product
    half = np.sqrt(0.5)
    q = product(conjugate([half, 0, 0, half]), record.stack('qw', 'qx', 'qy', 'qz'))
    q = q * np.where(q[:, :1] < 0, -1, 1)
    count = len(record)
    rpm = record.stack('cmd1', 'cmd2', 'cmd3', 'cmd4') * 30 / np.pi
    chance = np.random.default_rng(1)
    table = np.column_stack([
        INTERVAL * np.arange(count), start + np.round(record.t * 1e6),
        np.cumsum(chance.integers(-40, 40, (count, 3)), axis=0),
        np.cumsum(chance.integers(-300, 300, (count, 3)), axis=0), 1500 + 0 * record.t,
        record.columns['vbat'] * 100, 0 * record.t, 1000 + 0 * record.t,
        np.degrees(record.stack('wx', 'wy', 'wz')),
        record.stack('ax', 'ay', 'az') / 9.80665 * 2048, q[:, 1:] * 32767, motors,
        rpm * poles / 200])
    return np.round(table).astype(int)


def _unsigned(value):
    data = b''
    while value > 127:
        data += bytes([value & 127 | 128])
        value >>= 7
    return data + bytes([value])


def _signed(value):
    return _unsigned(value << 1 if value >= 0 else (-value << 1) - 1)


def _intra(row):
    data, motor = b'', row[FIELDS.index('motor[0]')]
    offset = {0: 0, 5: motor, 9: VBATREF, 11: LEAST}
    for value, predictor, encoding in zip(row, INTRA['predictor'], INTRA['encoding'], strict=True):
        value -= offset[predictor]
        data += {0: _signed, 1: _unsigned, 3: lambda v: _unsigned(-v & 0x3FFF)}[encoding](value)
    return data


def _inter(row, last, older):
    deltas = []
    for value, one, two, predictor in zip(row, last, older, INTER['predictor'], strict=True):
        deltas.append(value - {1: one, 2: 2 * one - two, 3: int((one + two) / 2),
                               6: one + INTERVAL}[predictor])
    assert deltas[0] == 0
    data, k = b'', 1
    while k < len(deltas):
        encoding = INTER['encoding'][k]
        count, write = {0: (1, lambda v: _signed(*v)), 6: (3, _group), 7: (3, _three),
                        8: (4, _four)}[encoding]
        data += write(deltas[k:k + count])
        k += count
    return data


def _group(values):
    """TAG8_8SVB of three fields: a bit for each that is not zero."""
    tag = sum(1 << k for k, value in enumerate(values) if value)
    return bytes([tag]) + b''.join(_signed(value) for value in values if value)


def _three(values):
    """TAG2_3S32: fields of 2, 4 or 6 bits, or of 8 to 24."""
    if all(-2 <= value < 2 for value in values):
        return bytes([values[0] % 4 << 4 | values[1] % 4 << 2 | values[2] % 4])
    if all(-8 <= value < 8 for value in values):
        return bytes([0x40 | values[0] % 16, values[1] % 16 << 4 | values[2] % 16])
    if all(-32 <= value < 32 for value in values):
        return bytes([0x80 | values[0] % 64, values[1] % 64, values[2] % 64])
    sizes = [next(size for size in (1, 2, 3) if -1 << 8 * size - 1 <= value < 1 << 8 * size - 1)
             for value in values]
    tag = 0xC0 | sum(size - 1 << 2 * k for k, size in enumerate(sizes))
    return bytes([tag]) + b''.join((value % (1 << 8 * size)).to_bytes(size, 'little')
                                   for value, size in zip(values, sizes, strict=True))


def _four(values):
    """TAG8_4S16, version 2, of which zero, 8 and 16 bits are used."""
    kinds = [0 if value == 0 else 2 if -128 <= value < 128 else 3 for value in values]
    sizes = {0: 0, 2: 1, 3: 2}
    return bytes([sum(kind << 2 * k for k, kind in enumerate(kinds))]) + b''.join(
        (value % (1 << 8 * sizes[kind])).to_bytes(sizes[kind], 'big')
        for value, kind in zip(values, kinds, strict=True))
