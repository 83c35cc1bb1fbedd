# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the benchmarks measure with: problems, bounds, best costs and tables. No peer is needed."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from real import needs_real_flights, real_vehicle

from benchmarks import diagnosis, problems, reference, rollout, tables
import benchmarks.__main__ as bench
from benchmarks.__main__ import SECTIONS
from benchmarks.bound import bound, derivatives, FIRST, SECOND
from benchmarks.compare import rmse_over_bound
from benchmarks.joint import Joint, pursue, Tracker
from quad_ident_ros.identify.transfer import response, SecondOrder

T = problems.PERIOD * np.arange(500)


@pytest.mark.parametrize(('words', 'count'), [([], 0), (['--quick'], 0), (['--keep'], 1)])
def test_tables_go_into_the_documents_only_where_that_is_asked_for(monkeypatch, words, count):
    kept = []
    module = SimpleNamespace(run=lambda size, bar: 'a table')
    monkeypatch.setattr(bench.importlib, 'import_module', lambda name: module)
    monkeypatch.setattr(bench, 'keep', lambda *text: kept.append(text))
    assert bench.main(['graph', *words]) == 0
    assert len(kept) == count
    with pytest.raises(SystemExit):
        bench.main(['graph', '--quick', '--keep'])


STEP = np.ones(500)


@pytest.mark.slow
def test_derivatives_of_a_double_integrator_are_powers_of_time():
    found = derivatives(0.0, 0.0, STEP, problems.PERIOD, SECOND)
    closed = [T ** 2 / 2, -T ** 3 / 6, -T ** 4 / 24, T ** 4 / 12, T ** 5 / 60, T ** 6 / 360]
    for one, other in zip(found, closed, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9)


@pytest.mark.parametrize('model', [
    SecondOrder.from_poles(4.0, 2.0, 0.5), SecondOrder.from_poles(4.0, 2.0, -0.3),
    SecondOrder.from_half_difference(4.0, 0.5, -2.0)], ids=lambda model: model.stability)
def test_the_exact_response_is_that_of_the_library(model):
    u = np.sin(T)
    mine = model.gain * derivatives(model.c1, model.c0, u, problems.PERIOD, FIRST)[0]
    theirs = response(model, u, problems.PERIOD)
    np.testing.assert_allclose(mine, theirs, atol=1e-12 * np.ptp(theirs))


def step_response(gain, a, b):
    return gain * (1 / (a * b) + np.exp(-a * T) / (a * (a - b)) - np.exp(-b * T) / (b * (a - b)))


def test_the_bound_of_a_step_is_that_of_its_closed_form():
    model, deviation = SecondOrder.from_poles(4.0, 2.0, 0.5), 0.03
    point = np.array([4.0, 2.0, 0.5])
    tiny = 1e-30
    matrix = np.column_stack([step_response(*(point + 1j * tiny * np.eye(3)[i])).imag / tiny
                              for i in range(3)])
    closed = deviation * np.sqrt(np.diag(np.linalg.inv(matrix.T @ matrix)))
    found = bound(model, STEP, problems.PERIOD, deviation)
    np.testing.assert_allclose(found.errors[[0, 3, 4]], closed, rtol=1e-6)
    np.testing.assert_allclose(found.values, [4.0, 2.5, 1.0, 2.0, 0.5])


def test_the_predicted_bias_is_that_of_fits_to_small_errors():
    # An error at right angles to the derivatives moves no estimate, so that the mean over all
    # directions of the noise, to second order, is that over those of the derivatives.
    model, deviation = SecondOrder.from_poles(4.0, 2.0, 0.5), 1e-3
    gain, by_c1, by_c0 = derivatives(model.c1, model.c0, STEP, problems.PERIOD)
    directions = np.linalg.qr(np.column_stack([gain, 4.0 * by_c1, 4.0 * by_c0]))[0].T
    truth = np.array([model.gain, model.c1, model.c0])
    bias = np.zeros(3)
    for error in (*directions, *-directions):
        signal = problems.Signal('z', T, STEP, 4.0 * gain + deviation * error, problems.PERIOD,
                                 True)
        bias += (reference.best_real(signal, model)[0] - truth) / 2
    expected = bound(model, STEP, problems.PERIOD, deviation)
    np.testing.assert_allclose(bias, expected.biases[:3], rtol=1e-2)


def test_the_best_cost_is_below_that_of_the_truth_and_zero_without_noise():
    problem = problems.p1()[0]
    for truth, signal, clean in zip(problem.truths, problem.draw(0), problem.clean, strict=True):
        point = (truth.gain, truth.c1, truth.c0)
        model, cost = reference.best_real(signal, truth)
        assert cost < reference.cost_of(signal, point)
        assert cost == pytest.approx(reference.cost_of(signal, model), rel=1e-9)
        assert model[1] ** 2 / 4 >= model[2]
        bare = problems.Signal('z', signal.t, signal.u, clean, signal.period, True)
        assert reference.best_real(bare, truth)[1] < 1e-25


def test_a_draw_has_the_noise_that_it_says_and_is_the_same_again():
    problem = problems.p2(5000, 'PRBS', 1)
    one, again, other = problem.draw(1), problem.draw(1), problem.draw(2)
    for i, deviation in enumerate(problem.deviations):
        noise = one[i].y - problem.clean[i]
        assert np.std(noise) == pytest.approx(deviation, rel=0.05)
        assert deviation == pytest.approx(0.01 * np.ptp(problem.clean[i]))
        np.testing.assert_array_equal(one[i].y, again[i].y)
        assert not np.array_equal(one[i].y, other[i].y)


def test_errors_as_large_as_the_bound_give_one():
    problem = problems.p1()[0]
    truths = np.array([entry.values[:3] for entry in problem.bounds])
    errors = np.array([entry.errors[:3] for entry in problem.bounds])
    models = np.array([truths + errors, truths - errors])
    assert rmse_over_bound(problem, models) == pytest.approx(1.0)
    models[0, 0] = np.nan      # no model: does not count
    assert rmse_over_bound(problem, models) == pytest.approx(1.0)


@pytest.mark.slow
def test_the_joint_cost_is_the_sum_of_the_costs():
    signals = problems.p1()[0].draw(0)
    joint = Joint(signals)
    points = np.random.default_rng(0).uniform(size=(3, joint.dimension))
    expected = [sum(map(reference.cost_of, signals, models)) for models in joint.models(points)]
    np.testing.assert_allclose(joint.cost(points), expected, rtol=1e-9)


def search(tracker, seed):
    random = np.random.default_rng(seed)
    while True:
        tracker.many(random.uniform(size=(7, tracker.joint.dimension)))


def test_a_tracker_ends_a_search_at_its_budget_or_its_target():
    joint = Joint(problems.p1()[0].draw(0))
    tracker = Tracker(joint, 100)
    pursue(search, tracker, 0)
    assert tracker.spent == 100
    assert tracker.best_cost == pytest.approx(joint.cost(tracker.best[None])[0])
    hurried = Tracker(joint, 100, target=tracker.best_cost)
    pursue(search, hurried, 0)
    assert hurried.best_cost == tracker.best_cost and hurried.spent <= 100
    # Exactly the evaluations up to the one that reached it.
    shorter = Tracker(joint, hurried.spent - 1)
    pursue(search, shorter, 0)
    assert shorter.best_cost > tracker.best_cost


@pytest.mark.slow
def test_plain_numpy_rolls_out_what_the_compiled_model_does():
    problem = rollout.Problem(samples=20, batch=3)
    assert np.abs(problem.compiled(rollout.roll_out) - problem.in_numpy()).max() < 1e-9


def test_a_table_is_aligned():
    assert tables.markdown(('what', 'n'), [('a', 1), ('long', 100)]).splitlines() == [
        '| what |   n |', '| ---- | --: |', '| a    |   1 |', '| long | 100 |']


def test_a_target_is_met_or_not_or_nothing_was_measured():
    text = tables.targets([('a', '≤ 1 s', '0.5 s', np.True_), ('b', '≤ 1 s', '2 s', False),
                           ('c', '≤ 1 s', 'nothing', None)])
    assert [line.split('|')[-2].strip() for line in text.splitlines()[2:]] == ['yes', '**no**',
                                                                               '–']


def test_without_real_flights_their_target_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr(diagnosis, 'PLACE', Path('shared') / 'flights' / 'of-nobody')
    assert diagnosis.found_beside(tmp_path / 'file') is None
    what, _, measured, met = diagnosis.on_real_flights(None, diagnosis.REAL)
    assert what == 'CPU time, 7 real flights' and met is None
    assert measured == f'not there: {diagnosis.PLACE}'


@needs_real_flights
@pytest.mark.parametrize(('seconds', 'met'), [(14.0, True), (20.0, False)])
def test_real_flights_are_timed_where_they_are_there(monkeypatch, seconds, met):
    seen = []

    def timed(function, *arguments):
        seen.append((function, *arguments))
        return None, seconds

    monkeypatch.setattr(diagnosis, 'timed', timed)
    folder = diagnosis.found_beside(Path(__file__))
    row = diagnosis.on_real_flights(folder, ('figure8_fast', 'circle_slow'))
    assert row[2:] == (f'{seconds:.1f} s', met)
    [(function, flights, vehicle)] = seen
    assert function is diagnosis.diagnose and len(flights) == 2 and vehicle == real_vehicle()


@pytest.mark.parametrize(('value', 'text'), [
    (0.25, '0.250'), (12.34, '12.3'), (123.4, '123'), (44099.0, '44,100'), (1.5e-4, '0.000150'),
    (3e-7, '3.0e-07'), (float('nan'), '–'), (float('inf'), '∞'), (0, '0')])
def test_numbers_have_three_digits(value, text):
    assert tables.number(value) == text


def test_results_replace_what_is_between_their_markers_only():
    text = 'by hand\n<!-- bench: p1 -->\nold\n<!-- end: p1 -->\nmore\n'
    found = tables.replaced(text, 'p1', 'new')
    assert found == 'by hand\n<!-- bench: p1 -->\n\nnew\n\n<!-- end: p1 -->\nmore\n'
    assert tables.replaced(found, 'p1', 'new') == found
    with pytest.raises(ValueError, match='substring'):
        tables.replaced(text, 'p2', 'new')


@pytest.mark.parametrize('name', SECTIONS)
def test_every_section_has_its_place_in_a_document(name):
    text = (tables.DOCUMENTS / SECTIONS[name]).read_text(encoding='utf-8')
    assert tables.replaced(text, name, 'new') != text
