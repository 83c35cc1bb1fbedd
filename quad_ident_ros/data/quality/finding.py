# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a check of a flight record says."""

from dataclasses import asdict, dataclass

from quad_ident_ros.data.record import FlightRecord

SEVERITIES = ('info', 'warning', 'error')
"""info: good to know; warning: results suffer; error: results are wrong until it is mended."""


@dataclass(frozen=True)
class Finding:
    """A finding: a code for programs, one of SEVERITIES, where, what, and how to mend it."""

    code: str
    severity: str
    where: str
    message: str
    remedy: str


def as_caution(finding: Finding, record: FlightRecord) -> dict:
    """Return a Finding on a record as data, with the name of the flight."""
    return {'flight': record.info.get('name', 'flight'), **asdict(finding)}
