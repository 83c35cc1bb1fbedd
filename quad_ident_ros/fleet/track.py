# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The parameters of effects fitted to each flight by itself, so that a change has a date."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import hashlib
from pathlib import Path
from typing import Any

import pyarrow
import pyarrow.compute as pc

from quad_ident_ros.data.differentiated import with_motion
from quad_ident_ros.data.inertial import is_inertial
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.thrust_level import FULL_SPEED
from quad_ident_ros.effects.base import Parameter
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.fleet.grouping import Group, Member
from quad_ident_ros.fleet.look import why_missing
from quad_ident_ros.fleet.store import write_rows
from quad_ident_ros.greybox.fit import Fit, fit, OF_LEVEL
from quad_ident_ros.greybox.rotor_answer import is_driven_by_speeds, OF_MOTORS
from quad_ident_ros.greybox.taken_in import taken_in

MOST = 0.5      # share of the fleet's vehicles from which on an effect is compared in all of them
TOGETHER = 0.5  # share of verdicts with one of two effects from which on both are there

# Verdicts let these differ from flight to flight, so that they do not name what drifts a little.
# Thrust is one; wind is another, but belongs to the day and not to the vehicle.
BY_FLIGHT = tuple(name for name, effect in EFFECTS.items()
                  if effect.per_flight and not effect.needs_air)

Forms = Mapping[str, Mapping[str, int]]     # {effect: {form: how often it is named}}


@dataclass(frozen=True, eq=False)
class Tracking:
    """A Group, and the effects {effect: form} that are fitted to each of its flights."""

    group: Group
    effects: Mapping[str, str]

    @property
    def key(self) -> str:
        """Return the key of its rows, which begins with that of the group."""
        names = ' '.join(f'{effect} {form}' for effect, form in sorted(self.effects.items()))
        return f'{self.group.key}-{hashlib.sha256(names.encode()).hexdigest()[:16]}'


def is_by_flight(effect: str) -> bool:
    """Return whether an effect is one of BY_FLIGHT, or a mass, which stands for thrust."""
    return effect in BY_FLIGHT or effect in EFFECTS and any(look_alike(effect, one)
                                                            for one in BY_FLIGHT)


def tracked_effects(effects: pyarrow.Table) -> dict[str, dict[str, str]]:
    """
    Return {vehicle: {effect: form}} to track, of the table `effects` of a data set.

    For each vehicle the effects that most vehicles have, those that any of its groups names, and
    those that verdicts let differ from flight to flight (BY_FLIGHT); each in the form that its
    groups name it in most often, or else the fleet. A single flight does not determine effects
    that look alike together: of these the one that most vehicles have is tracked, or else the one
    that is named more often. Both are where most vehicles have both, and verdicts name them
    together; and thrust is beside all but a mass.
    """
    named = effects.filter(pc.field('named'))
    counts = named.group_by(['vehicle', 'effect', 'form']).aggregate([([], 'count_all')])
    by_vehicle: dict[str, dict[str, dict[str, int]]] = {
        vehicle: {} for vehicle in effects['vehicle'].unique().to_pylist()}
    for row in counts.to_pylist():
        forms = by_vehicle[row['vehicle']].setdefault(row['effect'], {})
        forms[row['form']] = row['count_all']
    common: dict[str, dict[str, int]] = {}
    for effect in EFFECTS:
        having = [found[effect] for found in by_vehicle.values() if effect in found]
        if having and len(having) >= MOST * len(by_vehicle):
            common[effect] = {form: sum(one.get(form, 0) for one in having)
                              for forms in having for form in forms}
    often = {effect: sum(effect in found for found in by_vehicle.values()) for effect in common}
    kept = _without_alternatives(common, often, named)
    unnamed: Forms = {effect: kept.get(effect, {}) for effect in BY_FLIGHT}
    wanted = {vehicle: {**unnamed, **found} for vehicle, found in by_vehicle.items()}
    return {vehicle: {effect: _usual(effect, {**kept, **found}[effect])
                      for effect in _apart(kept, found)}
            for vehicle, found in wanted.items()}


def _without_alternatives(common: Forms, often: Mapping[str, int], named: pyarrow.Table
                          ) -> Forms:
    """
    Return the common effects, of those that look alike and are seldom named together the first.

    often: how many vehicles have each; named: the rows of the verdicts.
    """
    verdicts: dict[str, set[str]] = {}
    for row in named.select(['group', 'effect']).to_pylist():
        verdicts.setdefault(row['group'], set()).add(row['effect'])

    def count(*effects: str) -> int:
        return sum(one.issuperset(effects) for one in verdicts.values())

    kept: list[str] = []
    for effect in sorted(common, key=lambda name: (-often[name], -count(name))):
        if all(count(effect, one) >= TOGETHER * min(count(effect), count(one))
               for one in kept if look_alike(effect, one)):
            kept.append(effect)
    return {effect: common[effect] for effect in kept}


def look_alike(effect: str, other: str) -> bool:
    """
    Return whether two effects look alike in a single flight.

    Thrust stands out of all but a mass, of which only the ratio shows: a flight within which the
    battery sags, or of a vehicle with other inertia, tells both.
    """
    if effect in BY_FLIGHT or other in BY_FLIGHT:
        return EFFECTS[effect].ratio is not None and EFFECTS[effect].ratio == EFFECTS[other].ratio
    return other in EFFECTS[effect].confused_with or effect in EFFECTS[other].confused_with


def _apart(common: Forms, found: Forms) -> list[str]:
    """Return the common effects, and of a vehicle's other ones those that look like none kept."""
    kept = list(common)
    for effect in sorted((name for name in EFFECTS if name in found and name not in common),
                         key=lambda name: -sum(found[name].values())):
        if not any(look_alike(effect, one) for one in kept):
            kept.append(effect)
    return sorted(kept, key=list(EFFECTS).index)


def track(tracking: Tracking, out: str | Path) -> None:
    """
    Fit the effects of a Tracking to each flight of its group and write the rows.

    A flight that cannot be fitted has none. One that can show none of them, such as thrust that
    follows from the weight, has a row of covariances without names: nothing is wrong with it.
    Raises LookupError where one is not there any more, and OSError where nothing can be written.
    """
    group = tracking.group
    names = [f'{effect}.{parameter.name}' for effect, form in tracking.effects.items()
             for parameter in _parameters(effect, form, len(group.nominal.rotors))]
    parameters: list[dict[str, Any]] = []
    covariances: list[dict[str, Any]] = []
    for member in group.flights:
        if why := why_missing(member.path, member.flight):
            raise LookupError(why)      # an OSError would end the run
        try:
            records = [record for record, _ in taken_in(
                load_all(member.path, group.mapping, group.nominal), group.nominal)]
            free = _determined(names, records)
            if not free:
                covariances.append({'flight': member.flight})
                continue
            found = fit(records, group.nominal, free)
        except Exception:   # of a library, too: it takes no other flight with it
            continue
        parameters += _values(found, member, group)
        covariances.append({'flight': member.flight, 'names': list(found.names),
                            'matrix': found.estimate.covariance.ravel().tolist()})
    write_rows(out, 'parameters', tracking.key, parameters)
    write_rows(out, 'covariances', tracking.key, covariances)


def _determined(names: Sequence[str], records: Sequence[FlightRecord]) -> list[str]:
    """
    Return the names of what records can show.

    Without position and velocity a fit shows nothing; commands that the weight scaled do not show
    thrust, and speeds in place of commands no motors.
    """
    if any(is_inertial(with_motion(record)) for record in records):
        return []
    levelled = any(FULL_SPEED in record.info for record in records)
    driven = any(map(is_driven_by_speeds, records))
    return [name for name in names if not (levelled and name in OF_LEVEL
                                           or driven and name.partition('.')[0] in OF_MOTORS)]


def _parameters(effect: str, form: str, rotors: int) -> Sequence[Parameter]:
    """Return the parameters of a form that a vehicle with so many rotors has."""
    known = EFFECTS[effect]
    return known.parameters_of(next(one for one in known.forms if one.name == form), rotors)


def _usual(effect: str, forms: Mapping[str, int]) -> str:
    """Return the form that is named most often, of equals the first of the effect."""
    order = [form.name for form in EFFECTS[effect].forms]
    return max(order, key=lambda name: (forms.get(name, 0), -order.index(name)))


def _values(found: Fit, member: Member, group: Group) -> Sequence[dict[str, Any]]:
    return [{'flight': member.flight, 'group': group.key, 'vehicle': group.vehicle,
             'configuration': group.configuration, 'date': member.date,
             'effect': one.name.partition('.')[0], 'parameter': one.name.partition('.')[2],
             'unit': one.unit, 'value': one.value, 'std': one.std}
            for one in found.parameters if one.value is not None]
