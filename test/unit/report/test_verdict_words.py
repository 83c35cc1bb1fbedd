# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is said of an effect whose law is none of its forms, and of gusts."""

from dataclasses import replace

from published import diagnosis
import pytest

from quad_ident_ros.diagnose.result import Unexplained
from quad_ident_ros.report.diagnosis import caution_lines
from quad_ident_ros.report.verdict import next_step, verdict_line

FOUND = diagnosis(form_unknown=('rotor_drag',))
ROW = replace(FOUND.ranking[0], explained=0.413)
GUSTS = {'gusts': {'what': 'wind that changes along a flight', 'unit': 'm/s',
                   'values': [[1.2] * 16], 'held_out': [-1.2] * 16}}


@pytest.mark.parametrize('shown', [(), ('force',)])
def test_a_residual_function_is_proposed_only_where_it_is_shown_to_help(shown):
    found = replace(FOUND, ceiling=replace(FOUND.ceiling, shown=shown))
    assert ('--residual' in next_step(found)) == bool(shown)
    assert '"unexplained"' in next_step(found) and next_step(found).endswith('.')


@pytest.mark.parametrize('probability', [0.3, 0.9])
def test_an_effect_of_unknown_form_is_said_to_be_one_however_probable_it_is(probability):
    found = replace(FOUND, ranking=(replace(ROW, probability=probability),))
    assert ('uncertain' in verdict_line(found)) == (probability < 0.5)
    assert ('drag of the rotors (rotor_drag), form unknown: 41 % of it explained by by_speed, '
            'coefficient 0.2') in verdict_line(found)


@pytest.mark.parametrize(('channel', 'unit'), [('Fx', 'N'), ('My', 'N m')])
def test_gusts_are_said_to_fit_only_what_is_a_force(channel, unit):
    remains = Unexplained(channel, 'everywhere', 1.0, (0.1, 0.2), 0.3, unit)
    found = diagnosis(verdict=('rotor_drag', 'unknown'), unknown=(remains,), nuisances=GUSTS)
    said = '; a wind that changes by 1.2 m/s along each flight would fit what is unknown'
    assert (said in verdict_line(found)) == (unit == 'N')


def test_gusts_are_said_last_of_effects_that_are_more_than_one_or_uncertain():
    remains = Unexplained('Fx', 'everywhere', 1.0, (0.1, 0.2), 0.3, 'N')
    unsure, wind = replace(ROW, probability=0.3), replace(ROW, effect='wind', parameters={})
    for verdict, ranking in ((('rotor_drag', 'unknown'), (unsure,)),
                             (('rotor_drag', 'wind', 'unknown'), (ROW, wind))):
        line = verdict_line(diagnosis(verdict=verdict, ranking=ranking, unknown=(remains,),
                                      nuisances=GUSTS))
        assert line.endswith('would fit what is unknown, but no simulation predicts it')


def test_no_one_is_asked_to_mend_gusts():
    off = replace(FOUND.gap, before=dict.fromkeys(FOUND.gap.before, 0.2))
    bias = {'what': 'bias of the rate', 'unit': 'rad/s', 'values': [[0.1]], 'held_out': [0.1]}
    found = diagnosis(verdict=('none',), gap=off, nuisances={**GUSTS, 'rate_bias': bias},
                      tolerance=dict.fromkeys(off.before, 0.02))
    assert 'mend rate_bias of the flights' in next_step(found)
    assert 'gusts' not in verdict_line(found)


TOLERANCE = {'position': 0.01, 'velocity': 0.03, 'attitude': 0.012, 'rate': 0.05}
OFF = {'position': 0.05, 'velocity': 0.3, 'attitude': 0.02, 'rate': 0.1}


def of_another(verdict=('rotor_drag',), before=None, after=None, low=0.8, **changes):
    """Return a diagnosis whose held-out flight has a gap before and, with what is named, after."""
    before, after = {**OFF, **(before or {})}, {**OFF, 'velocity': 0.9, **(after or {})}
    gap = replace(FOUND.gap, before={**before, 'velocity': 2.0}, before_own=before, after=after,
                  after_interval={**FOUND.gap.after_interval, 'velocity': (low, 1.0)},
                  closed=-1.0)
    return diagnosis(verdict=verdict, gap=gap, tolerance=TOLERANCE, **changes)


BETTER = 'of circle, which was not used for fitting, is predicted better without'


@pytest.mark.parametrize(('found', 'said'), [
    (of_another(), ('explains the gap of the flights that were fitted; the velocity', 'it')),
    (of_another(('rotor_drag', 'unknown')),
     ('explains part of the gap of the flights that were fitted, and the rest is unknown', 'it')),
    (of_another(('rotor_drag', 'wind'),
                ranking=(ROW, replace(ROW, effect='wind', parameters={}))),
     ('2 effects explain the gap of the flights that were fitted: ', 'them')),
    (of_another(ranking=(replace(ROW, probability=0.3),)),
     ('the best known explanation of the gap of the flights that were fitted is less', 'it'))],
    ids=['one', 'unknown', 'two', 'uncertain'])
def test_effects_that_a_held_out_flight_has_not_are_those_of_the_flights_that_were_fitted(
        found, said):
    line, (words, them) = verdict_line(found), said
    assert words in line and line.endswith(f'{BETTER} {them}') and 'velocity gap' not in line
    assert 'same payload and propellers' in next_step(found)
    assert any('predicts it worse' in one for one in caution_lines(found))


SINGLE = ({'flight': 'a', 'code': 'blocks', 'severity': 'info', 'where': 't', 'message': 'm',
           'remedy': ''},)


@pytest.mark.parametrize('found', [
    of_another(low=0.2), of_another(before={'velocity': 0.9}),
    of_another(before={'velocity': 0.01}, after={'velocity': 0.02}, low=0.015),
    of_another(before={'rate': 0.5}), of_another(findings=SINGLE), of_another(('undetermined',))],
    ids=['by chance', 'alike', 'within tolerance', 'rate', 'half of one flight', 'undetermined'])
def test_what_may_be_chance_or_helps_elsewhere_is_no_other_vehicle(found):
    assert 'fitted' not in verdict_line(found).partition('which was not used for')[0]
    assert 'payload' not in next_step(found)
    assert any('predicts it worse' in one for one in caution_lines(found))


def test_where_commands_are_lacking_the_simulation_is_not_said_to_match():
    lacking = {'flight': 'all flights', 'code': 'input_errors', 'severity': 'info',
               'where': 'commands', 'message': '', 'remedy': ''}
    calm = replace(FOUND, verdict=('none',), fly_next=None, form_unknown=(), findings=(),
                   nuisances=None)
    assert 'matches these flights' in next_step(calm)
    step = next_step(replace(calm, findings=(lacking,)))
    assert 'at the rate of the controller' in step and 'matches' not in step
