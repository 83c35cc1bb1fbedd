# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a run is to diagnose, checked before any worker is started."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
import os
from typing import Any

from quad_ident_ros import __version__
from quad_ident_ros.data.mapping import load_mapping, Mapping
from quad_ident_ros.diagnose.rules import RULES, Rules
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.grouping import rules_hash
from quad_ident_ros.fleet.manifest import Listed, listed, VEHICLE_FILE
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.load import load_any_vehicle


@dataclass(frozen=True, eq=False)
class Plan:
    """
    Flights, and what they are diagnosed with.

    flights: their paths hold in any folder, for workers are started in folders of their own;
    nominal_of: the nominal vehicle of a flight; origin: how the data set is made, as data.
    """

    flights: tuple[Listed, ...]
    nominal_of: Callable[[Listed], Vehicle]
    mapping: Mapping | None
    rules: Rules
    origin: dict[str, Any]


def planned(names: Sequence[str], *, vehicle: str | None = None, mapping: str | None = None,
            rules: Rules = RULES) -> Plan:
    """
    Return the Plan for flights, folders and manifests; raises InputError.

    Args: vehicle: nominal vehicle, name or file, of flights that have none of their own; mapping:
    file; rules: thresholds of the verdicts.
    """
    flights = tuple(replace(one, path=os.path.abspath(one.path)) for one in listed(names))
    nominal_of = partial(_nominal, vehicle, lru_cache(None)(load_any_vehicle))
    for one in flights:
        nominal_of(one)
    # Without times, so that the same run writes the same.
    origin = {'schema': 'quad_ident/fleet/1', 'version': __version__,
              'vehicles': sorted({one.vehicle_file or str(vehicle) for one in flights}),
              'mapping': mapping, 'rules': rules_hash(rules)}
    return Plan(flights, nominal_of, load_mapping(mapping) if mapping else None, rules, origin)


def _nominal(vehicle: str | None, load: Callable[[str], Vehicle], one: Listed) -> Vehicle:
    """Return the nominal vehicle of a flight; raises InputError where none is named."""
    name = one.vehicle_file or vehicle
    if not name:
        raise InputError(f'{one.path}: no nominal vehicle is named for it; give --vehicle FILE, '
                         f'put a {VEHICLE_FILE} into the folder of its vehicle, or name one in '
                         'the column vehicle_file of a manifest')
    try:
        return load(name)
    except InputError as error:
        if not (one.vehicle_file and one.place):
            raise
        raise InputError(f'{one.place}, column vehicle_file: {error}') from None
