# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The diagnosis of flights: intake, selection, judgement, measure, advice."""

from collections.abc import Callable, Iterable

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.arguments import flight_records, instance, READ, vehicle_given
from quad_ident_ros.closed_loop.controller import NamedController
from quad_ident_ros.closed_loop.reference import reference_of
from quad_ident_ros.data.record import FlightRecord, same_flight
from quad_ident_ros.data.split import joined
from quad_ident_ros.diagnose import advice, measure
from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.candidates import candidates
from quad_ident_ros.diagnose.ceiling import ceiling_of
from quad_ident_ros.diagnose.form_unknown import effects_of_unknown_form
from quad_ident_ros.diagnose.gusts import beside_gusts
from quad_ident_ros.diagnose.in_closed_loop import in_closed_loop
from quad_ident_ros.diagnose.in_simulator import gap_in_simulator, refuse_inertial
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.judgement import judge, pooled
from quad_ident_ros.diagnose.like_feedback import is_like_feedback, with_like_feedback
from quad_ident_ros.diagnose.nuisances import as_data as nuisances_as_data
from quad_ident_ros.diagnose.nuisances import late_states
from quad_ident_ros.diagnose.provenance import recorded
from quad_ident_ros.diagnose.ratios import in_fewest
from quad_ident_ros.diagnose.result import Diagnosis
from quad_ident_ros.diagnose.rules import RULES, Rules
from quad_ident_ros.diagnose.select import select
from quad_ident_ros.diagnose.together import known_together
from quad_ident_ros.diagnose.verdict import verdict_of
from quad_ident_ros.effects.registry import EFFECTS, titled
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.noise import whole_noise
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.memory import give_back
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.user_simulator.simulator import Simulator


def diagnose(records: Iterable[FlightRecord], vehicle: Vehicle, *,
             hold_out: FlightRecord | None = None, effects: list[str] | None = None,
             rules: Rules = RULES, simulator: Simulator | None = None,
             controller: NamedController | None = None,
             on_progress: Callable[[float], None] = lambda share: None) -> Diagnosis:
    """
    Return the Diagnosis of flight records against a nominal vehicle and the effects that it has.

    Args: hold_out: a record that takes no part in fits and search, by default the last one
    (half of the blocks of a single one); effects: names that may be named, by default all; rules:
    thresholds of the verdict; simulator: of the user, in which the flights are predicted, too;
    controller: whose tracking of the flight held out is compared with and without the effects;
    on_progress is called with the share done.
    Raises InputError where the records are too faulty to diagnose.
    """
    for name in effects or ():
        if name not in EFFECTS:
            raise schema.unknown_key('effects', name, EFFECTS)
    vehicle_given(vehicle)
    given = flight_records('records', records)
    if hold_out is not None:
        instance('hold_out', hold_out, FlightRecord, READ)

    def told(share: float) -> None:     # flying in a simulator of the user takes as long
        on_progress(share if simulator is None else 0.5 * share)

    reference = (None if controller is None or not given
                 else reference_of(joined(given)[-1] if hold_out is None else hold_out))
    came = recorded(given if hold_out is None else [
        *(record for record in given if not same_flight(record, hold_out)), hold_out])
    intake = take_in(given, vehicle, hold_out, rules)
    del given
    give_back()
    if simulator is not None:
        refuse_inertial(intake.flights)
    vehicle = intake.vehicle
    every = candidates(intake.flights, vehicle, rules, effects)
    causes = tuple(cause for cause in every if cause.effect not in intake.refuted)
    ruled_out = tuple(dict.fromkeys(cause.effect for cause in every if cause not in causes))
    if not causes:
        asked = ', '.join(map(titled, effects)) if effects else 'any effect'
        gone = ' and '.join(map(titled, ruled_out))
        raise InputError(f'these flights say nothing about {asked}: '
                         + (f'measured rotor speeds rule out {gone}'
                            if ruled_out else 'docs/diagnosis.md says what they would need')
                         + '; name other effects')
    early = tuple(cause for cause in causes if not is_like_feedback(cause))
    selection = select(intake.flights, vehicle, early, rules,
                       lambda share: told(0.7 * share))
    prompt = late_states(selection, intake.flights, vehicle, rules)
    if prompt:
        intake = intake.shifted(prompt)
        selection = select(intake.flights, vehicle, early, rules,
                           lambda share: told(0.7 + 0.05 * share))
    bench = Bench.of(intake.flights, (*intake.tracks, intake.held_out), vehicle, selection, rules)
    bench, judged = in_fewest(bench, judge(bench))
    bench, judged, causes = with_like_feedback(bench, judged, causes,
                                               lambda share: told(0.75 + 0.05 * share))
    told(0.8)
    bench, judged = beside_gusts(bench, judged, causes,
                                 lambda share: told(0.8 + 0.1 * share))
    selection, noise = bench.selection, bench.noise
    told(0.9)
    z0, model = nominal(vehicle), judged.model
    whole = np.median([whole_noise(raw, 1.0 - 1.0 / raw.shape[1])
                       for raw in model.estimate.residuals], axis=0)
    before = measure.residual_wrenches(bench, [z0 + z - model.z for z in model.vectors],
                                       noise.deviation)
    after = measure.residual_wrenches(bench, model.vectors, whole)
    remains = measure.unexplained(judged.open_groups, measure.channels(after, vehicle, rules))
    form_unknown = effects_of_unknown_form(bench, judged, remains, after, whole)
    verdict = verdict_of(bench, judged, causes, ruled_out, form_unknown)
    gap, given_attitude = (measure.open_loop_gap(bench, judged),
                           measure.gap_given_attitude(bench, judged))
    ceiling, residual = ceiling_of(bench, judged, after, whole, gap, given_attitude)
    told(0.95)
    closed_loop = None if controller is None or reference is None else in_closed_loop(
        controller, reference, bench, judged, lambda share: told(0.95 + 0.05 * share))
    in_simulator = None if simulator is None else gap_in_simulator(
        simulator, bench, judged, lambda share: on_progress(0.5 + 0.5 * share))
    unseen = advice.not_shown(selection, causes, verdict, rules)
    return Diagnosis(
        vehicle=vehicle, verdict=verdict.names, minor=verdict.minor, ranking=verdict.ranking,
        where=measure.channels(before, vehicle, rules), gap=gap, gap_given_attitude=given_attitude,
        ceiling=ceiling,
        tolerance={name: rules.tolerance(name, value)
                   for name, value in pooled(judged.noise).items()},
        unknown=remains if judged.unexplained or form_unknown else (),
        form_unknown=tuple(form_unknown),
        undetermined=verdict.undetermined, sure=verdict.sure,
        one_finding=advice.one_finding(verdict, intake.flights, noise.command_errors),
        not_shown=tuple(dict.fromkeys(
            (*unseen, *advice.cannot_show(intake.flights, verdict)))),
        fly_next=advice.fly_next(selection, intake.flights, vehicle, model.z, verdict, unseen,
                                 rules),
        nuisances=nuisances_as_data(
            tuple(cause.nuisance for cause in selection.best.chosen if cause.nuisance),
            [z - model.z for z in judged.fitted.vectors], intake.late, intake.clocks, prompt),
        flights=intake.names[:-1], held_out=intake.names[-1],
        flight_checks=verdict.flight_checks,
        findings=(*intake.findings, *advice.at_bounds(judged, vehicle, rules),
                  *advice.by_input_errors(judged, noise.command_errors)), z=model.z,
        pictures=measure.pictures(bench, judged, before, after),
        covariance=known_together(bench, model, judged.probability), in_simulator=in_simulator,
        closed_loop=closed_loop, residual=residual, recorded=came,
        form_errors=selection.joint.form_errors)
