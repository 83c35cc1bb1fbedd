# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The writer: a flight record as CSV or as a bag that any ROS 2 tool can show."""

from collections.abc import Callable, Sequence
import os
from pathlib import Path
import shutil
from typing import Any

import numpy as np

from quad_ident_ros.data.bag import BagWriter, serialize
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.record import EULER, FlightRecord, INPUTS, MOMENTS, QUATERNION
from quad_ident_ros.data.table import record_table
from quad_ident_ros.data.topics import arm_of, ARRAY_TYPE, EXACT_TOPIC, FLIGHT_TOPICS
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import conjugate, rotate

VECTOR = 'geometry_msgs/msg/Vector3Stamped'


def save(path: str | Path, record: FlightRecord, on_progress: Callable[[float], None] | None = None
         ) -> None:
    """
    Write a flight record to .csv, .csv.gz, .mcap, or a new rosbag2 folder (no ending).

    Every number reads back as it was, or nothing is left where it fails or is interrupted.
    on_progress is called with the share that is written.
    Raises InputError for another ending or an existing folder, OSError where the disk
    refuses.
    """
    path = Path(path)
    if path.name.endswith(('.csv', '.csv.gz')):
        write_csv(path, record)
    elif path.suffix == '.mcap':
        folder = path.with_name(f'.{path.name}.{os.getpid()}.tmp')
        try:
            write_bag(folder, record, on_progress)
            os.replace(next(folder.glob('*.mcap')), path)
        except OSError as error:
            error.filename, error.filename2 = str(path), None   # the one that was asked for
            raise
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    elif not path.suffix:
        write_bag(path, record, on_progress)
    else:
        raise InputError(f'{path}: flights are written as .csv, .csv.gz, .mcap or, without an '
                         'ending, as the folder of a bag; name one of these')


def write_bag(path: str | Path, record: FlightRecord,
              on_progress: Callable[[float], None] | None = None) -> None:
    """Write a flight record to a new rosbag2 folder; arguments and errors of save."""
    start = int(record.info.get('start_ns', 0))
    shift = (record.t - record.t[0]) * 1e9
    if start < 0 or not start + shift[-1] < 2.0 ** 63:
        raise InputError(f'{path}: times of {record.t[-1]:g} s after {start} ns do not fit into '
                         'the stamps of a bag; write it as CSV')
    stamps = start + np.round(shift).astype(np.int64)
    topics = _topics(record)
    table, labels = record_table(record)
    writer = BagWriter(path, [*((name, kind) for name, kind, _ in topics),
                              (EXACT_TOPIC, ARRAY_TYPE)])
    try:
        with writer:
            for number, (name, kind, fields) in enumerate(topics):
                if on_progress is not None:
                    on_progress(number / len(topics))
                for stamp, values in zip(stamps.tolist(), fields.tolist(), strict=True):
                    writer.write(name, stamp, serialize(kind, _message(name, kind, stamp, values)))
            writer.write(EXACT_TOPIC, int(stamps[-1]),
                         serialize(ARRAY_TYPE, _array(table, labels)))
    except BaseException:   # an interrupt too: half a bag is no flight, and bars the next try
        shutil.rmtree(path, ignore_errors=True)
        raise


def _topics(record: FlightRecord) -> list[tuple[str, str, np.ndarray]]:
    """Return (name, type, values (N, k)) of the topics that a record has the columns for."""
    found = []
    kinds = {name: topic.type for name, topic in FLIGHT_TOPICS.items()}
    if record.has('px', 'py', 'pz', *QUATERNION):
        found.append(('pose', kinds['pose'], record.stack('px', 'py', 'pz', *QUATERNION)))
    if record.has('vx', 'vy', 'vz', 'wx', 'wy', 'wz', *QUATERNION):
        q = record.stack(*QUATERNION)
        with np.errstate(all='ignore'):
            body = rotate(conjugate(q / np.linalg.norm(q, axis=-1, keepdims=True)),
                          record.stack('vx', 'vy', 'vz'))
        found.append(('twist', kinds['twist'],
                      np.hstack([body, record.stack('wx', 'wy', 'wz')])))
    arm = arm_of(record.info)
    if record.has('u1', *MOMENTS, 'u4'):
        found.append(('input', kinds['input'], record.stack('u1', *MOMENTS, 'u4')))
    elif record.has(*INPUTS) and arm:     # without the arm nobody knows the moments
        found.append(('input', kinds['input'], record.inputs() * [1.0, arm, arm, 1.0]))
    if record.has(*EULER):
        found.append(('attitude', kinds['attitude'], record.stack(*EULER)))
    if record.has('pz'):
        found.append(('altitude', kinds['altitude'], record.stack('pz')))
    if record.has('ax', 'ay', 'az'):
        found.append(('specific_force', VECTOR, record.stack('ax', 'ay', 'az')))
    for topic, prefix in (('command', 'cmd'), ('rotor_speed', 'rotor')):
        names = record.numbered(prefix)
        if names:
            found.append((topic, ARRAY_TYPE, record.stack(*names)))
    return found


def _message(name: str, kind: str, stamp: int, values: Sequence[float]) -> dict[str, Any]:
    """Return the fields of a message as nested dicts."""
    if kind == ARRAY_TYPE:
        return _array(np.array(values), (name,))
    header = {'stamp': {'sec': stamp // 1_000_000_000, 'nanosec': stamp % 1_000_000_000},
              'frame_id': 'base_link' if name in ('twist', 'input', 'specific_force')
              else 'world'}

    if name == 'pose':
        body = {'position': dict(zip('xyz', values[:3], strict=True)),
                'orientation': dict(zip('wxyz', values[3:], strict=True))}
        return {'header': header, 'pose': body}
    if name == 'twist':
        return {'header': header, 'twist': {'linear': dict(zip('xyz', values[:3], strict=True)),
                                            'angular': dict(zip('xyz', values[3:],
                                                                strict=True))}}
    if name == 'input':
        return {'header': header, 'wrench': {'force': {'x': 0.0, 'y': 0.0, 'z': values[0]},
                                             'torque': dict(zip('xyz', values[1:],
                                                                strict=True))}}
    if name == 'altitude':
        return {'header': header, 'point': {'x': 0.0, 'y': 0.0, 'z': values[0]}}
    return {'header': header, 'vector': dict(zip('xyz', values, strict=True))}


def _array(table: np.ndarray, labels: Sequence[str]) -> dict[str, Any]:
    sizes, stride, dims = table.shape, table.size, []
    for label, size in zip(labels, sizes, strict=True):
        dims.append({'label': label, 'size': size, 'stride': stride})
        stride //= max(size, 1)
    return {'layout': {'dim': dims, 'data_offset': 0}, 'data': np.ravel(table)}
