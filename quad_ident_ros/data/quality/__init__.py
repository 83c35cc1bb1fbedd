# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The quality of a flight record: what is wrong with it, and how to mend it.

One file per subject, each with checks (record, vehicle or None) -> findings, entered in
COLUMNS or COMPARISONS.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from quad_ident_ros.data.quality import (
    answer,
    clock,
    columns,
    excitation,
    frames,
    glitches,
    ground,
    gyro,
    moments,
    rotors,
    rounding,
    saturation,
    stale,
    thrust,
    time_scale,
    timing,
    units,
)
from quad_ident_ros.data.quality.clock import (
    clock_offset,
    ClockOffset,
    command_offset,
    velocity_offset,
)
from quad_ident_ros.data.quality.finding import as_caution, Finding, SEVERITIES
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle

COLUMNS = (columns.known, columns.incomplete, columns.differentiated, columns.frozen,
           columns.dead, columns.quaternions, columns.possible, columns.negative, timing.slow,
           timing.bursts, timing.gaps, timing.duplicates, timing.truncated, timing.reader_notes,
           rotors.count)
"""Checks of columns by themselves."""

COMPARISONS = (stale.held, stale.ended, stale.stuck, stale.marked, glitches.attitude,
               glitches.others, units.rates_in_degrees, units.euler_in_degrees, units.force_in_g,
               units.position_in_millimetres, units.speeds_in_rpm, *frames.CHECKS,
               rotors.hover, rotors.size, thrust.curve, thrust.carried, thrust.other_vehicle,
               rotors.order_and_spin, moments.unit, thrust.level, clock.attitude, clock.velocity,
               clock.commands, ground.stands, gyro.bias, answer.commands, saturation.speeds,
               rounding.commands, excitation.axes)
"""Checks of columns against each other, which one impossible value would decide."""

TOLD = 'commands', 'logging', 'differentiated'
"""Codes of Findings that a diagnosis reports whatever their severity."""

__all__ = ['cautions', 'COLUMNS', 'COMPARISONS', 'clock_offset', 'ClockOffset', 'command_offset',
           'Finding', 'findings', 'gravest_first', 'refuse_errors', 'refuse_unfit', 'refuted',
           'SEVERITIES', 'velocity_offset']


def findings(record: FlightRecord, vehicle: Vehicle | None = None) -> tuple[Finding, ...]:
    """
    Return the Findings on a flight record, the gravest first.

    Args: record FlightRecord; vehicle model.vehicle.Vehicle or None; without it there are no
    findings of saturation, of the unit of rotor speeds, nor of the order and spin of the rotors.
    """
    with np.errstate(all='ignore'):   # values too large to judge
        found = [finding for check in COLUMNS for finding in check(record, vehicle)]
        believable = columns.believable(record)
        # Nearly all of the others would see a time that is not in s as faults of their own.
        found += time_scale.of_time(believable, vehicle) or [
            finding for check in COMPARISONS for finding in check(believable, vehicle)]
    return gravest_first(found)


def gravest_first(found: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return Findings by their severity."""
    return tuple(sorted(found, key=lambda finding: -SEVERITIES.index(finding.severity)))


def refuse_unfit(record: FlightRecord, vehicle: Vehicle | None) -> tuple[Finding, ...]:
    """Return the Findings on a record; InputError where it is too faulty to diagnose."""
    found = findings(record, vehicle)
    refuse_errors(record, found)
    return found


def cautions(record: FlightRecord, vehicle: Vehicle | None, doubtful: Collection[str] = ()
             ) -> list[dict]:
    """
    Return the warnings on a record that can be diagnosed, as data.

    These are the Findings of warning, what its outputs to the motors were taken for, what its log
    was too slow for or has no estimates of, and which states are derivatives of others.

    Args: doubtful: codes of errors that other flights of the vehicle speak against: see refuted.
    Raises InputError where the record is too faulty to diagnose.
    """
    found = [replace(finding, severity='warning') if finding.code in doubtful else finding
             for finding in findings(record, vehicle)]
    refuse_errors(record, found)
    return [as_caution(finding, record) for finding in found
            if finding.severity == 'warning' or finding.code in TOLD]


def refuted(records: Sequence[FlightRecord], vehicle: Vehicle | None) -> tuple[str, ...]:
    """
    Return the codes of errors that cannot be so, by another one of the flights of a vehicle.

    Rotors do not change their places from one flight to the next: where one flight shows that
    order or spins are those of the vehicle file, something else turns the body in the others.
    That the file is of another vehicle is then a warning, as it is by the thrust alone.
    """
    if len(records) < 2:
        return ()
    return tuple(dict.fromkeys(code for record in records
                               for code in rotors.confirmed(record, vehicle)))


def refuse_errors(record: FlightRecord, found: Iterable[Finding]) -> None:
    """Raise InputError where one of the Findings on a record is an error."""
    for finding in found:
        if finding.severity == 'error':
            name = record.info.get('source') or record.info.get('name', 'flight')
            raise InputError(f'{name}: {finding.where}: {finding.message}; {finding.remedy}')
