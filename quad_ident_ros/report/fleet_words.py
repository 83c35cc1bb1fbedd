# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet's insight means, in plain words: what to look at first, and why."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from quad_ident_ros.data.counted import counted
from quad_ident_ros.effects.registry import EFFECTS, NULL, PLACE, titled
from quad_ident_ros.fleet import history, sisters
from quad_ident_ros.fleet.events import Event, Part
from quad_ident_ros.fleet.history import Change, Drift
from quad_ident_ros.fleet.insight import Insight, MOST, Odd, Presence
from quad_ident_ros.fleet.track import look_alike
from quad_ident_ros.report.sizes import handy, PER_CENT, sized, with_error

WORSE, CHANGED, DRIFTS, DIFFERS, MODEL, FAILED, LOGS, SUSPECT, APART, SMALL = (
    'gets worse', 'changed', 'drifts', 'differs from its sisters', 'the model is wrong',
    'not diagnosed', 'logs refused', 'logs to check', 'not compared', 'small')
"""Why something is worth a look, the most urgent first: a drift goes on."""
NAMED = 5           # vehicles or parts that a sentence lists
ALIKE = 3.0         # standard errors and deviations within which drifts are alike
NORMAL = 1.4826     # standard deviation of normal numbers over the median distance


@dataclass(frozen=True)
class Point:
    """Something to look at: why, where (a vehicle, or all), and a sentence."""

    why: str
    where: str
    text: str


def points(found: Insight) -> tuple[Point, ...]:
    """
    Return what to look at, the most urgent first.

    What drifts away from the model, what changed, what drifts towards it, which vehicles are odd
    or have an effect that most have not, what the model does not have for any vehicle, which
    flights were not diagnosed, which logs cannot be used, or look wrong, which values are relative
    to another vehicle file; last what is sure but in no verdict, for it hardly moves the vehicle.
    """
    groups: dict[str, list[Point]] = {why: [] for why in (WORSE, CHANGED, DRIFTS, DIFFERS, MODEL,
                                                          FAILED, LOGS, SUSPECT, APART,
                                                          SMALL)}
    together = shared_drifts(found)
    alike = {event for some, _ in together for event in some}
    for event in sorted(found.events, key=lambda one: -one.date.timestamp()):
        if event in alike:
            continue    # one entry says it of all
        why = _why(event)
        groups[why if event.material else SMALL].append(
            Point(why, with_configuration(event.vehicle, event.configuration),
                  event_line(event) + _small(event.material)))
    for some, count in together:
        why = Counter(map(_why, some)).most_common(1)[0][0]
        material = any(event.material for event in some)
        groups[why if material else SMALL].append(Point(
            why, with_configuration('all', some[0].configuration),
            shared_drift_line(some, count) + _small(material)))
    since = {(event.configuration, event.vehicle, part.effect)
             for event in found.events for part in event.parts}
    for odd in found.odd:
        if (odd.configuration, odd.sister.vehicle, odd.effect) in since:
            continue    # it differs because it changed, which another entry says
        groups[DIFFERS if odd.material else SMALL].append(
            Point(DIFFERS, with_configuration(odd.sister.vehicle, odd.configuration),
                  odd_line(odd) + _small(odd.material)))
    told = since | {(odd.configuration, odd.sister.vehicle, odd.effect) for odd in found.odd}
    for one in found.present:
        names = [name for name in one.having if (one.configuration, name, one.effect) not in told]
        if one.vehicles > 1 and not one.shared:
            instead = {name: _instead(one, name, found, told) for name in names}
            if alone := [name for name in names if not instead[name]]:
                groups[DIFFERS].append(Point(
                    DIFFERS, with_configuration(listed(alone), one.configuration),
                    few_line(one, alone, found)))
            groups[SMALL] += [Point(
                DIFFERS, with_configuration(name, one.configuration),
                f'{few_line(one, [name], found)}; single flights show it as {titled(other)}, '
                'which most have, and in which it does not differ from its sisters')
                for name, other in instead.items() if other]
    groups[MODEL] += [Point(MODEL, 'all', shared_line(one, found)) for one in found.present
                      if one.shared]
    groups[FAILED] += _logs(found, FAILED)
    groups[LOGS] += _logs(found, LOGS)
    groups[SUSPECT] += _suspect(found)
    groups[APART] += _apart(found)
    return tuple(point for some in groups.values() for point in some)


def _instead(one: Presence, vehicle: str, found: Insight, told: set[tuple[str, str, str]]) -> str:
    """
    Return the effect of most vehicles that verdicts may have taken for a rarer one, or ''.

    It looks like that, is tracked in its place, and the vehicle does not differ in it: told has
    (configuration, vehicle, effect) of what does.
    """
    for each in found.sisters:
        if (each.configuration == one.configuration and look_alike(each.effect, one.effect)
                and len(each.vehicles) >= sisters.LEAST
                and any(other.shared and (other.configuration, other.effect)
                        == (each.configuration, each.effect) for other in found.present)
                and any(sister.vehicle == vehicle for sister in each.vehicles)
                and (each.configuration, vehicle, each.effect) not in told):
            return each.effect
    return ''


def with_configuration(name: str, configuration: str) -> str:
    """Return the name of a vehicle with that of its configuration, if it has one."""
    return f'{name} ({configuration})' if configuration else name


def of_vehicles(one: Presence) -> str:
    """Return how many vehicles have an effect, and of which configuration they are."""
    return f'{len(one.having)} of {with_configuration(str(one.vehicles), one.configuration)}'


def _why(event: Event) -> str:
    """Return why an event is worth a look: a drift away from no effect is one for the worse."""
    first = event.parts[0]
    if isinstance(first.change, Change):
        return CHANGED
    away = first.level - null_of(first.effect, first.parameter)
    return WORSE if away * first.change.per_week > 0.0 else DRIFTS


def nothing_line(found: Insight) -> str:
    """Return what to say where there is no Point, and whether there could be one."""
    if not found.histories:
        return ('No effect is followed over time, because none can be fitted to single flights: '
                'that takes position or velocity, and thrust also commands that were not scaled '
                'by the weight')
    over_time = any(len(one.series.values) >= history.LEAST for one in found.histories)
    beside = any(len(one.vehicles) >= sisters.LEAST for one in found.sisters)
    return ', and '.join((
        'Nothing drifts or has changed' if over_time else
        f'No vehicle has the {history.LEAST} flights from which on a change can be seen',
        'no vehicle differs from its sisters' if beside else
        f'an odd vehicle can be seen among {sisters.LEAST} or more'))


def event_line(event: Event) -> str:
    """Return a sentence on what happened to a vehicle."""
    first, others = event.parts[0], event.parts[1:NAMED]
    if isinstance(first.change, Drift):
        text = (f'{titled(first.effect)}: {first.parameter} '
                f'{"rises" if first.change.per_week > 0 else "falls"} by '
                f'{sized(abs(first.change.per_week), first.change.std, unit_of(first))} a week')
    else:
        text = (f'from {day(event.date)} on, {titled(first.effect)} differs: {first.parameter} '
                f'by {_signed(first)}; {event.file}, flight {event.number} of '
                f'{event.flights}, is the first after it')
    if others:
        text += ', with ' + ', '.join(
            f'{titled(part.effect)} {part.parameter} {_signed(part)}' for part in others)
    return f'{text} (probability {_probability(event.probability)})'


def shared_drifts(found: Insight) -> list[tuple[list[Event], int]]:
    """
    Return drifts that most vehicles have alike, as those of warmer air, each with how many could.

    A vehicle that drifts otherwise than the others, or with something else, is not among them.
    """
    could = Counter((one.series.configuration, one.series.effect, one.series.parameter)
                    for one in found.histories if len(one.series.values) >= history.LEAST)
    drifts: dict[tuple[str, str, str], list[tuple[Event, Drift]]] = {}
    for event in found.events:
        first = event.parts[0]
        if isinstance(first.change, Drift) and len(event.parts) == 1:
            drifts.setdefault((event.configuration, first.effect, first.parameter), []).append(
                (event, first.change))
    made = []
    for key, some in drifts.items():
        rates = np.array([drift.per_week for _, drift in some])
        away = np.abs(rates - np.median(rates))
        errors = np.hypot([drift.std for _, drift in some], NORMAL * np.median(away))
        near = [event for (event, _), far, error in zip(some, away, errors, strict=True)
                if far <= ALIKE * error]
        if len(near) >= sisters.LEAST and len(near) > MOST * could[key]:
            made.append((near, could[key]))
    return made


def shared_drift_line(some: Sequence[Event], count: int) -> str:
    """Return a sentence on a drift that most of so many vehicles have alike."""
    first = some[0].parts[0]
    rates = [part.change.per_week for event in some for part in event.parts
             if isinstance(part.change, Drift)]
    middle = float(np.median(rates))
    return (f'{titled(first.effect)}: {first.parameter} {"rises" if middle > 0 else "falls"} in '
            f'{len(some)} of {count} vehicles alike, by '
            f'{sized(abs(middle), float(np.std(rates)), unit_of(first))} a week from vehicle to '
            'vehicle: rather season, weather or the wear of all than one vehicle; a column with '
            'the temperature in a manifest takes the weather out')


def odd_line(odd: Odd) -> str:
    """Return a sentence on a vehicle that differs from its sisters."""
    one = odd.sister
    unit, factor = handy(odd.unit, (one.value, odd.mean))
    mine, theirs = (with_error(factor * value, factor * std)
                    for value, std in ((one.value, one.std), (odd.mean, odd.spread)))
    shown = '' if unit in ('1', '') else f' {unit}'
    return (f'{titled(odd.effect)}: {odd.parameter} is {mine}{shown}, that of its {odd.sisters} '
            f'sisters {theirs}{shown} from vehicle to vehicle: off by {abs(one.spreads):.1f} '
            f'times that spread (probability {_probability(one.odd)})')


def shared_line(one: Presence, found: Insight) -> str:
    """Return a sentence on an effect that most vehicles have."""
    values = [f'{each.parameter} {sized(each.mean, each.spread, each.unit)}'
              for each in found.sisters
              if (each.configuration, each.effect) == (one.configuration, one.effect)
              and len(each.vehicles) > 1
              and abs(each.mean - null_of(each.effect, each.parameter)) > 2 * each.spread]
    share = ('' if one.contribution is None else
             f'; without it {100 * min(one.contribution, 1.0):.0f} % of the closable gap would '
             'remain')
    told = (f', {", ".join(values)} from vehicle to vehicle' if values else
            ', each with values of its own')
    remedy = ('add it to the vehicle file' if values else
              'give each vehicle a file of its own with what its diagnosis finds')
    return (f'{of_vehicles(one)} vehicles have {titled(one.effect)}{told}{share}: {remedy}')


def few_line(one: Presence, names: Sequence[str], found: Insight) -> str:
    """Return a sentence on an effect that most vehicles have not, with its sizes in `names`."""
    sizes: dict[str, list[str]] = {name: [] for name in names}
    for each in found.sisters:
        if (each.configuration, each.effect) == (one.configuration, one.effect):
            for sister in each.vehicles:
                if sister.vehicle in sizes:
                    sizes[sister.vehicle].append(
                        f'{each.parameter} {sized(sister.value, sister.std, each.unit)}')
    known = [f'{name} {", ".join(some)}' for name, some in sizes.items() if some]
    return (f'{of_vehicles(one)} vehicles {"has" if len(one.having) == 1 else "have"} '
            f'{titled(one.effect)} in most verdicts, the others do not'
            + (f': {"; ".join(known[:NAMED])}' if known else ''))


def null_of(effect: str, parameter: str) -> float:
    """Return the value of a parameter at which there is no effect."""
    return float(NULL[PLACE[effect, parameter]]) if (effect, parameter) in PLACE else 0.0


def unit_of(part: Part) -> str:
    """Return the unit of a size: per cent, where no effect is a factor of one."""
    whole = part.unit == '1' and null_of(part.effect, part.parameter) == 1.0
    return PER_CENT if whole else part.unit


def day(date: datetime) -> str:
    """Return a date as 14 May 2026."""
    return f'{date.day} {date:%B %Y}'


def summary_line(found: Insight) -> str:
    """Return a sentence on how much was looked at."""
    return (f'{counted(found.flights, "flight")} of {counted(len(found.vehicles), "vehicle")} in '
            f'{counted(sum(found.status.values()), "group")}, {found.status.get("diagnosed", 0)} '
            f'of them diagnosed; {counted(len(found.refused), "flight")} refused'
            + (f', {len(found.failed)} not diagnosed' if found.failed else ''))


def whole_gap_line(found: Insight) -> str:
    """Return a sentence on the gap of the velocity over all groups, where it is known."""
    before, after, noise = (stage['velocity'][0] for stage in (
        found.gap.before, found.gap.after, found.gap.noise))
    return (f'over {counted(found.gap.groups, "group")} of the whole fleet: {before:.3g} m/s '
            f'before, {after:.3g} m/s after, {noise:.3g} m/s of noise')


def known_effect(name: str) -> str:
    """Return the title of an effect, or its name where this version does not know it."""
    return EFFECTS[name].title if name in EFFECTS else name


def _logs(found: Insight, why: str) -> list[Point]:
    """Return a Point for the vehicles whose flights are refused, or not diagnosed, most often."""
    some, said = ((found.refused, 'refused') if why == LOGS else
                  (found.failed, 'not diagnosed, which the next run tries again'))
    if not some:
        return []
    most = Counter(vehicle for vehicle, _, _ in some).most_common(NAMED)
    names = ', '.join(f'{vehicle} {count}' for vehicle, count in most)
    count = len(some)
    return [Point(why, most[0][0], f'{count} of {found.flights} flights '
                  f'{"is" if count == 1 else "are"} {said}: {names}'
                  f'{" and others" if sum(n for _, n in most) < count else ""}; the first: '
                  f'{some[0][2]}')]


def _small(material: bool) -> str:
    return '' if material else '; no verdict names it, so it matters little'


def _suspect(found: Insight) -> list[Point]:
    """Return a Point for the flights that stand apart from others of their vehicle."""
    if not found.suspect:
        return []
    names = listed([f'{vehicle} {file}' for vehicle, file, _ in found.suspect])
    return [Point(SUSPECT, found.suspect[0][0],
                  f'{counted(len(found.suspect), "flight")} '
                  f'{"differs" if len(found.suspect) == 1 else "differ"} from all others of the '
                  f'same vehicle, and changed nothing: {names}; look at their logs')]


def _apart(found: Insight) -> list[Point]:
    """Return a Point for the flights whose values are relative to another nominal vehicle."""
    if not found.apart:
        return []
    names = listed([f'{vehicle} {count}' for vehicle, count in found.apart])
    count = sum(one for _, one in found.apart)
    return [Point(APART, found.apart[0][0],
                  f'{counted(count, "flight")} not compared over time, because their '
                  f'nominal vehicle differs from that of the last flight: {names}; name them '
                  'again with the vehicle file of that flight, or give them a configuration of '
                  'their own')]


def _signed(part: Part) -> str:
    change = part.change
    size = change.size if isinstance(change, Change) else change.per_week
    text = sized(size, change.std, unit_of(part))
    return (text if text.startswith('-') else f'+{text}') + (
        '' if isinstance(change, Change) else ' a week')


def _probability(value: float) -> str:
    return f'{value:.3f}' if value < 0.9995 else 'over 0.999'


def listed(names: Sequence[str]) -> str:
    """Return names with commas, of many the first ones and how many more."""
    more = len(names) - NAMED
    return ', '.join(names[:NAMED]) + (f' and {more} more' if more > 0 else '')


def rows_of(some: Iterable[Point]) -> list[list[str]]:
    """Return a numbered row of text for each Point."""
    return [[str(number), one.where, one.why, one.text] for number, one in enumerate(some, 1)]
