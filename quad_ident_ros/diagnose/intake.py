# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records on their way into a diagnosis: commands, checks, clocks, one split, once."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from quad_ident_ros.data.clocks import clocks_of, on_one_clock
from quad_ident_ros.data.inertial import is_inertial, reckoned
from quad_ident_ros.data.quality import cautions, refuse_errors, refuted
from quad_ident_ros.data.quality.finding import as_caution
from quad_ident_ros.data.quality.ground import airborne, stands
from quad_ident_ros.data.record import FlightRecord, refuse_twice, same_flight
from quad_ident_ros.diagnose.blocks import interleaved
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import Flight, guided, highest_voltage, moved, Track, track_of
from quad_ident_ros.greybox.near import near_flights
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.mixing import with_commands
from quad_ident_ros.model.vehicle import Vehicle


@dataclass(frozen=True, eq=False)
class Intake:
    """
    Flights as a diagnosis takes them.

    tracks: those learnt from; held_out: that which takes no part; flights: the tracks cut into
    rollouts; late: {stream: s} that was moved in each, and clocks: the Clock, or None, of each,
    the one held out last; findings: what to be wary of, as data.
    """

    vehicle: Vehicle
    tracks: tuple
    held_out: Track
    flights: list
    late: tuple
    clocks: tuple
    findings: list

    @property
    def names(self) -> tuple:
        """Return the names of the flights, the one held out last."""
        return tuple(track.name for track in (*self.tracks, self.held_out))

    def shifted(self, prompt: float) -> 'Intake':
        """Return the Intake with all commands so many s later."""
        tracks = tuple(moved(track, prompt) for track in self.tracks)
        return replace(self, tracks=tracks, held_out=moved(self.held_out, prompt),
                       flights=rollouts(tracks, self.vehicle))


def take_in(records: Sequence[FlightRecord], vehicle: Vehicle, hold_out: FlightRecord | None,
            rules: Rules) -> Intake:
    """
    Return the Intake of flight records.

    The last one is held out, or hold_out, or blocks of a single one. Raises InputError
    for a fault that no verdict survives, and where there is too little.
    """
    if hold_out is not None:    # among others it would take part in fit and choice
        records = [record for record in records if not same_flight(record, hold_out)]
    refuse_twice(records)
    records = [with_commands(record, vehicle) for record in records]
    hold_out = None if hold_out is None else with_commands(hold_out, vehicle)
    wrong = refuted([*records, *([] if hold_out is None else [hold_out])], vehicle)
    findings: list[dict] = []
    records = [_fit_for_use(record, vehicle, rules, wrong, findings) for record in records]
    if hold_out is not None:
        hold_out = _fit_for_use(hold_out, vehicle, rules, wrong, findings)
    if not records:
        raise InputError('no flight to learn from: name at least one flight record beside the one '
                         'that is held out')
    alone = hold_out is None and len(records) == 1
    every = [*records, *([] if hold_out is None else [hold_out])]
    every, vehicle = _with_states(every, vehicle)
    every, late, answers = map(list, zip(*on_one_clock(every), strict=True))
    learnt = every if alone else every[:-1]
    voltage = highest_voltage(learnt)
    clocks = clocks_of(answers[:len(learnt)], answers[len(learnt):])
    tracks = [guided(track_of(record, vehicle, voltage, clock))
              for record, clock in zip(every, clocks, strict=True)]
    if alone:
        tracks, late, clocks = list(interleaved(tracks[0])), 2 * late, 2 * clocks
    *tracks, held_out = tracks
    return Intake(vehicle, tuple(tracks), held_out, rollouts(tracks, vehicle), tuple(late),
                  tuple(clocks), findings)


def _with_states(records: list[FlightRecord], vehicle: Vehicle
                 ) -> tuple[list[FlightRecord], Vehicle]:
    """
    Return records with the states that they need, and the vehicle to hold them against.

    Where they have accelerometer and gyro alone, states are reckoned, and the drag of the vehicle
    file is left out: what the air does across the thrust is in the specific force.
    """
    inertial = [is_inertial(record) for record in records]
    if not any(inertial):
        return records, vehicle
    if not all(inertial):
        [with_states, without] = (records[inertial.index(kind)].info.get('source', 'a flight')
                                  for kind in (False, True))
        raise InputError(f'{without} has neither position nor velocity, and {with_states} has: '
                         'diagnose flights with and without them apart')
    return ([reckoned(record, vehicle.gravity) for record in records],
            replace(vehicle, linear_drag=(0.0, 0.0, 0.0)))


def _fit_for_use(record: FlightRecord, vehicle: Vehicle, rules: Rules, wrong: Collection[str],
                 findings: list) -> FlightRecord:
    """Return a record off the ground, its cautions added to the findings; wrong: as refuted."""
    ground = stands(record, vehicle)
    refuse_errors(record, ground)
    findings += [as_caution(finding, record) for finding in ground]
    record = airborne(record, vehicle)
    refuse_short(record, rules)
    findings += [one for one in cautions(record, vehicle, wrong)
                 if one['code'] not in {finding.code for finding in ground}]
    return record


def rollouts(tracks: Sequence[Track], vehicle: Vehicle) -> list[Flight]:
    """Return the Flights of Tracks, cut so that the nominal vehicle stays near the record."""
    return near_flights(tracks, vehicle, nominal(vehicle))


def length_of(record: FlightRecord) -> float:
    """Return the length of a flight record, s; a nanosecond counts for nothing."""
    return round(float(record.t[-1] - record.t[0]) + record.period(), 6)


def refuse_short(record: FlightRecord, rules: Rules) -> None:
    """Raise InputError where a flight record is too short for a diagnosis."""
    if length_of(record) < rules.shortest:
        name = record.info.get('source') or record.info.get('name', 'a record')
        cut = ' off the ground' if 'began' in record.info else ''
        raise InputError(f'{name}: {length_of(record):.3g} s{cut} are '
                         f'too short for a diagnosis; at least {rules.shortest:g} s are needed')
