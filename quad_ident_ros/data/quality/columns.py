# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Columns that are missing, that stand still, or whose values no flight has."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.data.cutting import without
from quad_ident_ros.data.differentiated import (
    differenced_motion,
    DIFFERENCES,
    DIFFERENTIATED,
    HALF,
    missing_motion,
)
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION, unit
from quad_ident_ros.model.vehicle import Vehicle

GROUPS = (('px', 'py', 'pz'), ('vx', 'vy', 'vz'), QUATERNION, ('wx', 'wy', 'wz'))
"""Columns of the motion; one alone is of little use, except the height."""

FORCE = ('ax', 'ay', 'az')

PAIRED = dict(zip(('position', 'velocity', 'attitude', 'rate'), GROUPS, strict=True))

LARGEST = {'m': 1e8, '1': 1e3}      # by unit; beyond it a value is no measurement,
LARGEST_OTHER = 1e6                 # in m/s, rad/s, V, ...; wrong units alone lie below
SHORTEST, OFF = 0.5, 0.02           # length of a quaternion: none; off 1


def known(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find records without any column of the format."""
    if any(unit(name) for name in record.columns):
        return []
    has = ', '.join(record.columns) or 'none'
    return [Finding('no_columns', 'error', 'header',
                    f'beside t there is no column of a flight record (there are: {has[:80]})',
                    'name the columns as docs/records.md does: px, py, pz, qw, ...')]


def incomplete(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find attitudes, rates and velocities of which a component is missing."""
    found = []
    for names in GROUPS:
        missing = [name for name in names if not record.has(name)]
        some = [name for name in names if name not in missing and name != 'pz']
        if missing and some:
            found.append(Finding(
                'incomplete', 'warning', ', '.join(some),
                f'{", ".join(missing)} {"is" if len(missing) == 1 else "are"} missing beside '
                'them, so that they are not used', 'record all of them'))
    return found


def differentiated(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find velocity and rate that are taken from position and attitude, not from the record."""
    pairs = {'velocity': ('vx, vy, vz', 'the position'), 'rate': ('wx, wy, wz', 'the attitude')}
    if DIFFERENTIATED in record.info:
        groups, rough = record.info[DIFFERENTIATED], record.info.get(DIFFERENCES, ())
    else:
        rough = differenced_motion(record)
        groups = (*missing_motion(record), *rough)
    found = []
    for group in groups:
        where, pose = pairs[group]
        why = (f'differences of {pose} from one row to the next, which turn a little noise into '
               'a lot' if group in rough else 'not recorded, or not in all components')
        found.append(Finding(
            'differentiated', 'info', where,
            f'{why}; diagnose and fit take the {group} from {pose}, by cubics over '
            f'{2 * HALF:g} s', f'record the {group}, where there is one'))
    return found


def frozen(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find records in which position, velocity, attitude and rate never change."""
    names = [name for names in GROUPS for name in names if record.has(name)]
    if not names or np.any(np.diff(record.stack(*names), axis=0)):
        return []
    return [Finding('frozen', 'error', ', '.join(names), 'none of these ever changes: a sensor or '
                    'the recorder was stuck', 'check that the streams run, and record again')]


def dead(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find streams that never change while another one of the same motion does."""
    found = []
    for one, other in (('velocity', 'position'), ('rate', 'attitude'), ('position', 'velocity'),
                       ('attitude', 'rate')):
        mine, theirs = PAIRED[one], PAIRED[other]
        if (record.has(*mine, *theirs) and not _changes(record, mine)
                and _changes(record, theirs)):
            found.append(Finding(
                'dead', 'error', ', '.join(mine), f'the {one} never changes, but the {other} '
                'does: the stream was stuck, or its columns were filled in',
                'check that the stream runs, or omit its columns'))
    names = record.numbered('cmd')
    moving = [name for name in GROUPS[-1] if record.has(name)]
    if names and moving and not _changes(record, names) and _changes(record, moving):
        found.append(Finding(
            'dead', 'warning', f'{names[0]} to {names[-1]}', 'the commands never change, but the '
            'rate does: they were stuck, or nobody steered',
            'record the commands that the rotors follow'))
    return found


def _changes(record: FlightRecord, names: Sequence[str]) -> bool:
    return bool(np.any(np.diff(record.stack(*names), axis=0)))


def negative(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find speeds of rotors below zero, and voltages that are not above."""
    found = []
    for name, values in record.columns.items():
        if unit(name) != 'rad/s' or not name.startswith(('cmd', 'rotor')):
            continue
        if np.any(values < 0.0):
            first = int(np.argmax(values < 0.0))
            found.append(Finding(
                'negative', 'error', f'{name}, t = {record.t[first]:.3f} s',
                f'a rotor speed of {values[first]:.4g} rad/s is below zero; the vehicle file says '
                'which way a rotor turns', 'write speeds without a sign'))
    return found + (_no_voltage(record) if record.has('vbat') else [])


def _no_voltage(record: FlightRecord) -> list[Finding]:
    """Find voltages that are not above zero: of a sensor that is missing, or that drops out."""
    voltage = record.columns['vbat']
    if not np.nanmedian(voltage) > 0.0:
        return [Finding('no_voltage', 'error', 'vbat', 'the voltage is not above zero',
                        'leave the column out where no voltage was measured')]
    bad = voltage <= 0.0
    if not bad.any():
        return []
    first = int(np.argmax(bad))
    return [Finding('no_voltage', 'warning', f'vbat, t = {record.t[first]:.3f} s',
                    f'the voltage is {voltage[first]:.3g} V there, which no battery has '
                    f'({100 * bad.mean():.1f} % of the samples are not above zero)',
                    without(record.t, bad, 'leave the column vbat out'))]


def quaternions(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find quaternions that are zero or not of unit length."""
    if not record.has(*QUATERNION):
        return []
    length = np.linalg.norm(record.stack(*QUATERNION), axis=1)
    short = length < SHORTEST
    if short.any():
        return [Finding('quaternion_zero', 'error',
                        f'qw, qx, qy, qz, t = {record.t[int(np.argmax(short))]:.3f} s',
                        f'{int(short.sum())} samples hold no attitude: their quaternion has a '
                        f'length down to {length.min():.3g}, expected 1',
                        without(record.t, short, 'see what writes the attitude'))]
    off = np.abs(length - 1.0) > OFF
    if not off.any():
        return []
    first = int(np.argmax(off))
    return [Finding('quaternion_length', 'warning', f'qw, qx, qy, qz, t = {record.t[first]:.3f} s',
                    f'the length of the quaternion is {length[first]:.3g}, expected 1 '
                    f'(in {100 * off.mean():.1f} % of the samples it is not)',
                    'divide it by its length, as all commands do, and see what writes it')]


def possible(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find values that are too large for any flight in any unit."""
    found = []
    for name, values in record.columns.items():
        bad = _too_large(name, values)
        if bad.any():
            first = int(np.argmax(bad))
            found.append(Finding(
                'impossible', 'error', f'{name}, t = {record.t[first]:.3f} s',
                f'{values[first]:.3g} {unit(name)} cannot occur in flight ({int(bad.sum())} such '
                'samples)', without(record.t, bad, f'see what writes {name}')))
    return found


def believable(record: FlightRecord) -> FlightRecord:
    """Return a record without the signals that hold a value which no flight has."""
    spoilt = {name for name, values in record.columns.items() if _too_large(name, values).any()}
    if not spoilt:
        return record
    signals = (*GROUPS, EULER, FORCE, record.numbered('cmd'), record.numbered('rotor'))
    spoilt.update(*(names for names in signals if spoilt.intersection(names)))
    return FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                   if name not in spoilt}, record.info)


def _too_large(name: str, values: np.ndarray) -> np.ndarray:
    """Return where a column (N,) holds what no flight has, (N,) bool; unknown ones never do."""
    said = unit(name)
    if said is None:
        return np.zeros(len(values), bool)
    return np.abs(values) > LARGEST.get(said, LARGEST_OTHER)
