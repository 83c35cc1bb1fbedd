# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables as other programs write them."""

import gzip

import numpy as np

PLACE, SPEED = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
Q, RATE, FORCE = ('qw', 'qx', 'qy', 'qz'), ('wx', 'wy', 'wz'), ('ax', 'ay', 'az')


def table(folder, columns, name='flight.csv', separator=',', comma=False, above=''):
    """Write a table of (N,) columns and return its path."""
    rows = [separator.join(columns)]
    for values in zip(*columns.values(), strict=True):
        cells = ['' if np.isnan(value) else repr(float(value)) for value in values]
        rows.append(separator.join(cell.replace('.', ',') if comma else cell for cell in cells))
    text = (above + '\n'.join(rows) + '\n').encode()
    path = folder / name
    path.write_bytes(gzip.compress(text) if name.endswith('.gz') else text)
    return path


def named(names, values):
    """Return columns of names and values (N, k)."""
    return dict(zip(names, np.asarray(values).T, strict=True))


def others(record):
    """Return the columns of a record as other programs name them."""
    return {'timestamp': np.round(1e6 * record.t + 5e6),
            **named(('pos_x', 'pos_y', 'pos_z'), record.stack(*PLACE)),
            **named(('vel_x', 'vel_y', 'vel_z'), record.stack(*SPEED)),
            **named(('q_w', 'q_x', 'q_y', 'q_z'), record.stack(*Q)),
            **named(('gyro_x', 'gyro_y', 'gyro_z'), record.stack(*RATE)),
            **named(('acc_x', 'acc_y', 'acc_z'), record.stack(*FORCE)),
            **{f'm{k}': 1000 + record.columns[f'cmd{k}'] / 2 for k in range(1, 5)},
            'vbat': record.columns['vbat']}


def motive(folder, t, bodies, unit='Meters', markers=0):
    """
    Write a take as Motive exports it, and return its path.

    Args: t (N,) s; bodies: name -> (quaternions, scalar last (N, 4), places (N, 3)) as they are
    exported; unit: of lengths; markers: how many each body has.
    """
    heads = {'Type': [], 'Name': [], 'ID': [], '': []}
    axes, values = [], [np.arange(len(t)), t]
    for number, (name, (turns, place)) in enumerate(bodies.items(), 1):
        whose = [('Rigid Body', name, str(number), 'Rotation')] * 4
        whose += [('Rigid Body', name, str(number), 'Position')] * 3
        axes += 'XYZWXYZ'
        values += [*turns.T, *place.T]
        for k in range(1, markers + 1):
            whose += [('Rigid Body Marker', f'{name}:Marker{k}', f'{number}:{k}', 'Position')] * 3
            axes += 'XYZ'
            values += [*(place + k).T]
        for head, cells in zip(heads.values(), zip(*whose, strict=True), strict=True):
            head += cells
    rows = [f'Format Version,1.23,Take Name,one,Length Units,{unit},Coordinate Space,Global', '']
    rows += [f',{head},{",".join(cells)}' for head, cells in heads.items()]
    rows += [f'Frame,Time (Seconds),{",".join(axes)}']
    rows += [','.join(map(repr, row)) for row in np.column_stack(values).tolist()]
    path = folder / 'take.csv'
    path.write_text('\n'.join(rows) + '\n')
    return path
