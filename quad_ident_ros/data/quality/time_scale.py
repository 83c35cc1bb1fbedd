# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A time that is not in seconds, which all streams of a motion tell alike."""

from quad_ident_ros.data.attitudes import attitudes_of
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.timing import SLOWEST
from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.data.time_scale import clues, is_wrong, Motion, scale_of, unit_of
from quad_ident_ros.model.vehicle import Vehicle

DEGREES = 1     # streams, of which those of angles in degrees look as those of a time in minutes


def of_time(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find a time in minutes or hours, or one that counts something else than seconds."""
    if record.period() > SLOWEST:
        return []       # which is said, with the units that are larger
    groups = (record.stack(*names) if record.has(*names) else None
              for names in (('px', 'py', 'pz'), ('vx', 'vy', 'vz'), ('wx', 'wy', 'wz'),
                            ('ax', 'ay', 'az')))
    place, speed, rate, force = groups
    said = clues(Motion(record.t, place, speed, attitudes_of(record), rate, force))
    scale = scale_of(said)
    if scale is None or not is_wrong(scale) or (
            len(said) <= DEGREES and record.has(*EULER) and not record.has(*QUATERNION)):
        return []
    unit = unit_of(scale)
    agree = ', '.join(one.streams for one in said)
    if unit:
        return [Finding('time_scale', 'error', 't',
                        f'{agree} agree only if {scale:.3g} s pass in one of t: it is in {unit}',
                        f'multiply t by {60 if unit == "min" else 3600}, or say unit: {unit} of '
                        't in a mapping')]
    period = record.period()
    return [Finding('time_scale', 'error', 't',
                    f'{agree} agree only if {scale:.3g} s pass in one of t: a sample comes every '
                    f'{scale * period:.3g} s, not every {period:.3g} s',
                    'write t in s, or say its unit in a mapping; of a t that counts, the rate '
                    f'(unit: {1.0 / (scale * period):.3g} Hz where it counts samples)')]
