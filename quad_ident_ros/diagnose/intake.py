# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records on their way into a diagnosis: commands, checks, clocks, one split, once."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.data.clocks import Clock, clocks_of, on_one_clock
from quad_ident_ros.data.commands import with_commands
from quad_ident_ros.data.differentiated import with_motion
from quad_ident_ros.data.inertial import is_inertial, POSITION, reckoned, with_position
from quad_ident_ros.data.outputs import BY_MOTORS
from quad_ident_ros.data.quality import cautions, refuse_errors, refuted
from quad_ident_ros.data.quality.finding import as_caution, Finding
from quad_ident_ros.data.quality.fleet import days, vehicles
from quad_ident_ros.data.quality.ground import airborne, stands
from quad_ident_ros.data.quality.gyro import bias
from quad_ident_ros.data.quality.time_scale import of_time
from quad_ident_ros.data.record import FlightRecord, refuse_twice, same_flight
from quad_ident_ros.data.split import joined, spans
from quad_ident_ros.data.thrust_level import on_one_level
from quad_ident_ros.diagnose.blocks import interleaved, spans_seen
from quad_ident_ros.diagnose.result import BLOCKS
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.effects.registry import FORMS, mapping, NULL, PLACE, titled, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import Flight, guided, highest_voltage, moved, Track, track_of
from quad_ident_ros.greybox.near import near_flights
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.greybox.rotor_answer import (
    is_driven_by_speeds,
    NO_COMMANDS,
    OF_MOTORS,
    rotor_answer,
    ruled_out_by,
)
from quad_ident_ros.model.dynamics import course_of, states_of
from quad_ident_ros.model.vehicle import Vehicle

MOST_SHOWN = 8      # blocks that a line names, for display alone; as data there are all


@dataclass(frozen=True, eq=False)
class Intake:
    """
    Flights as a diagnosis takes them.

    tracks: those learnt from; held_out: that which takes no part in fits; flights: the tracks cut
    into rollouts; late: {stream: s} that was moved in each, and clocks: the Clock, or None, of
    each, the one held out last; findings: warnings, as data; refuted: effects of the actuators
    that measured rotor speeds speak against.
    """

    vehicle: Vehicle
    tracks: tuple
    held_out: Track
    flights: list
    late: tuple
    clocks: tuple
    findings: list
    refuted: tuple[str, ...] = ()

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
    where they are too faulty or too short to diagnose.
    """
    records = joined(records)
    if hold_out is not None:    # among others it would take part in fit and choice
        records = [record for record in records if not same_flight(record, hold_out)]
    refuse_twice(records)
    held = [] if hold_out is None else [hold_out]
    every = on_one_level([with_commands(with_motion(record), vehicle)
                          for record in (*records, *held)])
    records, hold_out = (every, None) if hold_out is None else (every[:-1], every[-1])
    findings: list[dict] = []
    vehicle = _beside_records(vehicle, every, findings)
    if not all(record.info.get(BY_MOTORS) for record in every):
        vehicle = replace(vehicle, motors=None)     # its uncertainty is not that of these commands
    wrong = refuted([*records, *([] if hold_out is None else [hold_out])], vehicle)
    findings += [*vehicles(every), *days(every)]
    records = [_fit_for_use(record, vehicle, rules, wrong, findings) for record in records]
    if hold_out is not None:
        hold_out = _fit_for_use(hold_out, vehicle, rules, wrong, findings)
    if not records:
        raise InputError('no flight to fit: name at least one flight record in addition to the '
                         'one that is held out')
    alone = hold_out is None and len(records) == 1
    every = [*records, *([] if hold_out is None else [hold_out])]
    every, vehicle = _with_states(every, vehicle, findings)
    count = len(every) if alone else len(every) - 1
    every, late, answers = map(list, zip(*on_one_clock(every[:count], every[count:]), strict=True))
    learnt = every[:count]
    voltage = highest_voltage(learnt)
    clocks = clocks_of(answers[:len(learnt)], answers[len(learnt):])
    ruled_out = _of_rotors(every, vehicle, clocks, len(learnt), rules, findings)
    tracks = [guided(track_of(record, vehicle, voltage, clock))
              for record, clock in zip(every, clocks, strict=True)]
    if alone:
        tracks, late, clocks = list(interleaved(tracks[0], rules.held_block)), 2 * late, 2 * clocks
        findings.append(_halves(tracks[1], every[0], rules))
    *tracks, held_out = tracks
    return Intake(vehicle, tuple(tracks), held_out, rollouts(tracks, vehicle), tuple(late),
                  tuple(clocks), findings, ruled_out)


def lacking(record: FlightRecord, vehicle: Vehicle) -> tuple[Finding, ...]:
    """Return the Finding that says which columns a flight would need for a diagnosis, if any."""
    try:
        record = with_commands(with_motion(record), vehicle)
        course_of(record, vehicle)
        if not is_inertial(record):
            states_of(with_position(record))
    except InputError as error:
        name = record.info.get('source') or record.info.get('name', 'flight')
        why = str(error).removeprefix(f'{name}: ').replace(f'{name} has', 'it has', 1)
        return Finding('lacking', 'warning', 'columns',
                       f'diagnose and fit refuse this flight: {why}', ''),
    return ()


def _beside_records(vehicle: Vehicle, records: Sequence[FlightRecord], findings: list) -> Vehicle:
    """
    Return the vehicle with those of its effects that act beside what is taken from the records.

    Measured rotor speeds have gone through the motors; where accelerometer and gyro alone were
    recorded the force of the air is among what they measured, and nothing is known of the place;
    ground acts only at a known height. The findings say what is left out. Raises
    InputError where motors act on the commands of some records alone.
    """
    driven = [is_driven_by_speeds(record) for record in records]
    motors = [name for name in OF_MOTORS if name in vehicle.effects]
    if motors and any(driven) and not all(driven):
        [with_commands, without] = (records[driven.index(kind)].info.get('source', 'a flight')
                                    for kind in (False, True))
        raise InputError(f'{without} has measured rotor speeds alone, and {with_commands} has '
                         f'commands: with {titled(motors[0])} in the vehicle '
                         'file, diagnose them separately')
    inertial = any(is_inertial(record) for record in records)
    no_height = not all(record.has(*POSITION) for record in records)
    gone = {PLACE[name, parameter.name] for name, form in FORMS for parameter in form.parameters
            if name in OF_MOTORS and any(driven) or inertial and form.needs_reference
            or no_height and form.needs_height}
    theta = vector(vehicle.effects, vehicle)
    known, theta[list(gone)] = mapping(theta), NULL[list(gone)]
    kept = mapping(theta)
    names = [name for name in known if kept.get(name) != known[name]]
    if names:
        findings.append({
            'flight': 'all flights', 'code': 'left_out', 'severity': 'info',
            'where': 'vehicle file',
            'message': f'{", ".join(map(titled, names))} of the vehicle file is omitted from '
                       'the nominal model: the measurements of these records contain its '
                       'action already, or the height that it needs is missing',
            'remedy': 'nothing to do; records with commands, position and velocity show it'})
    return replace(vehicle, effects=kept)


def _of_rotors(records: Sequence[FlightRecord], vehicle: Vehicle, clocks: Sequence[Clock | None],
               learnt: int, rules: Rules, findings: list) -> tuple[str, ...]:
    """
    Return the effects that measured rotor speeds of the first, learnt, records speak against.

    What they say in each is added to the findings.
    """
    measured = [record for record in records if is_driven_by_speeds(record)]
    if measured:
        findings += [as_caution(NO_COMMANDS, record) for record in measured]
        return OF_MOTORS
    told = [answer if answer and answer.explained >= rules.follows else None
            for answer in map(rotor_answer, records)]
    # Commands of another clock than the states': whose clock the speeds have is not known.
    ruled_out = ruled_out_by([
        replace(answer, delay=(answer.delay[0], np.inf)) if answer and clock and clock.late
        else answer for answer, clock in zip(told[:learnt], clocks, strict=False)],
        rules.shown, vehicle.effects)
    names = [f'a {titled(name)} other than that of the vehicle file' if name in vehicle.effects
             else titled(name) for name in ruled_out]
    so = f'; this rules out {" and ".join(names)}' if names else ''
    findings += [as_caution(Finding('rotor_answer', 'info', 'rotor1, rotor2, ...',
                                    answer.said() + so,
                                    'nothing to do if this is right'), record)
                 for answer, record in zip(told, records, strict=True) if answer is not None]
    return ruled_out


def _with_states(records: list[FlightRecord], vehicle: Vehicle, findings: list
                 ) -> tuple[list[FlightRecord], Vehicle]:
    """
    Return records with the states that they need, and the vehicle to hold them against.

    Where they have accelerometer and gyro alone, states are reckoned, and the drag of the vehicle
    file is left out: what the air does across the thrust is in the specific force. The findings
    say so.
    """
    inertial = [is_inertial(record) for record in records]
    if not any(inertial):
        return [with_position(record) for record in records], vehicle
    if not all(inertial):
        [with_states, without] = (records[inertial.index(kind)].info.get('source', 'a flight')
                                  for kind in (False, True))
        raise InputError(f'{without} has neither position nor velocity, and {with_states} has: '
                         'diagnose flights with and without them separately')
    findings.append({
        'flight': 'all flights', 'code': 'inertial', 'severity': 'info',
        'where': 'accelerometer and gyro alone',
        'message': 'position, velocity and attitude are integrated from them, which holds for a '
                   'tenth of a second; the force across the thrust is taken from the record, so '
                   'drag, wind, tilts and biases of sensors, and heights are not visible, except '
                   'for the bias of the gyro while the vehicle is on the ground',
        'remedy': 'log position and velocity, of an estimator or of motion capture'})
    return ([reckoned(record, vehicle.gravity) for record in records],
            replace(vehicle, linear_drag=(0.0, 0.0, 0.0)))


def _fit_for_use(record: FlightRecord, vehicle: Vehicle, rules: Rules, wrong: Collection[str],
                 findings: list) -> FlightRecord:
    """Return a record off the ground, its cautions added to the findings; wrong: as refuted."""
    ground = [*stands(record, vehicle), *bias(record, vehicle)]
    refuse_errors(record, ground)
    findings += [as_caution(finding, record) for finding in ground]
    whole, record = record, airborne(record, vehicle)
    if 'whole' in whole.info:
        findings.append(as_caution(_cut(record), record))
    refuse_short(record, rules, ' off the ground' if len(record) < len(whole) else '')
    findings += [one for one in cautions(record, vehicle, wrong)
                 if one['code'] not in {finding.code for finding in ground}]
    return record


def _cut(record: FlightRecord) -> Finding:
    """Return the Finding that says which parts of a recording are used, and what split it."""
    used = ' and '.join(f't = {begin:.2f} to {end:.2f} s' for begin, end in spans(record))
    resets = record.info.get('resets')
    why = f'; it was split where the estimator was reset: {resets}' if resets else ''
    return Finding('kept', 'info', used, f'this part of the recording is used{why}',
                   'nothing to do; --segment, --from and --to choose another part')


def _halves(held_out: Track, record: FlightRecord, rules: Rules) -> dict:
    """Return the finding that says which blocks of a single flight are held out, as data."""
    spans = spans_seen(held_out, rules.held_block)
    shown = ', '.join(f'{begin:.2f} to {end:.2f}' for begin, end in spans[:MOST_SHOWN])
    more = f' s and {len(spans) - MOST_SHOWN} more' if len(spans) > MOST_SHOWN else ' s'
    finding = Finding(BLOCKS, 'info', f't = {shown}{more}',
                      'held out: of each two consecutive blocks one, chosen so that both halves '
                      'of the flight move alike',
                      'nothing to do; --hold-out FLIGHT holds out another flight')
    return {**as_caution(finding, record), 'spans': [list(span) for span in spans]}


def rollouts(tracks: Sequence[Track], vehicle: Vehicle) -> list[Flight]:
    """Return the Flights of Tracks, cut so that the nominal vehicle stays near the record."""
    return near_flights(tracks, vehicle, nominal(vehicle))


def length_of(record: FlightRecord) -> float:
    """Return the length of a flight record, s; a nanosecond counts for nothing."""
    return round(float(record.t[-1] - record.t[0]) + record.period(), 6)


def refuse_short(record: FlightRecord, rules: Rules, where: str = '') -> None:
    """Raise InputError where a flight record, where it was cut to, is too short."""
    if length_of(record) < rules.shortest:
        refuse_errors(record, of_time(record, None))    # in minutes it would be short, too
        name = record.info.get('source') or record.info.get('name', 'a record')
        raise InputError(f'{name}: {length_of(record):.3g} s{where} are '
                         f'too short for a diagnosis; at least {rules.shortest:g} s are needed')
