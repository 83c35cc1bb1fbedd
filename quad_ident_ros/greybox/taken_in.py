# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records on their way into a fit: commands, faults, and what is off the ground."""

from collections.abc import Iterable

from quad_ident_ros.data.commands import with_commands
from quad_ident_ros.data.quality import refuse_errors, refuse_unfit
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.ground import airborne, stands
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import joined
from quad_ident_ros.model.vehicle import Vehicle


def taken_in(records: Iterable[FlightRecord], vehicle: Vehicle
             ) -> list[tuple[FlightRecord, tuple[Finding, ...]]]:
    """
    Return the flights of records as a fit takes them, each with the Findings on it.

    Raises InputError where one is too faulty.
    """
    found = []
    for record in joined([with_commands(record, vehicle) for record in records]):
        ground = stands(record, vehicle)
        refuse_errors(record, ground)
        flown = airborne(record, vehicle)
        found.append((flown, (*ground, *refuse_unfit(flown, vehicle))))
    return found
