# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fits over seeds, which method is better, and what that makes of the paper's claims."""

from dataclasses import replace
from functools import partial
import json
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import binom

from quad_ident_ros.cluster import cluster, values
from quad_ident_ros.identify.identify import identify, Settings, with_budget
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.paper.claims import claims, FAILS, HOLDS, IN_PART, OPEN
from quad_ident_ros.paper.presets import load_preset
from quad_ident_ros.paper.ranking import between, compare, comparisons, interval
from quad_ident_ros.paper.reproduce import as_data, reproduce
from quad_ident_ros.paper.study import DIRECT, EFFORTS, EQUAL_BUDGET, middle, steps, study, SWARMS

pytestmark = pytest.mark.xdist_group('paper_study')     # one reproduction for all tests
SEEDS = 3


@pytest.fixture(scope='module')
def reproduction():
    return reproduce(('paper_table3', 'paper_unit_steps_newton_euler'), SEEDS)


@pytest.fixture(scope='module')
def table_3_study(reproduction):
    return reproduction.studies['paper_table3']


@pytest.mark.slow
def test_workers_that_share_the_seeds_give_the_same_costs(table_3_study):
    pytest.importorskip('distributed', reason="Dask is not installed: pip install '.[fleet]'")
    with cluster(workers=2) as client:
        shared = study(load_preset('paper_table3').records, SEEDS, each=partial(values, client))
    for effort in EFFORTS:
        for name in METHODS:
            np.testing.assert_array_equal(shared.costs(effort, name),
                                          table_3_study.costs(effort, name))


@pytest.mark.slow
def test_each_seed_and_method_is_fitted_with_each_effort(table_3_study):
    assert set(SWARMS) | set(DIRECT) == set(METHODS)
    for effort in EFFORTS:
        for name in METHODS:
            fits = table_3_study.fits[effort][name]
            assert len(fits) == (SEEDS if name in SWARMS else 1)
            assert all(list(fit.outputs) == list(OUTPUTS) for fit in fits)


def test_equal_budgets_are_equal_and_spent(table_3_study):
    for effort in ('per_output_equal', 'joint_equal'):
        for name in SWARMS:
            for fit in table_3_study.fits[effort][name]:
                assert {entry.evaluations for entry in fit.outputs.values()} == {EQUAL_BUDGET}
    spent = {name: table_3_study.fits['per_output'][name][0].outputs['phi'].evaluations
             for name in SWARMS}
    assert spent == {'pso': 4200, 'cs': 8200, 'pso_cs': 8200}


def test_what_is_taken_over_from_the_generations_is_what_the_budget_gives(table_3_study):
    records = load_preset('paper_table3').records
    settings = with_budget(Settings(methods=SWARMS, seed=1, poles='real'), EQUAL_BUDGET)
    for name, fit in identify(records, settings).methods.items():
        assert table_3_study.fits['per_output_equal'][name][1].cost == fit.cost


@pytest.mark.slow
def test_the_same_seeds_give_the_same_costs(table_3_study):
    progress = []
    again = study(load_preset('paper_table3').records, SEEDS, lambda: progress.append(1))
    for effort in EFFORTS:
        for name in METHODS:
            np.testing.assert_array_equal(again.costs(effort, name),
                                          table_3_study.costs(effort, name))
    assert len(progress) == steps(SEEDS)


def test_median_and_worst_are_runs_of_their_output(table_3_study):
    median, worst = (table_3_study.pick(rank, 'per_output')
                     for rank in ('median', 'worst'))
    for name in METHODS:
        for output in OUTPUTS:
            costs = table_3_study.costs('per_output', name, output)
            assert worst.methods[name].outputs[output].cost == costs.max()
            assert median.methods[name].outputs[output].cost == middle(sorted(costs))
    assert middle([1, 2, 3]) == 2 and middle([1, 2, 3, 4]) == 2


def test_the_total_error_is_the_rms_of_the_outputs(table_3_study):
    fit = table_3_study.fits['joint']['pso'][0]
    each = [entry.errors['nrmse_percent'] for entry in fit.outputs.values()]
    assert table_3_study.nrmse('joint', 'pso')[0] == pytest.approx(np.sqrt(np.mean(
        np.square(each))))


@pytest.mark.parametrize(('wins', 'count'), [(81, 263), (1, 29), (10, 20), (19, 20)])
def test_interval_leaves_out_as_much_on_each_side(wins, count):
    low, high = interval(wins, count)
    assert binom.sf(wins - 1, count, low) == pytest.approx(0.025)
    assert binom.cdf(wins, count, high) == pytest.approx(0.025)
    assert interval(count - wins, count) == pytest.approx((1 - high, 1 - low))


def test_interval_of_all_and_none():
    assert interval(0, 20) == pytest.approx((0.0, 1 - 0.025 ** (1 / 20)))
    assert interval(20, 20) == pytest.approx((0.025 ** (1 / 20), 1.0))
    # Five of five do not show at 95 % that a method is better, six do.
    assert interval(5, 5)[0] < 0.5 < interval(6, 6)[0]


def test_comparison_counts_seed_by_seed():
    better = compare('a', 'b', np.full(20, 1.0), np.full(20, 2.0))
    assert (better.wins, better.count, better.probability) == (20, 20, 1.0)
    assert better.verdict == 'better'
    assert compare('a', 'b', np.full(20, 2.0), np.full(20, 1.0)).verdict == 'worse'
    mixed = compare('a', 'b', np.tile([1.0, 3.0], 10), np.full(20, 2.0))
    assert (mixed.probability, mixed.verdict) == (0.5, 'undecided')
    # One result of a method without random numbers stands against each seed of the other.
    assert compare('a', 'b', np.array([1.0]), np.full(20, 2.0)).wins == 20


@pytest.mark.parametrize(('first', 'second', 'probability'), [
    (1.0, 1.0 + 1e-9, 0.5), (1e-26, 1e-30, 0.5), (np.inf, np.inf, 0.5), (np.inf, 1.0, 0.0),
    (1.0, 2.0, 1.0)])
def test_ties_and_failures_are_compared_too(first, second, probability):
    found = compare('a', 'b', np.array([first]), np.array([second]))
    assert (found.probability, found.low, found.high, found.count) == (probability,) * 3 + (1,)


def test_ranks_cover_each_pair_once(table_3_study):
    entries = comparisons(table_3_study, 'joint')
    pairs = {frozenset((entry.first, entry.second)) for entry in entries}
    assert len(pairs) == len(entries) == len(METHODS) * (len(METHODS) - 1) / 2
    entry = between(table_3_study, 'joint', 'ls', 'cs')
    assert (entry.probability, entry.count) == (1.0, SEEDS)


def found(reproduction, text):
    """Return the claim that begins so."""
    claim, = [claim for claim in claims(reproduction) if claim.text.startswith(text)]
    return claim


def test_claims_about_print_have_the_verdicts_of_their_numbers(reproduction):
    verdicts = {
        'Equations (13)-(18) are': FAILS, 'Equations (13)-(18) under': FAILS,
        'The search space': FAILS, 'Table 3 gives': IN_PART, 'All errors are smallest': FAILS,
        'Equations (36), (37)': FAILS, 'Models K/((s+a)(s+b))': IN_PART,
        'U1 = U2 = U3 = U4': FAILS, 'The gains of Table 2': FAILS}
    assert {text: found(reproduction, text).verdict for text in verdicts} == verdicts
    assert found(reproduction, 'Table 3 gives').score == '59 of 64'
    assert found(reproduction, 'Models K').score == '2 of 4'


def test_verdicts_follow_the_numbers_of_the_run(reproduction):
    cells = [replace(cell, computed=cell.printed) for cell in reproduction.cells]
    lasting = [replace(case, status='complete') for case in reproduction.cases]
    trips = [replace(trip, printed=trip.model) for trip in reproduction.trips]
    other = replace(reproduction, cells=cells, cases=lasting, trips=trips)
    for text in ('Table 3 gives', 'Equations (13)-(18) are', 'Equations (13)-(18) under',
                 'Equations (36), (37)'):
        assert found(other, text).verdict == HOLDS


def forged(reproduction, seeds=20, **costs):
    """Return the reproduction with one study whose methods have costs (seeds,) at any effort."""
    def fits(values):
        return tuple(SimpleNamespace(
            cost=value, seconds=1.0, evaluations=1,
            outputs={output: replace(reproduction.printed.methods['ls'].outputs[output],
                                     cost=value / 4) for output in OUTPUTS}) for value in values)

    only = reproduction.studies['paper_table3']
    by_method = {name: fits(np.broadcast_to(costs.get(name, 1.0), seeds)) for name in METHODS}
    only = replace(only, fits=dict.fromkeys(EFFORTS, by_method))
    return replace(reproduction, presets={'paper_table3': reproduction.presets['paper_table3']},
                   studies={'paper_table3': only})


def test_claims_of_ranking_follow_the_costs(reproduction):
    text = 'PSO-CS is better than PSO, at equal evaluations'
    for cost, verdict in ((0.5, HOLDS), (2.0, FAILS), (np.tile([0.5, 2.0], 10), OPEN)):
        claim = found(forged(reproduction, pso_cs=cost), text)
        assert claim.verdict == verdict
    assert claim.score == '0 of 2'
    claim = found(forged(reproduction, ls=2.0, cs=3.0), 'LS is worse than PSO, CS and PSO-CS, one '
                                                        'search per output')
    assert (claim.verdict, claim.score) == (IN_PART, '2 of 3, opposite in 1')


def test_that_no_method_is_better_is_decided_by_all_cases(reproduction):
    text = 'No method of the paper is better'
    better = found(forged(reproduction, vp=0.5), text)
    # Four searches of three methods, and least squares.
    assert (better.verdict, better.score) == (HOLDS, '13 of 13')
    equal = found(forged(reproduction), text)
    assert (equal.verdict, equal.score) == (HOLDS, '13 of 13') and 'better in 0,' in equal.numbers
    unsure = found(forged(reproduction, vp=0.5, cs=np.tile([0.4, 0.6], 10)), text)
    assert (unsure.verdict, unsure.score) == (OPEN, '9 of 13')
    refuted = found(forged(reproduction, vp=0.5, ls=0.4, cs=np.tile([0.4, 0.6], 10)), text)
    assert (refuted.verdict, refuted.score) == (FAILS, '8 of 13')


def test_one_seed_leaves_claims_of_ranking_undecided(reproduction):
    entries = [claim for claim in claims(forged(reproduction, seeds=1, vp=0.5, cs=2.0))
               if 'better' in claim.text or claim.text.startswith('LS is worse')]
    assert len(entries) == 7 and {claim.verdict for claim in entries} == {OPEN}


def test_claims_leave_out_what_was_not_flown(reproduction):
    texts = [claim.text for claim in claims(forged(reproduction))]
    assert not any('unit steps' in text and '(13)' not in text for text in texts)
    assert any(text.startswith('The search space') for text in texts)


def test_data_is_json_and_has_everything(reproduction):
    data = json.loads(json.dumps(as_data(reproduction, claims(reproduction)), allow_nan=False))
    assert data['seeds'] == SEEDS and len(data['table_3']) == 64
    assert len(data['claims']) == len(claims(reproduction))
    preset = data['presets']['paper_table3']
    assert set(preset['median']['joint']['methods']) == set(METHODS)
    assert len(preset['costs']['joint']['cs']['phi']) == SEEDS
    assert preset['truth']['psi'] == [-9981.93, 0.0, 0.0]
    assert {entry['first'] for entry in preset['ranking']['per_output']['all']} <= set(METHODS)


def test_one_seed_decides_nothing_between_methods_that_draw_numbers():
    assert compare('pso', 'cs', np.array([1.0]), np.array([2.0])).verdict == 'undecided'
    assert compare('ls', 'vp', np.array([2.0]), np.array([1.0])).verdict == 'worse'
