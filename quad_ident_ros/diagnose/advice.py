# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the flights could not show or separate, and what would."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.diagnose import fly_next as design
from quad_ident_ros.diagnose.bench import Model
from quad_ident_ros.diagnose.candidates import Candidate, SCALES, unobservable
from quad_ident_ros.diagnose.fitted import columns_at_bounds
from quad_ident_ros.diagnose.judgement import in_forms_of, Judgement
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.selection import Selection
from quad_ident_ros.diagnose.verdict import Verdict
from quad_ident_ros.effects.base import Effect, Form
from quad_ident_ros.effects.registry import EFFECTS, PARAMETERS
from quad_ident_ros.greybox.flights import Flight, inertial, RATE
from quad_ident_ros.greybox.parameters import NAMES, SPLIT
from quad_ident_ros.model.vehicle import Vehicle

AT_THE_RATE = 'log commands at the rate of the controller, and measure the constant'


def not_shown(selection: Selection, causes: tuple, verdict: Verdict, rules: Rules
              ) -> tuple[str, ...]:
    """Return the names of effects that the flights would not show at their usual size."""
    named = {*verdict.sure, *verdict.undetermined}
    return tuple(design.hidden(selection, [cause for cause in causes if cause.effect not in named],
                               list(verdict.certain), rules))


def cannot_show(flights: Sequence[Flight], verdict: Verdict) -> tuple[str, ...]:
    """Return the names of effects that no flights with commands like these would show."""
    named, unseen = {*verdict.sure, *verdict.undetermined}, unobservable(flights)
    if not any(flight.levelled for flight in flights):
        return unseen
    scales = {NAMES[column].partition('.')[0] for column in SCALES}
    return (*unseen, *(name for name in EFFECTS if name in scales - named))


def fly_next(selection: Selection, flights: list, vehicle: Vehicle, z: np.ndarray,
             verdict: Verdict, unseen: tuple, rules: Rules) -> list | None:
    """Return what to fly next, as data, where the verdict leaves something open, else None."""
    if not (verdict.doubts or verdict.names == ('none',)) or inertial(flights):
        return None
    return design.fly_next(selection, flights, vehicle, z, verdict.certain, verdict.doubts,
                           unseen, rules) or None


def at_bounds(judged: Judgement, vehicle: Vehicle, rules: Rules) -> tuple[dict, ...]:
    """Return warnings on parameters of a model that end at bounds, as data of findings."""
    rows = []
    for cause in judged.model.effects:
        names, of = _values_at_bounds(judged.model, cause, vehicle, rules), ''
        if not names and cause in judged.stand_ins:
            names = _values_at_bounds(judged.essential, cause, vehicle, rules)
            of = ', without the effects that do not matter,'
        so = ('; it stays in the model in its place and is not named'
              if cause in judged.stand_ins else '')
        if names:
            whose, such, remedy = (
                ('vehicles have', 'commands that are logged more slowly than they are given',
                 AT_THE_RATE) if not EFFECTS[cause.effect].needs_air else
                ('steady air over ground has', 'another force, or positions with a wrong scale',
                 'check the scale and the level of the positions'))
            rows.append({
                'flight': 'all flights', 'code': 'at_bound', 'severity': 'warning',
                'where': cause.effect,
                'message': f'{", ".join(names)}{of} is the bound of what {whose}, and the best '
                           f'value lies beyond it: the effect may stand in for another cause, '
                           f'such as {such}{so}',
                'remedy': remedy})
    return tuple(rows)


def _values_at_bounds(model: Model, cause: Candidate, vehicle: Vehicle, rules: Rules) -> list[str]:
    """Return the parameters of an effect that end at bounds in a Model, in words."""
    [cause] = in_forms_of(model.effects, [cause])
    held = {PARAMETERS[column - SPLIT][1]: model.z[column]
            for column in columns_at_bounds(cause, model.z, vehicle, rules)}
    return [f'{one.name} {value:.3g}{"" if one.unit == "1" else f" {one.unit}"}'
            for one, value in held.items()]


def by_input_errors(judged: Judgement, command_errors: bool) -> tuple[dict, ...]:
    """Return what errors of the commands may have made, as data of findings."""
    rows = []
    if command_errors:
        rows.append({
            'flight': 'all flights', 'code': 'input_errors', 'severity': 'info',
            'where': 'commands',
            'message': 'the rates follow the commands of the samples before more closely than '
                       'the model does: the controller gives commands between the samples of '
                       'the log, or the vehicle answers later, or the gyro is filtered; how '
                       'strongly it answers counts by earlier commands alone, and remaining '
                       'gaps may be due to this',
            'remedy': 'log commands at the rate of the controller, and the gyro unfiltered'})
    for cause in judged.model.effects:
        ranges = [f'{NAMES[column].split(".")[1]} {least:.2g} to {most:.2g}'
                  for column, (least, most) in judged.by_commands.items()
                  if column in cause.columns]
        so = '; it stays in the model in its place and is not named'
        if ranges:
            rows.append({
                'flight': 'all flights', 'code': 'input_errors', 'severity': 'warning',
                'where': cause.effect,
                'message': f'these flights allow {", ".join(ranges)}, which includes no '
                           'difference: a vehicle seems to answer less than it does if the '
                           'commands have errors, as in a log that is slower than the controller'
                           f'{so if cause in judged.stand_ins else ""}',
                'remedy': AT_THE_RATE})
    return tuple(rows)


def one_finding(verdict: Verdict, flights: Sequence[Flight], command_errors: bool
                ) -> tuple[dict, ...]:
    """
    Return what each named effect may be as well, and what measurement would decide, as data.

    effects: names that the flights do not separate. Thrust and mass are separated by
    the moments, so not where the inertia is found to differ, too, or errors of the commands make
    the answer to moments seem weaker. A lag and a delay are not
    separated where both are over before the next sample, nor from a gyro that is as late.
    """
    rows, named = [], [name for name in verdict.names if name in EFFECTS]
    loose = command_errors or any(
        EFFECTS[name].scale_group and EFFECTS[name].ratio is None for name in named)
    forms = {row.effect: row.form for row in verdict.ranking}
    for effect in (EFFECTS[name] for name in named):
        ratio = [name for name, other in EFFECTS.items()
                 if effect.ratio is not None and other.ratio == effect.ratio]
        known: list[tuple[Effect | Form, list[str]]] = [
            (effect, sorted(ratio) if loose and ratio else [effect.name]),
            *((form, [effect.name]) for form in effect.forms
              if form.name == forms.get(effect.name))]
        rows += [{'effect': effect.name, 'may_be': [list(pair) for pair in one.same_motion],
                  'effects': effects, 'tells': one.separated_by}
                 for one, effects in known if one.same_motion]
    late = sorted(name for name, effect in EFFECTS.items() if effect.actuator)
    slow = 1.0 / max(flight.period for flight in flights) < RATE / 2
    faster = f', or a log of {RATE:.0f} Hz and more' if slow else ''
    tells = f'measured rotor speeds{faster}: it is over before the next sample that is compared'
    rows += [{'effect': name, 'effects': late, 'tells': tells,
              'may_be': [[*(EFFECTS[other].title for other in late if other != name),
                          'low pass of the gyro']]}
             for name in verdict.brief]
    return tuple(rows)
