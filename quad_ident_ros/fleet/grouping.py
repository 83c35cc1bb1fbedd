# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights of one vehicle, configuration and day, which are diagnosed together."""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from datetime import datetime
import hashlib
import json
from pathlib import Path

from quad_ident_ros import __version__
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.fleet.dates import date_in, date_in_path, in_order
from quad_ident_ros.fleet.look import date_of_file, Looked
from quad_ident_ros.fleet.manifest import Listed, own_folder
from quad_ident_ros.model.vehicle import Vehicle, vehicle_text

UNNAMED = 'vehicle'     # where neither manifest, folders nor log say which it is
SHOWN = 3           # folders that a message names


@dataclass(frozen=True)
class Member:
    """A flight of a group: its SHA-256, when it was flown, and the covariates of its manifest."""

    path: str
    flight: str
    date: datetime
    covariates: dict[str, float]


@dataclass(frozen=True, eq=False)
class Group:
    """
    Flights that are diagnosed together, the earliest first, and what with.

    nominal: the vehicle that they are held against, against: a checksum of it; key: of all that
    its result depends on; older: keys of groups of a data set whose results stay where this one
    fails.
    """

    vehicle: str
    configuration: str
    flights: tuple[Member, ...]
    nominal: Vehicle
    mapping: Mapping | None
    rules: Rules
    key: str
    version: str = __version__
    older: tuple[str, ...] = ()
    against: str = ''

    @property
    def date(self) -> datetime:
        """Return when the first flight was flown."""
        return self.flights[0].date


def groups_of(flights: Iterable[tuple[Listed, Looked]], nominal_of: Callable[[Listed], Vehicle],
              mapping: Mapping | None, rules: Rules) -> tuple[list[Group], list[Listed]]:
    """
    Return the Groups of flights, and the flights left out: their content occurs before.

    nominal_of: the nominal vehicle of a flight; raises InputError where none is named.
    """
    seen: set[str] = set()
    again: list[Listed] = []
    members: dict[tuple[str, ...], list[Member]] = {}
    nominal: dict[tuple[str, ...], Vehicle] = {}
    for listed, looked in flights:
        if looked.flight in seen:
            again.append(listed)
            continue
        seen.add(looked.flight)
        vehicle = listed.vehicle or looked.hardware or listed.folder or UNNAMED
        date = date_said(listed, looked) or date_of_file(looked)
        day = listed.group or (date_in(listed.day) or date).date().isoformat()
        place = vehicle, listed.configuration, day, listed.vehicle_file
        nominal.setdefault(place, nominal_of(listed))
        members.setdefault(place, []).append(
            Member(looked.path, looked.flight, date, listed.covariates))
    texts = {id(one): vehicle_text(one) for one in {id(one): one for one in nominal.values()
                                                    }.values()}
    groups = []
    for key, some in members.items():
        some.sort(key=lambda one: in_order(one.date, one.path))
        groups.append(Group(key[0], key[1], tuple(some), nominal[key], mapping, rules,
                            _key(key, some, texts[id(nominal[key])], mapping, rules),
                            against=_checksum(texts[id(nominal[key])])))
    return groups, again


def taken_together(flights: Iterable[tuple[Listed, Looked]]) -> tuple[str, ...]:
    """
    Return which folders are taken for those of one vehicle, though they may be of several.

    They are below those that name vehicle and configuration, or have one name in several places.
    """
    found: dict[str, dict[str, None]] = {}
    for listed, looked in flights:
        if listed.deeper:
            name = listed.vehicle + (f' ({listed.configuration})' if listed.configuration else '')
            found.setdefault(name, {})[listed.deeper] = None
        elif not (listed.vehicle or looked.hardware):
            found.setdefault(listed.folder or UNNAMED, {})[
                str(own_folder(Path(listed.path)))] = None
    return tuple(f'{name}: {", ".join([*some][:SHOWN])}'
                 + (f' and {len(some) - SHOWN} more' if len(some) > SHOWN else '')
                 for name, some in found.items() if len(some) > 1)


def rules_hash(rules: Rules) -> str:
    """Return a checksum of the thresholds of a verdict."""
    return _checksum(asdict(rules))


def date_said(listed: Listed, looked: Looked) -> datetime | None:
    """Return when a flight was flown by the manifest, the log or the names, None if none says."""
    return listed.date or looked.date or date_in_path(listed.path) or date_in(listed.day)


def _key(place: tuple[str, ...], members: list[Member], nominal: str, mapping: Mapping | None,
         rules: Rules) -> str:
    """Return a checksum of all that the result of a group depends on."""
    return _checksum({
        'version': __version__, 'rules': asdict(rules), 'mapping': mapping and asdict(mapping),
        'vehicle': place[0], 'configuration': place[1], 'nominal': nominal,
        'flights': [[one.flight, one.date.isoformat(), one.covariates] for one in members]})


def _checksum(data: object) -> str:
    text = json.dumps(data, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
