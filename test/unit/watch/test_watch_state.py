# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the live view knows after messages of the nodes, without ROS and without a terminal."""

from dataclasses import replace
import json

from published import account, diagnosis, identification, published, TOPICS
import pytest

from quad_ident_ros.report.verdict import verdict_line
from quad_ident_ros.watch.state import (
    after_message,
    Event,
    KEPT,
    State,
    time_text,
    with_change,
    with_diagnosis,
    with_event,
    with_fit,
    with_health,
    with_progress,
    with_statistics,
)


def rates(state):
    return {stream.rate for stream in state.recording.streams}


def test_two_accounts_give_the_rate_of_each_stream():
    state = with_statistics(State(), account(100), 10.0)
    assert rates(state) == {None}
    state = with_statistics(state, account(350), 12.5)
    assert rates(state) == {100.0}
    assert [stream.name for stream in state.recording.streams] == list(TOPICS)


def test_an_account_that_follows_at_once_does_not_make_a_rate_of_milliseconds():
    state = with_statistics(State(), account(100), 10.0)
    state = with_statistics(state, account(200), 11.0)
    state = with_statistics(state, account(203, records=2), 11.001)
    assert rates(state) == {100.0} and state.recording.records == 2
    assert rates(with_statistics(state, account(300), 12.0)) == {100.0}


def test_a_recorder_that_starts_anew_has_no_negative_rate():
    state = with_statistics(State(), account(1000), 10.0)
    assert rates(with_statistics(state, account(10), 11.0)) == {None}


def test_losses_are_those_that_the_recorder_counts_as_problems():
    state = with_statistics(State(), account(5, lost=3, out_of_order=1, joined=4), 1.0)
    assert state.recording.problems == {'lost': 3, 'out_of_order': 1}


def test_a_fit_has_the_numbers_of_the_best_method():
    data = identification()
    state = with_fit(State(), data)
    best = data['methods'][data['best']]['outputs']
    assert {model.output for model in state.fit.models} == set(best)
    for model in state.fit.models:
        assert model.values == tuple(best[model.output][name] for name in 'Kab')
        assert model.errors == tuple(best[model.output]['standard_errors'][name]
                                     for name in 'Kab')


def test_a_diagnosis_is_said_as_everywhere_else():
    found = diagnosis()
    state = with_diagnosis(State(), published(found, end_ns=12_340_000_000))
    line = verdict_line(found)
    assert 'rotor_drag' in line and state.verdict.line == line
    assert state.verdict.before == found.gap.before and state.verdict.noise == found.gap.noise
    assert state.history == (Event('12.34 s', 'verdict', line),)


@pytest.mark.parametrize('changes', [
    {'verdict': ('none',)}, {'verdict': ('unknown',)},
    {'verdict': ('undetermined',), 'undetermined': ('wind', 'body_drag'), 'sure': ()}])
def test_each_kind_of_verdict_is_said(changes):
    found = diagnosis(**changes)
    assert with_diagnosis(State(), published(found)).verdict.line == verdict_line(found)


def test_a_change_marks_its_output_and_is_told_once():
    state = with_change(State(), 63_200_000_000, 'phi', 'phi changed: K 4.35 -> 3.3')
    again = with_change(state, 63_200_000_000, 'phi', 'phi changed: K 4.35 -> 3.3')
    assert state.changed == {'phi': '63.20 s'} and again.history == state.history
    assert len(again.history) == 1


def test_stamps_of_the_calendar_are_times_of_the_day():
    assert time_text(12_340_000_000) == '12.34 s'
    assert len(time_text(1_790_000_000 * 10 ** 9).split(':')) == 3


@pytest.mark.parametrize('end', [
    lambda state: with_progress(state, 'diagnoser', {'fraction': 1.0}),
    lambda state: with_health(state, 'diagnoser', 1, 'the diagnosis was cancelled', 2.0),
    lambda state: with_diagnosis(state, published(diagnosis()))])
def test_progress_is_shown_while_a_node_works(end):
    state = with_progress(State(), 'diagnoser', {'fraction': 0.4})
    state = with_health(state, 'diagnoser', 0, 'diagnosing', 1.0)
    state = with_progress(state, 'identifier', {'fraction': 0.1, 'method': 'vp', 'output': 'z'})
    assert state.progress == {'diagnoser': 0.4, 'identifier': 0.1}
    assert end(state).progress == {'identifier': 0.1}


def test_a_node_that_says_nothing_more_is_silent():
    state = with_health(State(), 'recorder', 0, '100 samples joined', 50.0)
    assert state.silence('recorder', 51.5) is None
    assert state.silence('recorder', 62.0) == pytest.approx(12.0)
    assert state.silence('diagnoser', 62.0) is None     # it has not been heard at all


def test_the_history_has_an_end_and_begins_with_the_newest():
    state = State()
    for number in range(KEPT + 50):
        state = with_event(state, Event('', 'flush', str(number)))
    assert len(state.history) == KEPT and state.history[0].text == str(KEPT + 49)


@pytest.mark.parametrize('text', ['{', '[]', '{}', '{"verdict": 3}', 'null',
                                  pytest.param('[' * 100_000, id='deep')])
@pytest.mark.parametrize('step', [with_diagnosis, with_fit])
def test_a_message_that_is_none_becomes_one_line_of_history(step, text):
    def read(state):
        return step(state, json.loads(text))

    state = after_message(after_message(State(), 'diagnosis', read), 'diagnosis', read)
    assert replace(state, history=()) == State()
    assert len(state.history) == 1 and 'cannot be read' in state.history[0].text
