# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the withheld check counts, and that its labels stay sealed. No case is flown."""

import copy
import json
import os
from pathlib import Path
import subprocess
import sys

import numpy as np
import pytest

from quad_ident_ros.effects.registry import EFFECTS as OURS
from withheld import lists
from withheld import score as scores
from withheld.cases import (
    Case,
    EFFECTS,
    full_set,
    ordinary_set,
    quick_set,
    SETS,
    stratum_of,
    STRENGTHS,
)
from withheld.forms import FORMS
from withheld.goals import goals
from withheld.seal import Broken, seal, unseal
from withheld.table import markdown

ROOT = Path(__file__).resolve().parents[3]


def label(effects=(), stranger=None, kind='single', faulty=False, values=None):
    return {'kind': kind, 'faulty': faulty, 'vehicle': 0, 'period': 0.01,
            'effects': {name: {'asked': 1.0, 'strength': 1.0,
                               'parameters': (values or {}).get(name, {})} for name in effects},
            'stranger': stranger and {'kind': stranger, 'asked': 3.0, 'strength': 3.0},
            'held_out': {'exact': {'velocity': 0.3}, 'noise': {'velocity': 0.1},
                         'before': {'velocity': 0.3}}}


def diagnosis(*verdict, probability=1.0, after=0.1, doubts=None, parameters=None, minor=()):
    names = [name for name in (doubts or verdict) if name in EFFECTS]
    return {'verdict': list(verdict), 'undetermined': doubts, 'seconds': 1.0,
            'ranking': [{'effect': name, 'probability': probability,
                         'parameters': (parameters or {}).get(name, {})} for name in names],
            'minor': [{'effect': name, 'probability': 0.99} for name in minor],
            'gap': {'before': {'velocity': 0.3}, 'after': {'velocity': after}}}


def test_the_vocabulary_is_that_of_the_project():
    assert set(EFFECTS) == set(OURS)


def test_the_full_set_has_every_effect_at_every_strength():
    cases = full_set(np.random.default_rng(1))
    singles = {tuple(*case.effects.items()) for case in cases
               if case.kind == 'single' and case.column == 'ours'}
    assert singles == {(name, strength) for name in EFFECTS for strength in STRENGTHS}
    assert len(cases) >= 200
    assert sum(case.kind == 'none' and case.column == 'ours' for case in cases) >= 20
    for column in ('ours', 'forms', 'estimator', 'faulty'):
        assert {len(case.effects) for case in cases
                if case.kind == 'mixture' and case.column == column} == {3, 4, 5}
    assert {case.kind for case in cases if case.faulty} == {'single', 'none', 'pair', 'mixture',
                                                            'unknown'}


def test_whole_vehicles_have_many_effects_each_in_another_form():
    wholes = [case for case in full_set(np.random.default_rng(1)) if case.kind == 'whole']
    assert {len(case.effects) for case in wholes} == {4, 5, 6, 7}
    assert all(set(case.forms) == set(case.effects) for case in wholes)
    assert {case.wrong_file for case in wholes} == {True, False}


SUBJECTS = {'vehicle': lists.VEHICLES, 'path': lists.PATHS, 'controller': lists.CONTROLLERS,
            'noise': lists.NOISES}


@pytest.mark.parametrize(('names', 'least'), [
    (lists.VEHICLES, 4), (lists.PATHS, 5), (lists.CONTROLLERS, 2), (lists.NOISES, 3),
    (lists.STRANGERS, 4)])
def test_the_lists_of_development_and_evaluation_are_disjoint(names, least):
    developed, evaluated = (names[part] for part in lists.PARTS)
    assert not set(developed) & set(evaluated)
    assert len(set(evaluated)) == len(evaluated) >= least and developed


def test_the_evaluation_draws_nothing_that_development_uses():
    for name in EFFECTS:
        own, others = (FORMS[part][name] for part in lists.PARTS)
        assert not set(own) & set(others) and own and others
        assert not set(own.values()) & set(others.values())
    for name, chosen in SETS.items():
        cases = chosen.cases(np.random.default_rng(1))
        assert {case.stranger[0] for case in cases if case.stranger} == set(
            () if name == 'ordinary' else lists.STRANGERS[chosen.part])
        for subject, names in SUBJECTS.items():
            assert {getattr(case, subject) for case in cases} == set(names[chosen.part])
        assert all(form in FORMS[chosen.part][name] for case in cases if case.log != 'dropped'
                   for name, form in case.forms.items())


def test_a_smaller_draw_has_every_kind_in_proportion():
    cases = full_set(np.random.default_rng(3))
    few, share = cases[:150], 150 / len(cases)
    for stratum in {stratum_of(case) for case in cases}:
        whole, some = (sum(stratum_of(case) == stratum for case in of) for of in (cases, few))
        assert some >= 1 and abs(some - share * whole) < 2.0
    assert {case.log for case in few} == {case.log for case in cases}
    for subject, names in SUBJECTS.items():
        counts = [sum(getattr(case, subject) == name for case in few)
                  for name in names['evaluation']]
        assert max(counts) - min(counts) <= 1


@pytest.mark.parametrize('make', [quick_set, full_set])
def test_every_column_has_cases_of_its_own(make):
    cases = make(np.random.default_rng(2))
    assert {case.column for case in cases} == set(scores.COLUMNS)


@pytest.mark.parametrize(('options', 'column'), [
    ({}, 'ours'), ({'forms': {'wind': 'profile'}}, 'forms'), ({'bodies': True}, 'forms'),
    ({'gusts': 1.0}, 'forms'), ({'wrong_file': True}, 'files'), ({'log': '20_hz'}, 'logs'),
    ({'setup': 0}, 'estimator'), ({'setup': 0, 'faulty': True}, 'faulty')])
def test_a_case_counts_where_what_is_hardest_about_it_is(options, column):
    assert Case('single', {'wind': 1.0}, **options).column == column


def test_the_ordinary_set_has_each_of_its_forms_alone_and_some_together():
    cases = ordinary_set(np.random.default_rng(1))
    alone = [(name, form) for case in cases if case.kind == 'single'
             for name, form in case.forms.items()]
    assert sorted(alone) == sorted(
        (name, form) for name, forms in lists.ORDINARY.items() for form in forms)
    assert {*lists.ORDINARY} == {*EFFECTS} and {*alone} <= {
        (name, form) for name, forms in FORMS['development'].items() for form in forms}
    assert {case.kind for case in cases} == {'single', 'pair', 'mixture'}
    assert all({*case.forms} == {*case.effects} for case in cases)


def test_the_order_of_the_cases_tells_nothing():
    first, second = (full_set(np.random.default_rng(seed)) for seed in (1, 2))
    assert first != second
    assert quick_set(np.random.default_rng(1)) == quick_set(np.random.default_rng(1))


def test_an_exact_set_has_no_more_and_no_less():
    truth = label(['wind', 'motor_lag'], kind='pair')
    assert scores.judge(truth, diagnosis('motor_lag', 'wind'))['exact']
    assert not scores.judge(truth, diagnosis('wind'))['exact']
    assert not scores.judge(truth, diagnosis('motor_lag', 'wind', 'inflow'))['exact']
    assert not scores.judge(truth, diagnosis('motor_lag', 'wind', 'unknown'))['exact']


def test_what_is_there_but_small_may_stand_aside():
    truth = label(['wind', 'motor_lag'], kind='pair')
    assert scores.is_exact(truth, diagnosis('wind', minor=['motor_lag']))
    assert scores.is_exact(truth, diagnosis('wind', 'motor_lag', minor=['inflow']))
    assert not scores.is_exact(truth, diagnosis('wind', minor=['inflow']))
    assert scores.is_exact(label(kind='none'), diagnosis('none', minor=['inflow']))


def test_what_the_file_has_wrong_may_be_named_and_need_not_be():
    single = label(['wind']) | {'beside': ['inertia_mismatch']}
    assert scores.is_exact(single, diagnosis('wind'))
    assert scores.is_exact(single, diagnosis('wind', 'inertia_mismatch'))
    assert not scores.is_exact(single, diagnosis('inertia_mismatch'))
    none = label(kind='none') | {'beside': ['inertia_mismatch']}
    assert not scores.judge(none, diagnosis('inertia_mismatch'))['alarm']
    assert scores.judge(none, diagnosis('inertia_mismatch', 'wind'))['alarm']


def test_a_name_that_does_as_well_is_right_alone():
    dropped = label(['mass_offset']) | {'instead': ['unknown']}
    assert scores.is_exact(dropped, diagnosis('unknown'))
    assert scores.is_exact(dropped, diagnosis('mass_offset'))
    assert not scores.is_exact(dropped, diagnosis('mass_offset', 'unknown'))
    assert scores.judge(dropped, diagnosis('unknown'))['instead'] is None


def test_one_finding_is_named_by_each_of_its_members():
    one = {'one_finding': [{'effects': ['thrust_scale', 'mass_offset']}]}
    both = diagnosis('thrust_scale', 'mass_offset') | one
    assert scores.is_exact(label(['mass_offset']), both)
    assert scores.is_exact(label(['mass_offset']), diagnosis('thrust_scale') | one)
    assert not scores.is_exact(label(['mass_offset']), diagnosis('thrust_scale'))
    assert not scores.is_exact(label(['wind']), both)


@pytest.mark.parametrize(('verdict', 'said'), [
    (['unknown'], True), (['inflow', 'unknown'], True), (['wind', 'unknown'], False),
    (['wind'], False)])
def test_unknown_is_said_instead_where_nothing_right_is_named(verdict, said):
    assert scores.judge(label(['wind']), diagnosis(*verdict))['instead'] is said


def test_what_a_label_allows_beside_the_effects_decides_nothing_about_the_first():
    wrong_file = label(['wind']) | {'beside': ['inertia_mismatch']}
    assert scores.judge(wrong_file, diagnosis('inertia_mismatch', 'wind'))['first']
    assert not scores.judge(wrong_file, diagnosis('inertia_mismatch', 'inflow'))['first']
    assert not scores.judge(label(['wind']), diagnosis('inertia_mismatch', 'wind'))['first']


def test_precision_and_recall_of_a_mixture():
    row = scores.judge(label(['wind', 'motor_lag', 'inflow'], kind='mixture'),
                       diagnosis('motor_lag', 'wind', 'body_drag', 'gyro_bias'))
    assert row['precision'] == 0.5
    assert row['recall'] == pytest.approx(2 / 3)


@pytest.mark.parametrize('verdict', [['wind'], ['unknown'], ['undetermined']])
def test_anything_but_none_is_a_false_alarm(verdict):
    assert scores.judge(label(kind='none'), diagnosis(*verdict))['alarm']


def test_none_is_no_false_alarm():
    row = scores.judge(label(kind='none'), diagnosis('none'))
    assert row['alarm'] is False and row['exact']


def test_unknown_has_to_be_said_and_only_where_it_is():
    labels = {'a': label(stranger='slosh', kind='unknown'), 'b': label(['wind'])}
    found = {'a': diagnosis('unknown'), 'b': diagnosis('wind', 'unknown')}
    result = scores.score(labels, found)
    assert result['groups']['ours: unknown']['unknown'] == {'rate': 1.0, 'count': 1}
    assert result['columns']['ours']['instead'] == {'rate': 0.0, 'count': 1}


def test_doubt_is_right_only_where_the_records_cannot_tell():
    doubt = diagnosis('undetermined', doubts=['mass_offset', 'thrust_scale'])
    assert scores.judge(label(['mass_offset'], kind='poor'), doubt)['exact']
    assert not scores.judge(label(['mass_offset']), doubt)['exact']
    assert not scores.judge(label(['wind'], kind='poor'), doubt)['exact']


def test_what_is_named_beside_a_doubt_must_be_there():
    doubt = diagnosis('undetermined', doubts=['mass_offset', 'thrust_scale']) | {'sure': ['wind']}
    assert scores.judge(label(['mass_offset', 'wind'], kind='poor'), doubt)['exact']
    assert not scores.judge(label(['mass_offset'], kind='poor'), doubt)['exact']
    assert not scores.judge(label(['wind', 'inflow'], kind='poor'), doubt)['exact']


@pytest.mark.parametrize(('delay', 'right'), [(0.002, True), (0.03, False)])
def test_a_delay_is_told_from_a_lag_where_it_outlasts_a_sample(delay, right):
    truth = label(['actuation_delay'], values={'actuation_delay': {'delay': delay}})
    doubt = diagnosis('undetermined', doubts=['actuation_delay', 'motor_lag'])
    assert scores.judge(truth, doubt)['exact'] is right


def test_a_refusal_is_in_no_rate_and_a_failure_is_wrong():
    labels = {name: label(['wind']) for name in 'abc'}
    found = {'a': {'refused': 'too short'}, 'b': {'failed': 'ZeroDivisionError'}}
    group = scores.score(labels, found)['groups']['ours: single']
    assert group['refused'] == {'rate': pytest.approx(1 / 3), 'count': 3}
    assert group['exact'] == {'rate': 0.0, 'count': 2}


@pytest.mark.parametrize(('after', 'share'), [(0.1, 1.0), (0.2, 0.5), (0.3, 0.0), (0.4, -0.5)])
def test_the_share_closed_counts_from_the_noise(after, share):
    row = scores.judge(label(['wind']), diagnosis('wind', after=after))
    assert row['closed'] == pytest.approx(share)


def test_what_a_log_hides_cannot_be_closed():
    truth = label(['wind'])
    truth['held_out']['floor'] = {'velocity': 0.2}
    assert scores.judge(truth, diagnosis('wind', after=0.2))['closed'] == pytest.approx(1.0)


def test_where_nothing_can_be_closed_there_is_no_share():
    truth = label(['wind'])
    truth['held_out']['before']['velocity'] = 0.102
    assert scores.judge(truth, diagnosis('wind'))['closed'] is None


def test_calibration_is_perfect_where_shares_are_as_given():
    pairs = [(label(['wind'] if k < 3 else []), diagnosis('wind', probability=0.75))
             for k in range(4)]
    found = scores.calibration(pairs)
    assert found['error'] == pytest.approx(0.0)
    assert found['brier'] == pytest.approx(0.75 * 0.25 ** 2 + 0.25 * 0.75 ** 2)


def test_probabilities_that_are_too_sure_show_as_error():
    pairs = [(label(['wind'] if k else []), diagnosis('wind', probability=1.0)) for k in range(2)]
    assert scores.calibration(pairs)['error'] == pytest.approx(0.5)


def test_the_error_of_calibration_leaves_out_what_is_nearly_sure():
    sure = [(label(), diagnosis('wind', probability=0.01)) for _ in range(96)]
    doubtful = [(label(['wind'] if k else []), diagnosis('wind', probability=0.5))
                for k in range(4)]
    found = scores.calibration(sure + doubtful)
    assert found['middle'] == pytest.approx(0.25) and found['middle_count'] == 4
    assert found['error'] == pytest.approx(0.96 * 0.01 + 0.04 * 0.25)


def test_calibration_is_told_by_group():
    labels = {f'{group}{k}': label(['wind'] if k else [], kind='single' if k else 'none',
                                   faulty=group == 'b')
              for group, count in (('a', 4), ('b', 2)) for k in range(count)}
    found = {name: diagnosis('wind', probability=0.75 if name[0] == 'a' else 0.97)
             for name in labels}
    rows = {line.split(' | ')[0].strip('| '): line.strip('| ').split(' | ')[1:]
            for line in markdown(scores.score(labels, found)).splitlines()
            if line.startswith('|')}
    titles = rows['probability: mean given / present (count)']
    assert titles == ['all', 'forms as ours', 'faulty records']
    assert rows['0.6 to 0.8'] == ['0.750 / 0.750 (4)', '0.750 / 0.750 (4)', '-']
    assert rows['0.95 to 1'] == ['0.970 / 0.500 (2)', '-', '0.970 / 0.500 (2)']
    assert rows['error, 0.05 to 0.95'] == ['0.000 (4)', '0.000 (4)', '-']
    assert rows['error'] == ['0.157 (6)', '0.000 (4)', '0.470 (2)']


def test_coverage_leaves_out_what_means_something_else():
    truth = label(['wind'], values={'wind': {'x': 1.0}})
    truth['effects']['wind']['comparable'] = False
    given = diagnosis('wind', parameters={'wind': {'x': {'value': 1.0, 'std': 0.1}}})
    assert scores.coverage([(truth, given)]) == {}


def rescaled_pair(mass, *verdict):
    """Return label and diagnosis of a mass and others: half of each but lag without the mass."""
    true = {'mass_offset': {'mass': mass}, 'inertia_mismatch': {'factor_x': 1.2},
            'rotor_drag': {'coefficient': 0.1}, 'motor_lag': {'time_constant': 0.03}}
    scale = 1.0 if 'mass_offset' in verdict else 0.5
    values = {'thrust_scale': {'factor': scale}, 'mass_offset': {'mass': mass},
              'inertia_mismatch': {'factor_x': 1.2 * scale},
              'rotor_drag': {'coefficient': 0.1 * scale}, 'motor_lag': {'time_constant': 0.03}}
    given = {effect: {name: {'value': value, 'std': 1e-3 * value} for name, value in one.items()}
             for effect, one in values.items()}
    return label(true, kind='mixture', values=true), diagnosis(*verdict, parameters=given) | {
        'one_finding': [{'effects': ['mass_offset', 'thrust_scale']}]}


def test_coverage_leaves_out_what_is_scaled_by_another_name_of_the_ratio():
    others = ('inertia_mismatch', 'rotor_drag', 'motor_lag')
    swapped = rescaled_pair(0.5, 'thrust_scale', *others)
    assert scores.is_exact(*swapped)
    assert set(scores.coverage([swapped])) == {'all', 'motor_lag'}
    assert not scores.case_of('a', *swapped, scores.judge(*swapped))['outside']
    told = scores.coverage([rescaled_pair(0.5, 'mass_offset', *others)])
    assert told.pop('all') == {'rate': 1.0, 'count': 4}
    assert set(told) == {'mass_offset', *others}
    # Both are named, because nothing separates them, and the share of each is not stated.
    both = rescaled_pair(0.5, 'mass_offset', 'thrust_scale', *others)
    assert set(scores.coverage([both])) == {'all', 'motor_lag'}


def test_coverage_has_what_is_scaled_where_the_thrust_may_be_named_too():
    truth = label(['inertia_mismatch'], values={'inertia_mismatch': {'factor_x': 1.2}})
    given = diagnosis('inertia_mismatch', 'thrust_scale', parameters={
        'inertia_mismatch': {'factor_x': {'value': 1.2, 'std': 0.01}}})
    assert scores.coverage([(truth | {'beside': ['thrust_scale']}, given)])['all']['count'] == 1


def test_coverage_counts_true_values_inside_their_intervals():
    truth = label(['wind'], values={'wind': {'x': 1.0, 'y': 2.0}})
    given = diagnosis('wind', parameters={'wind': {'x': {'value': 1.1, 'std': 0.1},
                                                   'y': {'value': 2.5, 'std': 0.1}}})
    assert scores.coverage([(truth, given)])['wind'] == {'rate': 0.5, 'count': 2}


def test_chance_is_what_other_diagnoses_would_reach():
    labels = {'a': label(['wind']), 'b': label(['wind']), 'c': label(['inflow'])}
    found = {name: diagnosis(*one['effects']) for name, one in labels.items()}
    assert scores.score(labels, found)['chance'] == {'first': pytest.approx(1 / 3),
                                                     'exact': pytest.approx(1 / 3)}


def test_the_score_does_not_change_what_it_is_given_and_makes_tables():
    labels = {'a': label(['wind']), 'b': label(kind='none'), 'c': label(stranger='slosh',
                                                                        kind='unknown'),
              'd': label(['wind'], faulty=True)}
    found = {'a': diagnosis('wind'), 'b': diagnosis('none'), 'c': diagnosis('unknown'),
             'd': {'refused': 'clocks'}}
    before = copy.deepcopy((labels, found))
    text = markdown(scores.score(labels, found))
    assert (labels, found) == before
    assert '| faulty: single | 1 |' in text and '| `ours: wind` |' in text


def reached(labels, found, column):
    return {row.what: row for row in goals(scores.score(labels, found)) if row.column == column}


def test_the_goals_say_what_was_not_reached():
    labels = {'a': label(kind='none'), 'b': label(stranger='slosh', kind='unknown'),
              'c': label(kind='none', faulty=True)}
    right = {'a': diagnosis('none'), 'b': diagnosis('unknown'), 'c': diagnosis('none')}
    wrong = {'a': diagnosis('wind'), 'b': diagnosis('none'), 'c': diagnosis('none')}
    good, bad = (reached(labels, found, 'ours') for found in (right, wrong))
    assert not any(row.met is False or row.missed for row in good.values())
    alarms = bad['false alarms on `none`']
    assert (alarms.figure, alarms.target, alarms.met) == ('100 % of 1', '≤ 2 %', False)
    assert good['false alarms on `none`'].met is True
    unknown = bad['`unknown` recognised']
    assert (unknown.figure, unknown.target, unknown.met) == ('0 % of 1', '≥ 90 %', False)


def test_a_goal_that_is_missed_names_its_cases_and_no_others():
    labels = {'a1': label(['wind'], stranger=None), 'b2': label(['motor_lag']),
              'c3': label(['wind'], faulty=True)}
    found = {'a1': diagnosis('wind'), 'b2': diagnosis('inflow', 'unknown'),
             'c3': diagnosis('inflow')}
    result = scores.score(labels, found)
    first = reached(labels, found, 'ours')['right effect first, strength 1 and 3']
    assert len(first.missed) == 1
    assert '`b2` motor_lag 1' in first.missed[0] and 'inflow, unknown' in first.missed[0]
    text = markdown(result)
    heading = text.index('- right effect first, strength 1 and 3, forms as ours: 50 % of 2')
    assert heading < text.index('`b2`', heading) < text.index('`c3`', heading)
    assert '| right effect first, strength 1 and 3 | forms as ours | 50 % of 2 | ≥ 99 % | ' in text
    assert '`a1`' not in text


def test_intervals_and_probabilities_that_miss_the_truth_are_named():
    truth = label(['wind'], values={'wind': {'x': 1.0}})
    off = diagnosis('wind', probability=0.3, parameters={'wind': {'x': {'value': 2.0,
                                                                        'std': 0.1}}})
    rows = reached({'a': truth}, {'a': off}, 'ours')
    assert len(rows['coverage of 95 % intervals'].missed) == 1
    assert len(rows['calibration error over 0.05 to 0.95'].missed) == 1


def test_what_was_not_flown_is_told():
    result = scores.score({'a': label(['wind'])}, {'a': diagnosis('wind')})
    assert 'Not flown' not in markdown(result)
    assert '- no real flights here' in markdown(result | {'not_flown': ['no real flights here']})


def test_each_column_is_held_to_its_own_goals():
    labels = {f'{kind}{k}': label(['wind', 'inflow'], kind='pair', faulty=kind == 'faulty')
              for kind in ('clean', 'faulty') for k in range(10)}
    found = {name: diagnosis(*one['effects']) for name, one in labels.items()}
    for kind in ('clean', 'faulty'):
        found[f'{kind}0'] = diagnosis('wind')
    ours, faulty = (reached(labels, found, column)['exact set, pairs']
                    for column in ('ours', 'faulty'))
    assert (ours.figure, ours.target, ours.met) == ('90 % of 10', '≥ 95 %', False)
    assert (faulty.figure, faulty.target, faulty.met) == ('90 % of 10', '≥ 80 %', True)


def test_refusals_are_told_by_column():
    labels = {'a': label(['wind']), 'b': label(['wind'], faulty=True)}
    found = {'a': diagnosis('wind'), 'b': {'refused': 'clocks'}}
    assert reached(labels, found, 'ours')['refused'].figure == '0 % of 1'
    refused = reached(labels, found, 'faulty')['refused']
    assert refused.figure == '100 % of 1' and 'clocks' in refused.missed[0]


def changed(flown, **verdicts):
    """Return labels and diagnoses of changes to real flights: by name, what was said of each."""
    effects = {'weaker': {'thrust_scale': {'factor': 0.9}}, 'later_2': {
        'actuation_delay': {'delay': 0.02}}, 'biased': {'gyro_bias': {'x': 0.05}}}
    labels = {'flown': {'kind': 'hybrid', 'change': 'base', 'effects': {}, 'twins': [],
                        'by': 'sum', 'base': 'flown'}}
    labels |= {f'of_{name}': {'kind': 'hybrid', 'change': name, 'effects': effects[name],
                              'twins': [], 'by': 'product' if name == 'weaker' else 'sum',
                              'base': 'flown'} for name in verdicts}
    return labels, {'flown': flown} | {f'of_{name}': one for name, one in verdicts.items()}


def valued(effect, parameter, value):
    return {effect: {parameter: {'value': value, 'std': 0.001}}}


def test_changes_to_real_flights_have_a_row_of_their_own():
    result = scores.score(*changed(
        diagnosis('rotor_drag', 'wind'),
        weaker=diagnosis('rotor_drag', 'wind', 'thrust_scale',
                         parameters=valued('thrust_scale', 'factor', 0.9)),
        later_2=diagnosis('rotor_drag', 'actuation_delay', 'inflow',
                          parameters=valued('actuation_delay', 'delay', 0.02))))
    assert result['count'] == 0
    text = markdown(result)
    assert '| hybrids: changed | 2 | - | 50 % (2) |' in text
    assert ('| the change named, and nothing else | real flights, changed | 50 % of 2 | - | - |'
            in text)
    assert '| `weaker` | yes | yes | yes | - | - |' in text
    assert '| `later_2` | no | yes | yes | inflow | wind |' in text
    assert ('  - `of_later_2` later_2 (actuation_delay delay 0.02): rotor_drag, actuation_delay, '
            'inflow; lost wind; added inflow') in text
    assert '- `of_weaker`' not in text


@pytest.mark.parametrize(('factor', 'right', 'wrong'), [
    (0.9, 100, None), (0.97, 0, 'moved by another amount'), (None, 0, 'not named')])
def test_a_change_is_right_where_it_is_named_and_as_large(factor, right, wrong):
    said = diagnosis('rotor_drag') if factor is None else diagnosis(
        'rotor_drag', 'thrust_scale', parameters=valued('thrust_scale', 'factor', factor))
    labels, found = changed(diagnosis('rotor_drag'), weaker=said)
    row = reached(labels, found, 'hybrids')['the change named, and nothing else']
    assert row.figure == f'{right} % of 1' and row.met is None
    assert [case.split('; ')[1:] for case in row.missed] == ([[wrong]] if wrong else [])


def test_what_flew_before_may_have_the_effect_and_must_not_lose_it():
    flown = diagnosis('thrust_scale', parameters=valued('thrust_scale', 'factor', 0.95))
    more = diagnosis('thrust_scale', parameters=valued('thrust_scale', 'factor', 0.855))
    for said, figure in ((more, '100 % of 1'), (diagnosis('none'), '0 % of 1')):
        rows = reached(*changed(flown, weaker=said), 'hybrids')
        assert rows['the change named, and nothing else'].figure == figure
    # Named as before, by no amount: nothing to judge by.
    untold = reached(*changed(diagnosis('thrust_scale'), weaker=diagnosis('thrust_scale')),
                     'hybrids')
    assert untold['the change named, and nothing else'].figure == '-'


def test_a_refused_change_is_in_no_share_and_a_failed_one_is_wrong():
    labels, found = changed(diagnosis('rotor_drag'), weaker={'refused': 'order of the rotors'},
                            later_2={'failed': 'ZeroDivisionError'})
    rows = reached(labels, found, 'hybrids')
    assert rows['the change named, and nothing else'].figure == '0 % of 1'
    assert rows['refused'].figure == '50 % of 2'
    assert 'order of the rotors' in rows['refused'].missed[0]
    found['flown'] = {'refused': 'clocks'}
    rows = reached(labels, found, 'hybrids')
    assert rows['refused'].figure == '100 % of 2'
    assert 'as flown: clocks' in rows['refused'].missed[0]


def test_without_changes_to_real_flights_there_is_no_row_of_them():
    labels, found = {'a': label(['wind'])}, {'a': diagnosis('wind')}
    assert not reached(labels, found, 'hybrids')
    text = markdown(scores.score(labels, found))
    assert 'hybrids' not in text and 'real flights' not in text


def test_a_seal_opens_with_its_key_alone():
    labels = {'a': label(['wind'])}
    sealed, key = seal(labels)
    assert unseal(sealed, key) == labels
    _, other = seal(labels)
    with pytest.raises(Broken):
        unseal(sealed, other)
    with pytest.raises(Broken):
        unseal(sealed, key[:-1])


def test_sealed_labels_cannot_be_changed():
    sealed, key = seal({'a': label(['wind'])})
    with pytest.raises(Broken):
        unseal(bytes([sealed[0] ^ 1]) + sealed[1:], key)


def test_what_is_sealed_does_not_show():
    sealed, _ = seal({'a': label(['wind'])})
    again, _ = seal({'a': label(['wind'])})
    assert b'wind' not in sealed and sealed != again
    # Any text of that length fits the sealed bytes with some key: they say nothing but a length.
    other = json.dumps({'a': label(['wing'])}, sort_keys=True).encode()
    pad = bytes(a ^ b for a, b in zip(sealed, other, strict=True))
    assert bytes(a ^ b for a, b in zip(sealed, pad, strict=True)) == other


# Stands for the diagnosis: it looks at everything that the process was given.
SPY = """
import json, os, sys
fds = {}
for name in os.listdir('/proc/self/fd'):
    try:
        fds[name] = os.readlink(f'/proc/self/fd/{name}')
    except OSError:
        pass
print(json.dumps({'argv': sys.argv, 'cwd': os.getcwd(), 'env': dict(os.environ), 'fds': fds}))
"""


def test_the_diagnosing_process_is_not_told_where_the_labels_are(tmp_path, monkeypatch):
    from withheld import __main__ as check
    flights, found, vault = tmp_path / 'flights', tmp_path / 'found', tmp_path / 'vault'
    for folder in (flights, found, vault):
        folder.mkdir()
    sealed, key = seal({'a': label(['wind'])})
    (vault / 'labels').write_bytes(sealed)
    (tmp_path / 'spy.py').write_text(SPY, encoding='utf-8')
    seen = []

    def spied(command, **options):
        assert command[1:3] == ['-m', 'withheld.blind']
        return real([sys.executable, str(tmp_path / 'spy.py'), *command[3:]], **options)

    real = subprocess.Popen
    read, write = os.pipe()
    os.write(write, key)
    os.set_inheritable(read, False)
    monkeypatch.setattr(check.subprocess, 'Popen', spied)
    monkeypatch.setattr(check, 'follow', lambda process, *_: seen.append(process.communicate()[0]))
    with open(vault / 'labels', 'rb'):
        check.diagnose(flights, found, None, 2)
    os.close(read)
    os.close(write)
    told = json.loads(seen[0])
    assert told['cwd'] == str(flights)
    assert told['argv'][1:] == [str(flights), str(found), '2']
    assert str(vault) not in seen[0]
    assert key.hex() not in seen[0]
    assert {'0', '1', '2'} >= {name for name, target in told['fds'].items()
                               if not target.startswith('/proc/')}


@pytest.mark.slow
def test_cases_are_diagnosed_side_by_side_and_each_once(tmp_path, capsys):
    from withheld import blind
    flights, found = tmp_path / 'flights', tmp_path / 'found'
    for name in 'abc':
        (flights / name).mkdir(parents=True)
    found.mkdir()
    (found / 'c.json').write_text('{}')
    blind.main(str(flights), str(found), '2')
    answers = {path.stem: json.loads(path.read_text()) for path in found.glob('*.json')}
    assert set(answers) == set('abc') and answers['c'] == {}
    assert all('vehicle.yaml' in answers[name]['refused'] for name in 'ab')
    assert capsys.readouterr().out.count('done') == 2


WRITES = """
import os, sys
print('1 1', flush=True)
with os.fdopen(int(sys.argv[-1]), 'wb') as pipe:
    pipe.write(bytes(range(256)) * 4096)
"""


def test_a_key_of_many_labels_comes_through_its_pipe():
    """It is longer than what a pipe holds, and comes before the process ends."""
    from rich.progress import Progress

    from withheld.__main__ import key_from
    with Progress(disable=True) as bar:
        key = key_from([sys.executable, '-c', WRITES], bar)
    assert key == bytes(range(256)) * 4096


def test_the_latest_run_is_on_the_page_and_older_ones_in_files(tmp_path):
    import datetime

    from withheld.page import keep
    page = tmp_path / 'withheld.md'
    page.write_text('# Check\n\n<!-- trend -->\n<!-- end of trend -->\n'
                    '<!-- together -->\n<!-- end of together -->\n', encoding='utf-8')
    result = scores.score({'a': label(['wind'])}, {'a': diagnosis('wind')})
    for day in (1, 2, 3):
        keep(page, result | {'version': f'0.1.0 (c{day})', 'seed': 7},
             datetime.date(2026, 1, day))
    older = sorted((tmp_path / 'withheld').iterdir())
    assert [path.name for path in older] == ['run_01.md', 'run_02.md']
    text = page.read_text(encoding='utf-8')
    assert text.startswith('# Check\n') and text.count('1 cases, seed 7') == 1
    assert '### 2026-01-03, version 0.1.0 (c3)' in text.partition('## Latest run')[2]
    assert [path.read_text(encoding='utf-8').startswith(f'# 2026-01-0{k + 1}, version')
            for k, path in enumerate(older)] == [True, True]
    rows = [line for line in text.splitlines() if line.startswith('| [')]
    assert [row.split('|')[1:4] for row in rows] == [
        [' [c1](withheld/run_01.md) ', ' 2026-01-01 ', ' 1 '],
        [' [c2](withheld/run_02.md) ', ' 2026-01-02 ', ' 1 '],
        [' [c3](#latest-run) ', ' 2026-01-03 ', ' 1 ']]
    assert all(row.split('|')[4] == ' 100 % of 1 ' for row in rows)


def test_links_of_a_run_lead_to_where_they_led_once_it_has_a_page_of_its_own():
    from withheld.page import apart
    run = ('### A run\n[a](#later), [b](#all-runs), [c](method.md#noise), [d](https://x.org/#e)\n'
           '### Later\n')
    assert apart(run, 'withheld.md') == (
        '# A run\n[a](#later), [b](../withheld.md#all-runs), [c](../method.md#noise), '
        '[d](https://x.org/#e)\n## Later\n')


def test_the_help_says_why_no_cluster_is_used(capsys):
    from withheld.__main__ import main
    with pytest.raises(SystemExit):
        main(['--help'])
    assert 'There is no --scheduler: workers of a cluster' in capsys.readouterr().out


@pytest.mark.slow
def test_the_command_hands_its_arguments_on(capfd):
    from quad_ident_ros.cli.main import main
    assert main(['withheld', '--help']) == 0
    assert '--count' in capfd.readouterr().out
    assert main(['withheld', '--set', 'evaluation', '-h']) == 0


def test_the_command_says_what_is_missing(tmp_path, monkeypatch, capsys):
    from quad_ident_ros.cli import withheld as command
    from quad_ident_ros.cli.main import main
    monkeypatch.setattr(command, 'ROOT', tmp_path)
    assert main(['withheld']) == 2
    said = capsys.readouterr().err
    assert said.count('\n') == 1 and './run withheld' in said
