# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which sets are tried, and standard errors over those that differ in nuisances alone."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose import select as selecting
from quad_ident_ros.diagnose.candidates import Candidate, candidates, nuisance_candidates
from quad_ident_ros.diagnose.cross_validation import left_out_cost
from quad_ident_ros.diagnose.evidence import key_of
from quad_ident_ros.diagnose.fitted import Fitted, refitted
from quad_ident_ros.diagnose.promising import other_actuators, other_ratios
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.select import _Search
from quad_ident_ros.diagnose.selection import posteriors, Selection
from quad_ident_ros.diagnose.standard_errors import Joint
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.flights import flight_of, guided, track_of
from quad_ident_ros.greybox.nuisances import CLOCK, Nuisance, NuisanceValues, RARE
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.vehicle import load_vehicle

EFFECT, OTHER = Candidate('a', 'a', (0,)), Candidate('b', 'b', (1,))


def own(spread):
    kind = Nuisance('bias', 'bias', 'rad/s', (0,), (spread,), RARE)
    return Candidate('bias', 'bias', (0,), nuisance=kind)


def fitted(chosen, value, error, evidence):
    estimate = SimpleNamespace(z=np.array([value, 0.0]), columns=[0], errors=np.array([error]))
    return Fitted(chosen, estimate, evidence, (0, 0))


def selection(*sets, least=0.0, sensors=0.0):
    covariance = np.array([[least ** 2]])
    joint = Joint(covariance, np.array([[sensors ** 2]]), (), covariance)
    return Selection(sets[0], sets, {}, None, {}, [], joint, (0.0, 0.0))


def errors(*sets, least=0.0):
    return selection(*sets, least=least).errors


NARROW = fitted((EFFECT, own(0.003)), 1.0, 0.1, 0.0)


def test_one_set_has_its_own():
    assert errors(NARROW) == pytest.approx([0.1])


def test_no_error_is_smaller_than_what_formulas_may_be_wrong_by():
    assert errors(NARROW, least=0.3) == pytest.approx([0.3])


def test_errors_of_sensors_can_be_left_out_of_the_covariance():
    """Where sets differ by more than the Joint says, all parts of it are as much wider."""
    chosen = selection(NARROW, least=0.5, sensors=0.3)
    assert chosen.covariance_by_noise == pytest.approx(np.array([[0.5 ** 2 - 0.3 ** 2]]))
    wide = fitted((EFFECT, own(0.01)), 3.0, 0.1, 0.0)
    chosen = selection(NARROW, wide, least=0.5, sensors=0.3)
    assert chosen.covariance_by_noise == pytest.approx(0.64 * chosen.covariance)
    assert chosen.errors[0] > 1.0


def test_the_covariance_has_the_errors_that_are_told():
    chosen = selection(NARROW, least=0.05)
    assert np.sqrt(np.diag(chosen.covariance)) == pytest.approx(chosen.errors)


def searched(costs, evidence):
    """Return a search that has fitted sets {set: cost} with {set: log evidence}."""
    search = object.__new__(_Search)
    search.all_causes = tuple(dict.fromkeys(cause for key in costs for cause in key))
    search.rules, search.ranked, search.judged = RULES, [], {}
    search.flights = [None]     # one alone is not left out
    search.vehicle = search.noise = search.slow = None
    search.linearised_at, search.judged_around = (), {}
    search.quadratic = SimpleNamespace(scatter=1.0)
    search.tried = {key: SimpleNamespace(cost=cost, z=None) for key, cost in costs.items()}

    def judge(key):
        made = Fitted(key, search.tried[key], evidence[key], (0, 0))
        return search.judged.setdefault(key, made)

    search.judge = judge
    judge(max(evidence, key=evidence.get))
    return search


def test_a_form_at_its_bound_gives_way_to_the_best_of_all_sets_that_were_fitted(monkeypatch):
    """The usual form in its place is far worse here than a set that was not judged of late."""
    usual, odd = (Candidate('inflow', 'usual', (0,)),
                  Candidate('inflow', 'odd', (0,), usual=False))
    other = Candidate('body_drag', 'planar', (1,))
    evidence = {(odd,): 100.0, (usual,): 0.0, (other,): 90.0}
    search = searched({key: -value for key, value in evidence.items()}, evidence)
    monkeypatch.setattr(selecting, 'within_bounds',
                        lambda *_, slow=None: ((usual,), search.tried[(usual,)]))
    monkeypatch.setattr(selecting, 'out_of_bounds', lambda cause, *_: cause is odd)
    search.settle()
    assert search.best.chosen == (other,)


@pytest.mark.parametrize('effect, saved, error, kept', [
    ('inflow', 0.005, 0.001, False),    # of one effect, the form with fewer parameters
    ('inflow', 0.02, 0.001, True),      # unless it leaves more than 1 % of the cost
    ('body_drag', 0.005, 0.001, True),     # another effect is no form: the evidence decides
    ('body_drag', 0.005, 0.1, False)])     # if the flights show another form
def test_more_parameters_give_way_to_a_form_of_the_same_effect(
        monkeypatch, effect, saved, error, kept):
    vehicle = load_vehicle('hummingbird')
    curve = Candidate('inflow', 'curve', (0, 1), usual=False, plain=False)
    fewer = Candidate(effect, effect, (2,))
    search = searched({(curve,): 72000.0, (fewer,): 72000.0 * (1.0 + saved)},
                      {(curve,): 20.0, (fewer,): 0.0})
    search.vehicle = vehicle
    for fit in search.tried.values():
        fit.z, fit.columns = nominal(vehicle), [0, 1]
        fit.z[:2] += [0.5, 0.01]
        fit.errors = [0.001, error]
    monkeypatch.setattr(selecting, 'within_bounds', lambda chosen, fit, *_, slow=None:
                        (chosen, fit))
    monkeypatch.setattr(selecting, 'out_of_bounds', lambda *_: False)
    search.settle()
    assert search.best.chosen == ((curve,) if kept else (fewer,))


def test_sets_that_are_as_good_count_alike_with_what_they_differ_in():
    wide = fitted((EFFECT, own(0.01)), 1.4, 0.3, 0.0)
    assert errors(NARROW, wide) == pytest.approx([np.sqrt((0.1 ** 2 + 0.3 ** 2 + 0.4 ** 2) / 2)])


def test_they_count_by_their_evidence():
    wide = fitted((EFFECT, own(0.01)), 1.0, 0.3, -np.log(3.0))
    assert errors(NARROW, wide) == pytest.approx([np.sqrt((3 * 0.1 ** 2 + 0.3 ** 2) / 4)])


def test_sets_with_other_effects_do_not_count():
    assert errors(NARROW, fitted((EFFECT, OTHER), 2.0, 5.0, 3.0)) == pytest.approx([0.1])


def test_an_effect_in_place_of_another_has_the_evidence_of_its_set():
    one, other = (Candidate(name, name, (k,)) for k, name in enumerate(('lag', 'delay')))
    sets = [SimpleNamespace(chosen=(cause,), causes=(cause,), evidence=value)
            for cause, value in ((one, 0.0), (other, -1.0))]
    share = 1.0 / (1.0 + np.exp(-1.0))
    assert posteriors(sets, [], (one, other), set(), RULES) == {
        one: pytest.approx(share), other: pytest.approx(1.0 - share)}


def test_an_effect_beside_the_simplest_of_sets_that_are_alike_is_as_rare_as_before_looking():
    one, other = (Candidate(name, name, (k,)) for k, name in enumerate(('drag', 'wind')))
    sets = [SimpleNamespace(chosen=causes, causes=causes, evidence=value)
            for causes, value in (((one,), 0.0), ((one, other), 2.0))]
    found = posteriors(sets, [], (one, other), set(), RULES)
    assert found[one] == pytest.approx(1.0)
    share = np.exp(2.0) / (1.0 + np.exp(2.0))
    assert found[other] == pytest.approx(RULES.prior_probability * share)


def shared_by_flights(vehicle, nuisance, effect, offsets):
    """Return the (set, start, nuisances) that are fitted where flights have some offsets."""
    record = fly_closed_loop(vehicle, {}, 'hover', duration=5.0, seed=0)
    [own] = [one for one in nuisance_candidates(vehicle, 3 * [track_of(record, vehicle)])
             if one.nuisance.name == nuisance]
    values = replace(NuisanceValues.of([own.nuisance], 3), values=np.array(offsets)[:, None])
    fits = []
    best = SimpleNamespace(chosen=(own,), causes=(), estimate=SimpleNamespace(
        z=nominal(vehicle), nuisances=values, starts=[]))
    search = SimpleNamespace(all_causes=candidates([], vehicle, RULES, [effect]),
                             vehicle=vehicle, rules=RULES, best=best, judge=lambda chosen: best,
                             fit=lambda chosen, start, apart, _: fits.append(
                                 (chosen, start, apart)))
    _Search.share_alike(search)
    return fits


def test_what_flights_have_alike_is_an_effect_by_the_law_whose_parameter_it_is():
    """A vehicle file may have the thrust by another law, which is then the usual one."""
    vehicle = replace(load_vehicle('hummingbird'), effects={'thrust_scale': {'exponent': 1.9}})
    offsets = np.array([-0.09, -0.1, -0.11])
    [(chosen, start, apart)] = shared_by_flights(vehicle, 'thrust_scale_by_flight',
                                                 'thrust_scale', offsets)
    # Each flight is predicted as before: nothing is in the effect and in the nuisance, too.
    there = np.array([vector - nominal(vehicle) for vector in apart.vectors(start)])
    assert there[:, INDEX['thrust_scale.factor']] == pytest.approx(offsets)
    assert apart.values.mean() == pytest.approx(0.0, abs=1e-12)
    free = {column for cause in chosen if cause.nuisance is None for column in cause.columns}
    assert set(np.flatnonzero(start != nominal(vehicle))) == free == {INDEX['thrust_scale.factor']}


@pytest.mark.parametrize(('offsets', 'joins'), [
    ((0.037, 0.037, 0.028), True),      # states of all flights answer late: a delay
    ((0.03, -0.02, 0.01), False),       # clocks that differ by chance
    ((-0.03, -0.031, -0.029), False)])  # states that are stamped early
def test_clocks_that_all_flights_have_late_are_a_delay(offsets, joins):
    fits = shared_by_flights(load_vehicle('hummingbird'), CLOCK, 'actuation_delay', offsets)
    assert bool(fits) is joins
    for chosen, start, _ in fits:
        assert start[INDEX['actuation_delay.delay']] == pytest.approx(np.mean(offsets))
        assert {cause.effect for cause in chosen} == {CLOCK, 'actuation_delay'}


@pytest.mark.slow
def test_delays_and_lags_are_judged_alike_wherever_flights_are_linearised():
    """A lag whose slopes vanish around a delay cost nothing for its parameters by these."""
    vehicle = load_vehicle('hummingbird')
    record = fly_closed_loop(vehicle, {'actuation_delay': {'delay': 0.02}}, 'lissajous',
                             duration=12.0, seed=1, noise=SENSORS['mocap_imu'])
    flights = [flight_of(track_of(record, vehicle))]
    causes = candidates(flights, vehicle, RULES, ['actuation_delay', 'motor_lag'])
    delay, lag = ((next(one for one in causes if one.form == form),)
                  for form in ('pure_delay', 'second_order'))
    search = _Search(flights, vehicle, causes, RULES)
    search.look_among(causes, lambda share: None)
    apart, by_others = [], []
    for chosen in (delay, lag):
        search.stand_at(chosen)
        by_others.append(search.judge(delay).evidence - search.judge(lag).evidence)
        apart.append(search.judge_around(delay).evidence - search.judge_around(lag).evidence)
        assert search.simplest([delay, lag]).chosen == delay
    assert apart[0] == pytest.approx(apart[1], abs=0.1)
    # More than sets that are about as good may differ by: what FAR of the search allows for.
    assert RULES.alike < apart[0] - by_others[0] < selecting.FAR / 3.0


def search_among(records, vehicle, effects, nuisances):
    """Return the search among some effects and nuisances of flights, as it begins."""
    flights = [flight_of(track_of(record, vehicle)) for record in records]
    search = _Search(flights, vehicle, candidates(flights, vehicle, RULES, effects), RULES)
    search.nuisances = tuple(one for one in search.nuisances if one.effect in nuisances)
    return search


@pytest.mark.slow
@pytest.mark.parametrize('delays', [(0.017, 0.020, 0.023), (0.037, 0.037, 0.028)])
def test_a_delay_that_all_flights_have_stays_where_they_are_linearised_again(delays):
    """Their clocks alone are the simpler set, and as good."""
    vehicle = load_vehicle('hummingbird')
    records = [fly_closed_loop(vehicle, {'actuation_delay': {'delay': delay}}, 'lissajous',
                               duration=8.0, seed=seed, noise=SENSORS['mocap_imu'])
               for seed, delay in enumerate(delays)]
    search = search_among(records, vehicle, ['actuation_delay'], [CLOCK])
    best = selecting._searched(search, lambda share: None).best
    assert [cause.effect for cause in best.causes] == ['actuation_delay']
    assert best.estimate.z[INDEX['actuation_delay.delay']] == pytest.approx(
        np.mean(delays), abs=0.002)
    assert best.estimate.nuisances.values.sum() == pytest.approx(0.0, abs=0.004)
    # The clocks of three flights might have this mean by chance.
    [spread] = search.nuisances[0].nuisance.spreads
    assert search.selection().joint.errors == pytest.approx([spread / np.sqrt(3.0)], rel=0.01)


@pytest.mark.slow
def test_all_that_flights_have_alike_leaves_their_nuisances():
    vehicle = load_vehicle('hummingbird')
    true = {'gyro_bias.x': 0.05, 'attitude_misalignment.roll': 0.02}
    records = [fly_closed_loop(
        vehicle, {'gyro_bias': {'x': 0.05}, 'attitude_misalignment': {'roll': 0.02}}, 'lissajous',
        duration=8.0, seed=seed, noise=SENSORS['mocap_imu']) for seed in range(3)]
    search = search_among(records, vehicle, ['gyro_bias', 'attitude_misalignment'],
                          ['rate_bias', 'attitude_bias'])
    search.look_among(search.all_causes, lambda share: None)
    own = {one.effect: one for one in search.nuisances}
    search.fit(key_of(tuple(own.values())), nominal(vehicle), NuisanceValues.of(
        [one.nuisance for one in own.values()], 3), search.frame.slopes.starts)
    search.best = search.judge(key_of(tuple(own.values())))
    begun, fit = [], search.fit
    search.fit = lambda chosen, z, nuisances, starts: (
        begun.append((z, nuisances)), fit(chosen, z, nuisances, starts))
    search.share_alike()
    found = search.best.estimate
    # Where the last fit begins and where it ends.
    for z, nuisances in (begun[-1], (found.z, found.nuisances)):
        for name, value in true.items():
            assert z[INDEX[name]] == pytest.approx(value, rel=0.1)
        means = nuisances.values.mean(axis=0) / nuisances.spreads
        assert means == pytest.approx(np.zeros(len(means)), abs=0.1)


def usual_fits(vehicle, effects):
    """Return the usual candidates by effect, and how a set of them is fitted to a flight."""
    record = fly_closed_loop(vehicle, effects, 'lissajous', duration=12.0, seed=1,
                             noise=SENSORS['mocap_imu'])
    flights = [flight_of(track_of(record, vehicle))]
    causes = {}
    for cause in candidates(flights, vehicle, RULES):
        causes.setdefault(cause.effect, cause)      # the usual form first

    def fit(z, chosen, noise=None):
        return refitted(flights, vehicle, z, chosen, noise, NuisanceValues.of((), 1), None)

    return causes, fit


def test_from_a_delay_that_does_the_work_of_a_lag_the_lag_is_found():
    vehicle, lag = load_vehicle('hummingbird'), 0.05
    causes, fit = usual_fits(vehicle, {'motor_lag': {'time_constant': lag}})
    late = fit(nominal(vehicle), (causes['actuation_delay'],))
    [(chosen, start)] = other_actuators((causes['actuation_delay'],), list(causes.values()),
                                        late.z, vehicle)
    assert chosen == (causes['motor_lag'],)
    found = fit(start, chosen)
    [value], [std] = found.z[list(chosen[0].columns)], found.errors
    assert abs(value - lag) < 4 * std
    assert (found.z == nominal(vehicle))[list(causes['actuation_delay'].columns)].all()
    # Both have one parameter: in variances of the noise, far more than chance leaves.
    same = fit(late.z, (causes['actuation_delay'],), found.noise)
    assert same.cost > found.cost + 30.0


def test_from_a_thrust_that_does_the_work_of_a_large_mass_the_mass_is_found():
    vehicle = load_vehicle('hummingbird')
    added = 0.2 * vehicle.mass
    causes, fit = usual_fits(vehicle, {'mass_offset': {'mass': added},
                                       'rotor_drag': {'x': 0.1, 'y': 0.1}})
    thrust, drag = causes['thrust_scale'], causes['rotor_drag']
    light = key_of((thrust, drag))
    weak = fit(nominal(vehicle), light)
    [(chosen, start)] = other_ratios(light, list(causes.values()), weak.z, vehicle)
    assert set(chosen) == {causes['mass_offset'], drag}
    found = fit(start, chosen)
    place = found.columns.index(causes['mass_offset'].columns[0])
    assert abs(found.z[found.columns[place]] - added) < 4 * found.errors[place]
    assert (found.z == nominal(vehicle))[list(thrust.columns)].all()
    assert fit(weak.z, light, found.noise).cost > found.cost + 30.0


def test_effects_of_no_ratio_have_none_in_their_place():
    vehicle = load_vehicle('hummingbird')
    drag, thrust = Candidate('rotor_drag', 'd', (0,)), Candidate('thrust_scale', 't', (1,))
    assert other_ratios((drag,), [drag, thrust], nominal(vehicle), vehicle) == []


def test_the_thrust_of_each_flight_leaves_with_the_thrust_that_all_have():
    vehicle = load_vehicle('hummingbird')
    record = fly_closed_loop(vehicle, {}, 'hover', duration=6.0, seed=1)
    flights = [flight_of(track_of(record, vehicle))] * 2
    causes = candidates(flights, vehicle, RULES)
    thrust, mass = (next(cause for cause in causes if cause.effect == name)
                    for name in ('thrust_scale', 'mass_offset'))
    mine, clock = (next(cause for cause in nuisance_candidates(vehicle, flights)
                        if cause.effect == name) for name in ('thrust_scale_by_flight', CLOCK))
    [(chosen, _)] = other_ratios(key_of((thrust, mine, clock)), causes, nominal(vehicle), vehicle)
    assert set(chosen) == {mass, clock}


@pytest.mark.slow
def test_a_search_stands_at_no_set_twice(monkeypatch):
    """Of a payload the mass alone, and it beside biases, are each the best around the other."""
    vehicle, stood = load_vehicle('hummingbird'), []
    flights = [flight_of(guided(track_of(fly_closed_loop(
        vehicle, {'mass_offset': {'mass': 0.05}}, name, duration=30.0, seed=seed,
        noise=SENSORS['mocap_imu']), vehicle)))
        for seed, name in enumerate(('lissajous', 'steps', 'low_passes'))]
    causes = candidates(flights, vehicle, RULES, None)
    search = _Search(flights, vehicle, causes, RULES)
    stand_at = search.stand_at

    def told(chosen):
        stood.append(chosen)
        stand_at(chosen)

    monkeypatch.setattr(search, 'stand_at', told)
    search.look_among(tuple(cause for cause in causes if cause.usual), lambda share: None)
    assert 2 <= len(stood) == len(set(stood))


@pytest.mark.slow
@pytest.mark.parametrize(('truth', 'plain_predicts'), [
    ({'factor': 0.85}, True), ({'hover_factor': 0.85, 'exponent': 2.6}, False)])
def test_more_parameters_have_to_predict_flights_that_they_were_not_fitted_to(
        truth, plain_predicts):
    vehicle = load_vehicle('hummingbird')
    records = [fly_closed_loop(vehicle, {'thrust_scale': truth}, path, duration=10.0,
                               seed=seed, noise=SENSORS['mocap_imu'])
               for seed, path in enumerate(('lissajous', 'figure8'))]
    search = search_among(records, vehicle, ['thrust_scale'], [])
    search.look_among(search.all_causes, lambda share: None)
    plain, curved = ({one.chosen[0].form: one for one in search.judged.values()
                      if len(one.chosen) == 1}[name] for name in ('factor', 'curve'))
    costs = [left_out_cost(one, search.flights, vehicle, search.noise) for one in (plain, curved)]
    assert (costs[0] < costs[1]) is plain_predicts
    # Noise alone makes no curve that predicts clearly worse.
    assert search.predicts_better(curved, plain) is not plain_predicts
    assert not search.predicts_better(plain, curved)
