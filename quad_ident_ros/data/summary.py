# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is in a flight record, as data: columns, rates, ranges, excitation, findings."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from quad_ident_ros.data.differentiated import with_motion
from quad_ident_ros.data.modes import mode_spans
from quad_ident_ros.data.quality import (
    clock_offset,
    ClockOffset,
    command_offset,
    Finding,
    findings,
    gravest_first,
    velocity_offset,
)
from quad_ident_ros.data.quality.excitation import excitation
from quad_ident_ros.data.quality.ground import airborne
from quad_ident_ros.data.quality.series import GAP
from quad_ident_ros.data.readers.base import Content
from quad_ident_ros.data.record import FlightRecord, REFERENCE, unit
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle

OF_GROUND = 'thrust', 'saturation', 'rotor_order', 'rotor_spin'
"""Codes of Findings by which motors that stand look like faults."""

UNITS = {'roll': 'rad/s', 'pitch': 'rad/s', 'yaw': 'rad/s', 'vertical': 'm/s^2',
         'horizontal': 'm/s'}


def summarise(record: FlightRecord, vehicle: Vehicle | None = None, more: Sequence[Finding] = ()
              ) -> dict[str, Any]:
    """
    Return what is in a record, JSON-able.

    Args: record and vehicle as those of data.quality.findings; more: Findings beside those.

    The rate of a column is that at which its value changes, so that a slow stream shows beside a
    fast one.
    """
    steps = np.diff(record.t)
    with np.errstate(all='ignore'):     # values too large to judge
        clocks = clock_offset(record), velocity_offset(record), command_offset(record)
        excited = excitation(record)
        columns = {name: _column(name, values, record.t)
                   for name, values in record.columns.items()}
    return {
        'schema': 'quad_ident/info/1',
        'source': record.info.get('source'),
        'name': record.info.get('name'),
        'time': {'samples': len(record), 'start_s': float(record.t[0]),
                 'duration_s': float(record.t[-1] - record.t[0]),
                 'rate_hz': 1.0 / record.period(),
                 'period_s': {'shortest': float(steps.min()), 'median': record.period(),
                              'longest': float(steps.max())},
                 'gaps': int((steps > GAP * record.period()).sum())},
        'modes': [{'mode': name, 'from_s': first, 'to_s': last}
                  for name, first, last in mode_spans(record)],
        'columns': columns,
        'excitation': {name: {'value': value, 'unit': UNITS[name]}
                       for name, value in excited.items()},
        'clock': dict(zip(('attitude_against_gyro', 'position_against_velocity',
                           'accelerometer_against_commands'), map(_clock, clocks), strict=True)),
        'findings': [asdict(finding) for finding in gravest_first(
            [*more, *_findings(record, vehicle)])],
    }


def _findings(record: FlightRecord, vehicle: Vehicle | None) -> tuple[Finding, ...]:
    """Return the Findings on a record, those of OF_GROUND on what diagnose and fit keep of it."""
    found = findings(record, vehicle)
    whole = with_motion(record) if vehicle is not None and not any(
        one.severity == 'error' for one in found) else record
    if whole is not record:     # what diagnose and fit refuse with the motion that they take
        found = gravest_first([*found, *(one for one in findings(whole, vehicle)
                                         if one.severity == 'error')])
    if vehicle is None or not any(one.code == 'ground' and one.severity == 'warning'
                                  for one in found):
        return found
    flown = findings(airborne(record, vehicle), vehicle)
    return gravest_first([*(one for one in found if one.code not in OF_GROUND),
                          *(one for one in flown if one.code in OF_GROUND)])


def contents(path: str | Path, title: str, streams: Sequence[Content]) -> dict:
    """Return what is in a file, JSON-able: its kind and the Content of its streams."""
    return {'file': str(path), 'kind': title, 'streams': [
        {'name': one.name, 'type': one.type, 'samples': one.samples, 'start_s': one.start,
         'duration_s': one.duration, 'rate_hz': one.rate, 'fields': list(one.fields),
         'roles': list(one.roles)} for one in streams]}


def segments(records: Sequence[FlightRecord]) -> list[dict]:
    """Return the numbers and spans of the records of a file, JSON-able."""
    return [{'number': number, 'name': record.info.get('name'), 'start_s': float(record.t[0]),
             'duration_s': float(record.t[-1] - record.t[0])}
            for number, record in enumerate(records, 1)]


def unread(path: str | Path, error: InputError) -> dict:
    """Return the summary of a file that is no flight record, with an error as its finding."""
    message = str(error).removeprefix(str(path)).lstrip(':, ')
    return {'schema': 'quad_ident/info/1', 'source': str(path), 'name': None, 'findings': [
        {'code': 'unread', 'severity': 'error', 'where': str(path), 'message': message,
         'remedy': ''}]}


def _column(name: str, values: np.ndarray, t: np.ndarray) -> dict[str, Any]:
    finite = values[np.isfinite(values)]
    changes = int(np.count_nonzero(values[1:] != values[:-1]))
    some = {'unit': unit(name) or REFERENCE.get(name), 'missing': int(len(values) - len(finite)),
            'changes_hz': changes / float(t[-1] - t[0])}
    for key, function in (('minimum', np.min), ('mean', np.mean), ('maximum', np.max),
                          ('std', np.std)):
        with np.errstate(over='ignore', invalid='ignore'):
            value = float(function(finite)) if len(finite) else None
        some[key] = value if value is not None and np.isfinite(value) else None
    return some


def _clock(offset: ClockOffset | None) -> dict[str, float | None] | None:
    if offset is None:
        return None
    known = bool(np.isfinite(offset.drift_std))
    return {'offset_s': offset.offset, 'std_s': offset.std,
            'drift_s_per_s': offset.drift if known else None,
            'drift_std_s_per_s': offset.drift_std if known else None}
