# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The verdicts on the golden flights: those that were recorded, see test/golden, and the truth."""

from functools import cache

from flights import Case, CASES
import pytest
from test_diagnosis import check
from verdicts import recorded, same_verdict, summary

from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.effects.registry import EFFECTS, titled

KEPT = recorded()
BY_NAME = {case.name: case for case in CASES}
ALONE = [case for case in CASES if list(case.truth) == [case.name]]
BY_VOLTAGE = 'battery_sag'     # flown by the second, told by the volt: see test_diagnosis
SEVERAL = BY_NAME['motor_lag+rotor_drag+battery_sag']


def each_of(cases):
    """Return the cases as parameters: the tests of one case share its diagnosis in a process."""
    return [pytest.param(case, id=case.name, marks=pytest.mark.xdist_group(case.name))
            for case in cases]


@cache
def diagnosed(name: str) -> dict:
    """Return the diagnosis of a case, as data."""
    case = BY_NAME[name]
    return diagnose(case.flights(), case.nominal()).as_data()


def test_every_case_is_recorded():
    assert list(KEPT) == [case.name for case in CASES]


def test_every_effect_has_a_case_of_its_own():
    assert {case.name for case in ALONE} == set(EFFECTS)


@pytest.mark.slow
@pytest.mark.parametrize('case', each_of(CASES))
def test_the_verdict_is_the_recorded_one(case: Case):
    # If it changes on purpose: .venv/bin/python test/golden record
    found = summary(diagnosed(case.name))
    assert same_verdict(KEPT[case.name], found), found


@pytest.mark.slow
@pytest.mark.parametrize('case', each_of([case for case in ALONE if case.name != BY_VOLTAGE]))
def test_each_effect_is_named_alone_with_its_parameters(case: Case):
    check(diagnosed(case.name), case.truth)


@pytest.mark.slow
@pytest.mark.parametrize('case', each_of([SEVERAL]))
def test_several_at_once_are_named_together(case: Case):
    data = diagnosed(case.name)
    check(data, case.truth)
    # Each that is named contributes: without it the gap is larger.
    assert len(data['verdict']) > 1
    assert all(data['gap']['without'][name]['velocity'] > data['gap']['after']['velocity']
               for name in data['verdict'])
    contributions = [row['contribution'] for row in data['ranking'][:len(data['verdict'])]]
    assert [row['effect'] for row in data['ranking']][:len(contributions)] == data['verdict']
    assert contributions == sorted(contributions, reverse=True)


@pytest.mark.slow
@pytest.mark.parametrize('case', each_of([BY_NAME['none'], BY_NAME['none_crazyflie']]))
def test_where_nothing_but_noise_is_left_no_gap_is_open(case: Case):
    gap = diagnosed(case.name)['gap']
    for group in ('velocity', 'attitude'):
        assert gap['before'][group] == pytest.approx(gap['noise'][group], rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize(('case', 'other'), [
    pytest.param(BY_NAME[name], other, id=name, marks=pytest.mark.xdist_group(name))
    for name, other in (('motor_lag', 'actuation_delay'), ('actuation_delay', 'motor_lag'))])
def test_measured_speeds_rule_out_the_other_actuator(case: Case, other):
    data = diagnosed(case.name)
    assert [row['probability'] for row in data['ranking'] if row['effect'] == other] == [0.0]
    said = [one['message'] for one in data['findings'] if one['code'] == 'rotor_answer']
    assert len(said) == len(case.courses)
    assert said[0].endswith(f'; this rules out {titled(other)}')
