# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What matters, what helps steadily, what is unexplained and which flight differs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose import judgement
from quad_ident_ros.diagnose.bench import Bench, given, standard_errors_from_none
from quad_ident_ros.diagnose.candidates import Candidate, candidates
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.gap import Ends, gap
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.judgement import (
    _eliminated,
    _fewest,
    _idle,
    _support,
    beyond,
    clear,
    closes_half,
    explained_share,
    form_error_beside,
    in_any_form,
    in_forms_of,
    in_standard_errors,
    lost_shares,
    matters,
    pooled,
    stability,
    unexplained,
)
from quad_ident_ros.diagnose.priors import EffectPrior
from quad_ident_ros.diagnose.probability import Support
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.select import select
from quad_ident_ros.diagnose.verdict import flight_checks
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU, SENSORS, Stream
from quad_ident_ros.greybox.parameters import INDEX
from quad_ident_ros.model.vehicle import load_vehicle

GROUPS = ('position', 'velocity', 'attitude', 'rate')
NOISE = {'position': 0.01, 'velocity': 0.04, 'attitude': 0.01, 'rate': 0.03}


class Named(SimpleNamespace):
    """A cause that is its own key."""

    __hash__ = object.__hash__


def of(**changes):
    """Return {group: gap}: the noise's but for the changes."""
    return NOISE | changes


def test_what_is_judged_has_the_form_that_the_last_model_has_it_in():
    hayden, usual = (Candidate('ground_effect', f'ground_effect {form}', (k,), form)
                     for k, form in enumerate(('hayden', 'cheeseman_bennett')))
    drag = Candidate('rotor_drag', 'rotor_drag', (2,))
    assert in_forms_of((usual,), (drag, hayden)) == (drag, usual)
    assert in_forms_of((), (hayden,)) == (hayden,)


def test_what_is_taken_out_is_an_effect_in_whichever_form():
    """The usual form had taken the place of hayden when the effect was judged improbable."""
    hayden, usual = (Candidate('ground_effect', f'ground_effect {form}', (k,), form)
                     for k, form in enumerate(('hayden', 'cheeseman_bennett')))
    drag = Candidate('rotor_drag', 'rotor_drag', (2,))
    assert in_any_form((hayden, drag), (usual,)) == (hayden,)
    assert in_any_form((drag,), (usual,)) == ()


def test_the_tolerance_is_a_share_of_the_noise_but_no_less_than_its_floor():
    rules = replace(RULES, noise_share=0.25, floors={'velocity': 0.02})
    assert rules.tolerance('velocity', 0.04) == 0.02
    assert rules.tolerance('velocity', 0.4) == pytest.approx(0.1)
    rules = replace(rules, visible=0.1)
    assert rules.least('velocity', 0.04) == 0.01
    assert rules.least('velocity', 0.4) == pytest.approx(0.04)
    assert set(RULES.floors) == set(GROUPS)


def test_a_share_is_of_what_the_nominal_vehicle_has_above_the_noise():
    shares = lost_shares(of(), of(velocity=0.14), of(velocity=0.54), NOISE, RULES)
    assert shares['velocity'] == pytest.approx(0.1 / 0.5)
    assert shares['position'] == shares['rate'] == 0.0
    # A model that is better than the noise estimate says what noise there is.
    shares = lost_shares(of(velocity=0.03), of(velocity=0.05), of(velocity=0.23), NOISE, RULES)
    assert shares['velocity'] == pytest.approx(0.02 / 0.2)


def test_a_share_of_next_to_nothing_is_a_share_of_the_least_that_is_seen():
    after, without = of(velocity=0.04), of(velocity=0.041)
    shares = lost_shares(after, without, without, NOISE, RULES)
    assert shares['velocity'] == pytest.approx(0.001 / RULES.least('velocity', 0.04))


def test_what_closes_less_than_what_is_material_does_not_matter():
    before = of(velocity=1.04)
    assert not matters(of(), of(velocity=0.04 + 0.9 * RULES.material), before, NOISE, RULES)
    assert matters(of(), before, before, NOISE, RULES)


def test_a_further_effect_matters_beside_more_than_the_error_of_form_of_the_first():
    """The first one closes 2 m/s; it may err by a fifth of it, 0.4 m/s, which proves nothing."""
    before = of(velocity=2.0)
    for remains, expected in ((0.3, False), (0.6, True)):
        share = (remains - 0.04) / (2.0 - 0.04)
        assert share > RULES.material
        assert matters(of(), of(velocity=remains), before, NOISE, RULES) is expected


def test_a_further_effect_matters_beside_less_where_a_fleet_knows_the_form_of_the_first():
    """It may err by a twentieth then, 0.1 m/s; of several others the largest error counts."""
    drag, lag, wind = (SimpleNamespace(effect=name) for name in ('rotor_drag', 'motor_lag',
                                                                 'wind'))
    known = replace(RULES, priors={'rotor_drag': EffectPrior(0.5, form_error=0.05)})
    assert form_error_beside((drag, wind), (wind,), known) == 0.05
    assert form_error_beside((drag, lag, wind), (wind,), known) == RULES.form_error
    assert form_error_beside((wind,), (wind,), known) == RULES.form_error
    before, without = of(velocity=2.0), of(velocity=0.3)
    assert not matters(of(), without, before, NOISE, known)
    assert matters(of(), without, before, NOISE, known, form_error=0.05)


def test_what_is_known_apart_matters_whatever_the_error_of_form_of_others():
    """A gap of 3 m/s, of which all but 0.4 is closed without it: 13 %, but less than a fifth."""
    before, without = of(velocity=3.0), of(velocity=0.4)
    assert not matters(of(), without, before, NOISE, RULES)
    assert matters(of(), without, before, NOISE, RULES, apart=True)
    mild = replace(RULES, floors=dict.fromkeys(GROUPS, 50.0))
    assert not matters(of(), without, before, NOISE, mild, apart=True)


@pytest.mark.parametrize(('contribution', 'distance', 'expected'), [
    (0.08, 30.0, True), (0.02, 3.5, False), (1.0, 0.95 * RULES.shown, False)])
def test_what_is_probable_and_some_standard_errors_from_none_is_clear(
        contribution, distance, expected):
    support = Support(contribution, 5.0, 0.9, {}, distance, relative=0.3)
    cause = Named(effect='wind')
    assert clear({cause: support}, distance, RULES) is expected


def test_what_a_fleet_often_has_is_clear_sooner():
    cause, support = Named(effect='wind'), Support(0.02, 5.0, 0.9, {}, 1.5, relative=0.3)
    often = replace(RULES, priors={'wind': EffectPrior(0.95, {}, {}, None)})
    assert not clear({cause: support}, 3.5, RULES) and clear({cause: support}, 3.5, often)


def test_effects_that_cancel_are_not_clear_together():
    support = Support(1.0, 5.0, 0.9, {}, 50.0)
    one, other = Named(effect='mass_offset'), Named(effect='thrust_scale')
    assert clear({one: support}, 50.0, RULES)
    assert not clear({one: support, other: support}, 1.0, RULES)


def test_an_effect_explains_what_it_does_in_the_group_where_it_does_most():
    """A loss of all of a tiny gap in position is little beside nine tenths of a large rate."""
    ends = (Ends(np.zeros((4, 12)), np.arange(4.0)),)
    one, other = (SimpleNamespace(gap=each, ends=ends) for each in (
        of(position=0.0099), of(position=0.0105, rate=0.6)))
    before = of(position=0.0105, rate=0.66)
    support = _support(one, other, before, NOISE, 7.0, RULES)
    assert support.distance == 7.0
    assert support.explained == pytest.approx(1.0, abs=0.01)
    assert support.contribution == pytest.approx(max(lost_shares(
        one.gap, other.gap, before, NOISE, RULES).values()))


def test_one_group_in_which_an_effect_matters_is_enough():
    before = of(velocity=2.0, rate=0.5)
    assert matters(of(), of(velocity=0.05, rate=0.4), before, NOISE, RULES)


def ends(errors):
    """Return Ends of one prediction every 0.1 s."""
    return Ends(errors, 0.1 * np.arange(len(errors)))


def test_the_stability_is_the_mean_over_its_standard_error_over_blocks():
    """Saved in each block of 2 s, from the squared errors in units of what remains."""
    count, blocks = 400, 20
    random = np.random.default_rng(1)
    one = np.zeros((count, 12))
    one[:, 3:6] = 0.1
    more = np.repeat(random.uniform(0.0, 0.2, blocks), count // blocks)
    other = one.copy()
    other[:, 3:6] = np.sqrt(0.01 + more[:, None] / 3.0)
    scale = 3.0 * 0.1 ** 2     # the squared gap that remains: above the noise's
    saved = more.reshape(blocks, -1).sum(axis=1) / scale
    expected = saved.mean() / (saved.std() / np.sqrt(blocks))
    noise = dict.fromkeys(GROUPS, 1e-3)
    assert stability((ends(one),), (ends(other),), noise, RULES) == pytest.approx(expected)
    assert stability((ends(other),), (ends(one),), noise, RULES) < 0.0


def test_blocks_of_every_flight_count():
    random = np.random.default_rng(2)
    flights = [(ends(random.normal(size=(200, 12))), ends(random.normal(size=(200, 12)) * 1.2))
               for _ in range(9)]
    noise = dict.fromkeys(GROUPS, 0.1)
    few, many = (stability(*zip(*flights[:k], strict=True), noise, RULES) for k in (1, 9))
    assert many == pytest.approx(3.0 * few, rel=0.5) and many > 6.0


def test_chance_is_not_steady():
    """About as many values as a standard normal variable has lie beyond 2."""
    random, noise = np.random.default_rng(3), dict.fromkeys(GROUPS, 0.1)
    values = [stability((ends(random.normal(size=(400, 12))),),
                        (ends(random.normal(size=(400, 12))),), noise, RULES)
              for _ in range(200)]
    assert np.mean(np.abs(values) > 2.0) < 0.12 and abs(np.mean(values)) < 0.25


def test_what_is_within_the_tolerance_is_not_unexplained():
    just = np.hypot(0.04, RULES.tolerance('velocity', 0.04))
    assert not unexplained(of(velocity=0.99 * just), NOISE, NOISE, False, RULES)
    assert unexplained(of(velocity=1.01 * just), NOISE, NOISE, False, RULES).keys() == {'velocity'}
    wider = replace(RULES, floors=RULES.floors | {'velocity': 5.0})
    assert not unexplained(of(velocity=3.0), of(velocity=4.0), NOISE, False, wider)


def test_beside_named_effects_their_error_of_form_is_not_unexplained():
    before, after = of(velocity=1.0), of(velocity=0.3)
    assert unexplained(after, before, NOISE, False, RULES)['velocity'] == pytest.approx(
        np.sqrt(0.3 ** 2 - 0.04 ** 2))
    assert not unexplained(after, before, NOISE, True, RULES)
    assert unexplained(of(velocity=0.8), before, NOISE, True, RULES)


def test_gaps_of_flights_are_pooled_by_their_squares():
    assert pooled([{'rate': 3.0}, {'rate': 4.0}])['rate'] == pytest.approx(np.sqrt(12.5))
    assert beyond(5.0, 3.0) == pytest.approx(4.0) and beyond(3.0, 5.0) == 0.0


def checks_of(*sizes, named=True):
    """Return the checks of flights whose velocity is off by so many m/s."""
    def flight(size):
        errors = np.full((100, 12), 0.01)
        errors[:, 3:6] = size / np.sqrt(3.0)
        return ends(errors)

    return checked([flight(size) for size in sizes], named, [flight(1.0) for _ in sizes])


def checked(flights, named, before=None):
    """Return the checks of flights by the Ends of each."""
    noise = {'position': 0.02, 'velocity': 0.04, 'attitude': 0.02, 'rate': 0.02}
    effects = ('an effect',) if named else ()
    judged = SimpleNamespace(
        left_out=tuple(flights), material=effects, before=tuple(before or flights),
        noise=[noise for _ in flights])
    tracks = [SimpleNamespace(name=f'flight {k}') for k in range(len(flights))]
    return flight_checks(SimpleNamespace(tracks=tracks, rules=RULES), judged)


def test_a_flight_that_the_model_of_the_others_does_not_explain_differs():
    checks = checks_of(0.05, 0.045, 0.05, 0.9)
    assert [one.flight for one in checks if one.differs] == ['flight 3']
    assert checks[3].gap_over_noise['velocity'] == pytest.approx(0.9 / 0.04)
    # The one that was held out has no other part in this than those learnt from.
    assert [one.flight for one in checks_of(0.05, 0.9, 0.05) if one.differs] == ['flight 1']


def test_a_flight_that_differs_by_chance_is_not_singled_out():
    """Noise that hangs together makes one flight of ten worse by a third now and then."""
    random, differing = np.random.default_rng(5), 0
    for _ in range(100):
        flights = []
        for _ in range(4):
            errors = np.full((100, 12), 0.01)
            # Of five blocks of 2 s each has noise of another size.
            size = 0.04 * np.exp(random.normal(scale=0.4, size=5))
            errors[:, 3:6] = np.repeat(size, 20)[:, None] / np.sqrt(3.0)
            flights.append(ends(errors))
        differing += any(one.differs for one in checked(flights, named=False))
    assert differing <= 5


def test_a_form_that_errs_alike_in_all_flights_singles_out_none():
    assert not any(one.differs for one in checks_of(0.5, 0.55, 0.5, 0.6))


def test_without_a_named_effect_less_remains_unsaid():
    """Beside an effect that closes 1 m/s an error of its form of 0.3 m/s is nothing new."""
    assert not any(one.differs for one in checks_of(0.05, 0.05, 0.3))
    assert checks_of(0.05, 0.05, 0.3, named=False)[2].differs


@pytest.mark.slow
def test_what_a_flight_has_by_itself_stays_when_effects_are_taken_out_and_flights_left_out():
    """Its thrust is no part of what the others show, and not free where an effect is removed."""
    vehicle, noise = load_vehicle('hummingbird'), SENSORS['mocap_imu']
    records = [fly_closed_loop(vehicle, {'gyro_bias': {'x': 0.05}, 'motor_lag': {
        'time_constant': 0.03}, 'thrust_scale': {'factor': factor}}, 'lissajous', duration=10.0,
        seed=seed, noise=noise)
               for seed, factor in enumerate((1.06, 0.94, 1.0))]
    intake = take_in(records, vehicle, None, RULES)
    selection = select(intake.flights, vehicle, candidates(intake.flights, vehicle, RULES), RULES)
    bench = Bench.of(intake.flights, (*intake.tracks, intake.held_out), vehicle, selection, RULES)
    model = bench.model(selection.best.chosen, selection.best.estimate)
    assert {cause.effect for cause in model.effects} == {'gyro_bias', 'motor_lag'}
    removed = tuple(cause for cause in model.effects if cause.effect == 'gyro_bias')
    less = bench.without(model, removed)
    column = INDEX['thrust_scale.factor']
    thrusts = [vector[column] for vector in less.vectors]
    assert thrusts == pytest.approx([1.06, 0.94, 1.0], abs=0.01)
    for unseen, as_fitted in zip(bench.left_out(less), less.ends, strict=True):
        assert gap([unseen])['velocity'] == pytest.approx(gap([as_fitted])['velocity'], rel=0.05)
    # Begun by the slopes at the whole model the fit ends where it does by new ones.
    begun = bench.without(model, removed, bench.slopes(model))
    columns = less.estimate.columns
    assert begun.z[columns] == pytest.approx(less.z[columns], abs=0.5 * less.estimate.errors.min())
    assert begun.gap == pytest.approx(less.gap, rel=0.01)
    # What comes back beside the others is what it was.
    back = bench.beside(less, removed, model.z)
    assert set(back.effects) == set(model.effects)
    columns = model.estimate.columns
    assert back.z[columns] == pytest.approx(model.z[columns],
                                            abs=0.5 * model.estimate.errors.min())
    assert back.gap == pytest.approx(model.gap, rel=0.01)


def dragged():
    """Return a vehicle that feels the wind."""
    vehicle = load_vehicle('hummingbird')
    return replace(vehicle, linear_drag=(0.3 * vehicle.mass,) * 3)


@pytest.mark.slow
def test_a_wind_that_flights_share_but_for_a_little_is_an_effect_and_no_nuisance():
    """Two flights to learn from, whose winds differ by more than the noise."""
    vehicle = dragged()
    records = [fly_closed_loop(vehicle, {'wind': {'x': -0.5 * share, 'y': 0.9 / share}},
                               'lissajous', duration=10.0, seed=seed, noise=SENSORS['mocap_imu'])
               for seed, share in enumerate((1.1, 0.95, 1.0))]
    found = diagnose(records, vehicle)
    assert found.verdict == ('wind',)
    assert 'wind_by_flight' in found.nuisances
    [wind] = [row for row in found.ranking if row.effect == 'wind']
    assert wind.parameters['y'].value == pytest.approx(0.9, abs=0.1)


@pytest.mark.slow
def test_what_flights_share_by_chance_is_their_own_where_no_effect_is_there():
    """The winds of two flights to learn from are nearly the same; the one held out has another."""
    vehicle = dragged()
    records = [fly_closed_loop(vehicle, {'wind': {'x': x, 'y': y}}, 'lissajous', duration=10.0,
                               seed=seed, noise=SENSORS['mocap_imu'])
               for seed, (x, y) in enumerate(((0.9, 0.1), (0.9, 0.24), (-0.3, 0.9)))]
    intake = take_in(records, vehicle, None, RULES)
    selection = select(intake.flights, vehicle, candidates(intake.flights, vehicle, RULES), RULES)
    bench = Bench.of(intake.flights, (*intake.tracks, intake.held_out), vehicle, selection, RULES)
    model = bench.model(selection.best.chosen, selection.best.estimate)
    [wind] = [cause for cause in model.effects if cause.effect == 'wind']
    column = INDEX['wind.x']
    removed, gone = bench.without(model, (wind,)), bench.absent(model, (wind,))
    assert np.mean([vector[column] for vector in removed.vectors[:-1]]) == pytest.approx(
        0.0, abs=0.05)
    assert [vector[column] for vector in gone.vectors] == pytest.approx([0.9, 0.9, -0.3], abs=0.1)
    assert gone.gap['velocity'] < removed.gap['velocity']


@pytest.mark.parametrize(('drag', 'lag', 'expected'), [
    (0.04, 0.5, 'drag'), (0.5, 0.5, None),
    (0.04, 0.04, 'lag')])   # either does the work of both: first the one that costs less
def test_what_loses_nothing_in_the_model_that_is_reported_does_not_matter(drag, lag, expected):
    """Beside effects that were taken out as improbable, it may have made up for them."""
    gaps, costs = {'drag': drag, 'lag': lag}, {'drag': 20.0, 'lag': 10.0}
    causes = tuple(Named(effect=name) for name in gaps)

    def without(model, removed, _):
        [one] = removed
        return SimpleNamespace(gap=of(velocity=gaps[one.effect]),
                               estimate=SimpleNamespace(cost=costs[one.effect]))

    bench = SimpleNamespace(slopes=lambda _: None, rules=RULES, distance=lambda *_: 0.1,
                            without=without)
    model = SimpleNamespace(effects=causes, gap=of(velocity=0.04))
    supports = dict.fromkeys(causes, Support(0.5, 5.0, 0.9, {}, 3.0))
    idle = _idle(bench, model, causes, supports, of(velocity=0.8), NOISE)
    assert (idle and idle.effect) == expected


@pytest.mark.parametrize(('distance', 'stay'), [
    (20.0, ['attitude_misalignment']),      # either does, and without the wind costs less
    (0.5, [])])         # neither clearly differs from none: the drag may be wrong by as much
def test_of_two_that_stand_in_for_one_another_one_stays(monkeypatch, distance, stay):
    """Together they close less than the error of form of others may be, but one is clear."""
    drag, wind, tilt = causes = tuple(Named(effect=name, columns=()) for name in (
        'rotor_drag', 'wind', 'attitude_misalignment'))
    costs = {wind: 10.0, tilt: 20.0, drag: 900.0}

    def model(effects):
        velocity = (0.04 if {wind, tilt} & set(effects) else 0.12) if drag in effects else 0.7
        cost = sum(costs[one] for one in causes if one not in effects)
        return SimpleNamespace(effects=effects, gap=of(velocity=velocity),
                               estimate=SimpleNamespace(cost=cost))

    def support(model, without, before, noise, distance, rules):
        share = lost_shares(model.gap, without.gap, before, noise, rules)['velocity']
        explained = explained_share(model.gap['velocity'], without.gap['velocity'],
                                    noise['velocity'], 0.01)
        return Support(share, 5.0, explained, without.gap, distance)

    bench = SimpleNamespace(
        slopes=lambda _: None, rules=RULES, distance=lambda *_: distance,
        without=lambda model_, removed, _: model(tuple(
            one for one in model_.effects if one not in removed)))
    monkeypatch.setattr(judgement, '_support', support)
    monkeypatch.setattr(judgement, '_by_instruments', lambda *_: np.inf)
    monkeypatch.setattr(judgement, 'tie', lambda *_: 1.0)
    left, _, _ = _eliminated(bench, model(causes), of(velocity=0.8), NOISE)
    assert [one.effect for one in left.effects] == ['rotor_drag', *stay]


def test_one_block_of_time_has_no_standard_error():
    assert in_standard_errors(np.array([5.0])) == 0.0
    assert in_standard_errors(np.array([1.0, 3.0])) == pytest.approx(4.0 / np.sqrt(2.0))


@pytest.mark.parametrize(('drag', 'thrust', 'expected'), [
    (0.2, 0.1, ['thrust']),     # of two that do, the more probable one, whichever does more
    (0.1, 0.2, ['thrust']),
    (0.2, 0.5, ['drag']),       # the only one of them that does
    (0.5, 0.5, ['drag', 'thrust'])])
def test_uncertain_effects_are_named_as_few_as_close_half_of_the_gap(drag, thrust, expected):
    gaps = {('drag',): drag, ('thrust',): thrust}

    def model(effects, velocity):
        return SimpleNamespace(effects=tuple(SimpleNamespace(effect=name) for name in effects),
                               gap=of(velocity=velocity))

    def without(whole, removed, _):
        gone = [one.effect for one in removed]
        kept = tuple(one.effect for one in whole.effects if one.effect not in gone)
        return model(kept, gaps[kept])

    bench = SimpleNamespace(slopes=lambda _: None, without=without, rules=RULES)
    whole = model(('drag', 'thrust'), NOISE['velocity'])
    fewest = _fewest(bench, whole, of(velocity=0.64), NOISE, {'drag': 0.2, 'thrust': 0.4})
    assert [cause.effect for cause in fewest.effects] == expected


@pytest.mark.slow
@pytest.mark.parametrize(('lag', 'verdict'), [(0.0, 'none'), (0.02, 'motor_lag')])
def test_an_offset_of_the_clocks_does_not_take_over_a_lag(lag, verdict):
    """States are stamped later than the commands, in each flight by another time."""
    vehicle = load_vehicle('hummingbird')
    effects = {'motor_lag': {'time_constant': lag}} if lag else {}
    records = []
    for seed, (late, course) in enumerate(((0.003, 'lissajous'), (0.009, 'steps'),
                                           (0.006, 'figure8'))):
        sensors = replace(MOCAP_IMU, mocap=Stream(delay=late), imu=Stream(delay=late),
                          rotors=False)
        records.append(fly_closed_loop(vehicle, effects, course, duration=10.0, seed=seed,
                                       noise=sensors))
    found = diagnose(records, vehicle)
    assert found.verdict == (verdict,)
    assert np.ravel(found.nuisances['clock_offset']['values']) == pytest.approx(
        [0.003, 0.009], abs=2e-3)
    if lag:
        [row] = [one for one in found.ranking if one.effect == 'motor_lag']
        assert row.parameters['time_constant'].value == pytest.approx(lag, rel=0.1)


def test_what_is_known_of_one_of_two_once_the_other_is():
    """Two of which only the sum is known well: one that is 0 leaves the sum to the other."""
    each, total = 1.0, 0.1      # standard deviations, before and of the sum
    covariance = np.linalg.inv(np.eye(2) / each ** 2 + np.ones((2, 2)) / total ** 2)
    moved, remains = given(covariance, [1])
    assert moved[0, 0] == pytest.approx(-1.0, abs=0.02)     # less of the one, more of the other
    assert np.sqrt(remains[0, 0]) == pytest.approx(total, rel=0.01)
    assert np.sqrt(covariance[0, 0]) > 5.0 * total
    assert remains[1] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(('each', 'rounding'), [(1e2, 0.0), (1e2, 1e-9), (1e5, 0.0), (1e8, 1e-9)])
def test_of_two_that_do_the_same_rounding_makes_no_certainty(each, rounding):
    """In units a thousand times apart; the sum is known to a thousandth, as far as is kept."""
    covariance = each ** 2 * np.array([[1.0 - rounding, -1e3], [-1e3, 1e6]])
    covariance[1, 1] += 1e6 * 1e-3 ** 2
    moved, remains = given(covariance, [1])
    assert moved[0, 0] == pytest.approx(-1e-3, rel=1e-3)
    assert np.sqrt(remains[0, 0]) > 0.99e-3
    assert 0.0 < standard_errors_from_none(np.array([0.1]), remains[:1, :1]) < 101.0


@pytest.mark.parametrize('off', [0.5, 3.0, 60.0])
def test_one_parameter_is_as_far_as_its_standard_errors(off):
    far = standard_errors_from_none(np.array([-2.0 * off]), np.array([[4.0]]))
    assert far == pytest.approx(off, rel=1e-6)


def test_parameters_that_are_tied_count_together():
    """Two of which only the sum is known: each by itself is within its error, both are not."""
    covariance = np.array([[1.0, -0.999], [-0.999, 1.0]])
    assert standard_errors_from_none(np.array([1.0, 1.0]), covariance) > 30.0
    assert standard_errors_from_none(np.array([1.0, -1.0]), covariance) < 1.0


@pytest.mark.slow
def test_of_more_parameters_without_an_effect_one_is_no_further_off_by_chance():
    rng = np.random.default_rng(8)
    for count in (1, 3, 6):
        far = [standard_errors_from_none(rng.normal(size=count), np.eye(count))
               for _ in range(2000)]
        assert np.mean(np.array(far) > 2.0) == pytest.approx(0.0455, abs=0.02)


@pytest.mark.parametrize(('after', 'expected'), [(0.4, False), (0.2, True)])
def test_what_closes_half_of_a_gap_in_one_group_is_named_in_place_of_unknown(after, expected):
    before = of(velocity=0.64)
    assert closes_half(of(velocity=after), before, NOISE, RULES) is expected


def test_half_of_a_gap_within_the_tolerance_does_not_count():
    noise = NOISE | {'velocity': 0.12}
    beyond_it = np.hypot(0.12, RULES.tolerance('velocity', 0.12))
    for before, expected in ((0.1, False), (0.99 * beyond_it, False), (1.01 * beyond_it, True)):
        assert closes_half(of(velocity=0.06), of(velocity=before), noise, RULES) is expected
