# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is each flight's own - clocks, trims, biases, glitches, lost rows - is no effect."""

from dataclasses import replace

from effect_flights import acted
from flying import VEHICLES
import numpy as np
import pytest

from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.quality.glitches import glitches, others, spikes
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.greybox.nuisances import (
    are_alike,
    Nuisance,
    nuisances,
    NuisanceValues,
)
from quad_ident_ros.model.attitude import product, rotation_matrix, turn
from quad_ident_ros.model.dynamics import STATES
from quad_ident_ros.model.residual_function import ResidualFunction
from quad_ident_ros.model.vehicle import load_vehicle

# One diagnosis for all tests.
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('nuisances')]
EXPERIMENT = load_experiment('closed_loop')
VEHICLE = EXPERIMENT.vehicle
DRAG = {'rotor_drag': {'coefficient': 0.25}}
LATE = (3, -2, 1, -3)       # samples of 0.01 s that the states are stamped late


def flown(effects):
    """Return the records of the flights of an experiment with effects."""
    real = EXPERIMENT.with_effects(effects)
    return [fly(real, run, seed=3).record for run in real.runs]


@pytest.fixture(scope='module')
def dragged():
    return flown(DRAG)


@pytest.fixture(scope='module')
def clean(dragged):
    """Return the data of their diagnosis as they are."""
    return diagnose(dragged, VEHICLE).as_data()


def shifted(record, samples):
    """Return a record whose states are stamped so many samples late."""
    columns = {}
    for name, values in record.columns.items():
        behind = name in STATES or name in ('ax', 'ay', 'az')
        first = max(samples, 0) - (samples if behind else 0)
        columns[name] = values[first:first + len(record) - abs(samples)]
    first = max(samples, 0)
    return replace(record, t=record.t[first:first + len(record) - abs(samples)], columns=columns)


def unanswered(record, seed):
    """Return a record with noise that no controller saw, so that none answers to it."""
    random = np.random.default_rng(seed)
    sizes = {'p': 0.003, 'v': 0.03, 'w': 0.03}
    columns = {name: record.columns[name] + sizes[name[0]] * random.normal(size=len(record))
               for name in STATES if name[0] in sizes}
    q = product(attitude_of(record), turn(0.006 * random.normal(size=(len(record), 3))))
    return changed(record, **columns, **dict(zip(('qw', 'qx', 'qy', 'qz'), q.T, strict=True)))


def changed(record, **columns):
    return replace(record, columns=record.columns | columns)


def trimmed(records, trims):
    """
    Return records with rotors that give more at one side, less at the other: a moment.

    Args: trims: about x, y and, or none, z, for each record.
    """
    hover = VEHICLE.mass * VEHICLE.gravity / VEHICLE.thrust_coefficient / len(VEHICLE.rotors)
    places = np.array([rotor.position for rotor in VEHICLE.rotors]) / VEHICLE.arm_length
    spins = np.array([rotor.spin for rotor in VEHICLE.rotors])
    flights = []
    for record, (roll, pitch, *yaw) in zip(records, trims, strict=True):
        more = hover * (roll * places[:, 1] - pitch * places[:, 0] + sum(yaw) * spins)
        flights.append(changed(record, **{
            name: np.sqrt(np.maximum(record.columns[name] ** 2 + more[j], 0.0))
            for j, name in enumerate(f'cmd{j}' for j in range(1, 1 + len(more)))}))
    return flights


def attitude_of(record):
    return record.stack('qw', 'qx', 'qy', 'qz')


def parameters(data, effect):
    """Return {name: (value, std)} of an effect that was found."""
    [row] = [row for row in data['ranking'] if row['effect'] == effect]
    return {name: (one['value'], one['std']) for name, one in row['parameters'].items()}


@pytest.fixture(scope='module')
def open_loop(dragged):
    """Return flights whose commands do not show when the states were measured."""
    return [unanswered(record, seed) for seed, record in enumerate(dragged)]


def test_clocks_that_differ_from_flight_to_flight_are_no_delay(open_loop):
    data = diagnose([shifted(one, late) for one, late in zip(open_loop, LATE, strict=True)],
                    VEHICLE).as_data()
    assert data['verdict'] == ['rotor_drag']
    value, std = parameters(data, 'rotor_drag')['coefficient']
    assert abs(value - DRAG['rotor_drag']['coefficient']) < 4 * std
    offsets = data['nuisances']['clock_offset']
    assert np.ravel(offsets['values']) == pytest.approx([0.03, -0.02, 0.01], abs=0.003)
    assert offsets['held_out'] == pytest.approx([-0.03], abs=0.003)
    # A delay within the scatter of the clocks is not ruled out, and that is said.
    assert 0.01 < offsets['hidden_delay'] < 0.05
    assert data['gap']['closed'] > 0.95


@pytest.mark.xfail(strict=True, reason='noise of the recorded attitude, which guides the '
                   'translation, is taken for biases of it below 2 mrad')
def test_flights_without_anything_of_their_own_are_told_so(clean):
    assert clean['nuisances'] is None


@pytest.mark.parametrize('count', [1, 2])
def test_few_late_flights_have_a_delay_though_their_sensors_have_biases(count):
    """Their clocks would explain it as well, but nothing shows that these differ."""
    vehicle, truth = VEHICLES['hummingbird'], {'actuation_delay': {'delay': 0.0137}}
    flights = [fly_closed_loop(vehicle, truth, 'steps', duration=12.0, seed=seed,
                               noise=SENSORS['mocap_imu']) for seed in (1, 2)][:count]
    data = diagnose(flights, vehicle).as_data()
    assert data['verdict'] == ['actuation_delay']
    value, std = parameters(data, 'actuation_delay')['delay']
    assert abs(value - 0.0137) < 4 * std


def test_what_is_late_alike_in_all_flights_is_a_delay(open_loop):
    data = diagnose([shifted(one, 2) for one in open_loop], VEHICLE).as_data()
    assert set(data['verdict']) == {'actuation_delay', 'rotor_drag'}
    value, std = parameters(data, 'actuation_delay')['delay']
    assert abs(value - 0.02) < 4 * std < 0.005
    assert data['nuisances'] is None


def test_a_delay_beyond_the_scatter_of_the_clocks_is_named_with_that_scatter(open_loop):
    late = [8, 5, 7, 6]
    data = diagnose([shifted(one, k) for one, k in zip(open_loop, late, strict=True)],
                    VEHICLE).as_data()
    assert set(data['verdict']) == {'actuation_delay', 'rotor_drag'}
    value, std = parameters(data, 'actuation_delay')['delay']
    assert abs(value - 0.01 * np.mean(late[:3])) < 2 * std
    assert std == pytest.approx(0.02 / np.sqrt(3), rel=0.1)
    assert 'clock_offset' in data['nuisances']


def test_trims_that_differ_from_flight_to_flight_are_no_offset_of_the_centre_of_mass(dragged):
    trims = ((0.012, -0.008), (-0.01, -0.012), (0.004, 0.014), (-0.008, 0.006))
    data = diagnose(trimmed(dragged, trims), VEHICLE).as_data()
    assert data['verdict'] == ['rotor_drag']
    assert 'trim_moment' in data['nuisances']


def test_what_tilts_all_flights_alike_is_not_hidden_in_their_trims(dragged):
    """No law here is a constant moment, but one that follows the thrust is nearly that."""
    trims = ((0.112, -0.108), (0.09, -0.112), (0.104, -0.086), (0.092, -0.094))
    data = diagnose(trimmed(dragged, trims), VEHICLE).as_data()
    assert set(data['verdict']) == {'rotor_drag', 'com_offset'}


def test_what_turns_all_flights_alike_is_unknown(dragged):
    """No effect is a moment about z alone: a simulation without it turns away all the same."""
    data = diagnose(trimmed(dragged, 4 * ((0.0, 0.0, 0.1),)), VEHICLE).as_data()
    assert data['verdict'] == ['rotor_drag', 'unknown']
    assert data['unknown'][0]['channel'] == 'Mz'
    assert not (data['nuisances'] or {}).get('trim_moment')


def test_a_small_moment_that_all_flights_share_is_not_hidden_either():
    """It is a fortieth of what trims of 30 g usually are, but turns them by 0.5 rad/s^2."""
    vehicle = load_vehicle('crazyflie')
    wrench = (0.0, 0.0, 0.0, 7e-6, -7e-6, -4e-6)
    real = replace(vehicle, residual=ResidualFunction(tuple(map(abs, wrench)), wrench, (), ()))
    flights = [fly_closed_loop(real, {}, 'lissajous', duration=12.0, seed=seed,
                               noise=SENSORS['mocap_imu']) for seed in range(3)]
    data = diagnose(flights, vehicle).as_data()
    assert data['verdict'] != ['none']
    assert not (data['nuisances'] or {}).get('trim_moment')


@pytest.mark.parametrize(('alike', 'values'), [
    (True, [[2.58, 1.69], [2.51, 1.63], [2.46, 1.59]]),
    (False, [[0.5, -0.4], [0.9, 0.3], [-0.2, 0.6]]),
    (False, [[0.03], [0.01], [0.02]]), (True, [[0.03, 0.5], [0.031, -0.5], [0.0305, 0.1]]),
    (True, [[0.03], [0.031], [0.0305]]),
    (False, [[2.5, 1.6]]),
    # Two flights: in two places together they show what neither place shows.
    (True, [[0.44, 0.91], [0.53, 0.79]]), (False, [[0.44], [0.53]])])
def test_flights_are_alike_where_chance_would_hardly_have_them_so(alike, values):
    values = np.array(values)
    assert are_alike(values, np.ones(values.shape[1]), 0.02) is alike


def test_places_count_by_how_much_flights_usually_differ_there():
    values = np.array([[0.44, 3e-3], [0.5, -4e-3]])
    assert are_alike(values, np.array([1.0, 1.0]), 0.02)
    assert not are_alike(values, np.array([1.0, 0.001]), 0.02)


@pytest.mark.parametrize('places', [1, 2, 3])
def test_few_flights_that_differ_by_chance_are_alike(places):
    spreads = np.arange(1.0, places + 1.0)
    values = np.random.default_rng(1).normal(size=(4000, 3, places)) * spreads
    alike = [are_alike(one, spreads, 0.02) for one in values]
    assert np.mean(alike) == pytest.approx(0.02, abs=0.006)


def test_a_wind_that_all_flights_have_nearly_alike_is_one():
    vehicle = replace(VEHICLE, linear_drag=(0.3, 0.3, 0.3))
    flights = [fly_closed_loop(vehicle, {'wind': {'x': x, 'y': y}}, 'lissajous', duration=12.0,
                               seed=seed, noise=SENSORS['mocap_imu'])
               for seed, (x, y) in enumerate(((2.2, 1.8), (2.5, 1.6), (2.8, 1.5), (2.4, 1.7)))]
    data = diagnose(flights, vehicle).as_data()
    assert data['verdict'] == ['wind']
    assert 'wind_by_flight' in data['nuisances']


def test_what_sums_to_zero_is_as_likely_as_independent_values_that_do():
    kind = Nuisance('trim', 'moment', 'N m', (0, 1, 2), (0.02, 0.02, 0.005),
                    1e-4).differing
    random = np.random.default_rng(4)
    values = random.normal(size=(5, 3)) * kind.spreads
    centred = values - values.mean(axis=0)
    cost = [np.ravel(one) @ NuisanceValues.of([kind], 5).precision @ np.ravel(one)
            for one in (centred, values)]
    # The terms of a mean that is none are 1e8 times what they sum to: eight digits are rounding.
    assert cost[0] == pytest.approx(np.sum((centred / kind.spreads) ** 2), rel=1e-6)
    assert cost[1] > 100.0 * cost[0]
    alone = NuisanceValues.of([kind], 1).precision
    assert alone == pytest.approx(np.diag(np.array(kind.spreads) ** -2.0))


def test_biases_that_differ_from_flight_to_flight_are_no_effect(dragged):
    random = np.random.default_rng(5)
    flights = []
    for record in dragged:
        bias = random.normal(0.0, 0.006, 3)
        flights.append(changed(record, **{name: record.columns[name] + one
                                          for name, one in zip(('wx', 'wy', 'wz'), bias,
                                                               strict=True)}))
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == ['rotor_drag']
    assert 'rate_bias' in data['nuisances']


@pytest.mark.parametrize('seed', [0, 2])
def test_a_bias_that_all_flights_have_nearly_alike_is_one(seed):
    """Each flight's differs by half of what they share, and none was named."""
    random = np.random.default_rng(seed)
    shared = 0.01 * random.choice([-1.0, 1.0], 3)
    flights = []
    for number, course in enumerate(('lissajous', 'figure8', 'lissajous', 'figure8')):
        record = fly_closed_loop(load_vehicle('hummingbird'), {}, course, duration=10.0,
                                 seed=number, noise=SENSORS['mocap_imu'])
        bias = shared + random.normal(0.0, 0.004, 3)
        flights.append(changed(record, **{name: record.columns[name] + one
                                          for name, one in zip(('wx', 'wy', 'wz'), bias,
                                                               strict=True)}))
    data = diagnose(flights, load_vehicle('hummingbird')).as_data()
    assert data['verdict'] == ['gyro_bias'] and 'rate_bias' in data['nuisances']


def test_how_far_biases_differ_is_part_of_the_uncertainty_of_the_one_they_share(dragged):
    """Where flights do not show which of two spreads is theirs, the error lies between both."""
    shared, own = np.array([0.05, -0.03, 0.04]), np.array([0.0038, 0.0, -0.0038])
    flights = []
    for k, record in enumerate(dragged):
        bias = shared + np.roll(own, k)
        flights.append(changed(record, **{name: record.columns[name] + one
                                          for name, one in zip(('wx', 'wy', 'wz'), bias,
                                                               strict=True)}))
    data = diagnose(flights, VEHICLE).as_data()
    assert set(data['verdict']) == {'rotor_drag', 'gyro_bias'}
    wide, narrow = sorted((kind.spreads[0] for kind in nuisances(VEHICLE, [])
                           if kind.name == 'rate_bias'), reverse=True)
    for true, (value, std) in zip(shared, parameters(data, 'gyro_bias').values(), strict=True):
        assert 1.1 * narrow / np.sqrt(3) < std < 0.9 * wide / np.sqrt(3)
        assert abs(value - true) < 4 * std


def spoilt(record, rng):
    """Return a record with an attitude in 500 off by some 20 degrees, and which ones."""
    off = np.zeros(len(record), bool)
    off[rng.choice(np.arange(2, len(record) - 2, 3), len(record) // 500, replace=False)] = True
    q = attitude_of(record)
    q[off] = product(q[off], turn(rng.normal(0.0, 0.2, (off.sum(), 3))))
    return changed(record, **dict(zip(('qw', 'qx', 'qy', 'qz'), q.T, strict=True))), off


def test_single_attitudes_that_are_off_do_not_alter_the_verdict(dragged, clean):
    random = np.random.default_rng(1)
    flights = [spoilt(record, random)[0] for record in dragged]
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == clean['verdict'] == ['rotor_drag']
    (value, std), (other, _) = (parameters(each, 'rotor_drag')['coefficient']
                                for each in (data, clean))
    assert abs(value - other) < 0.5 * std


SPIKES = {'position': ('p', 0.5), 'velocity': ('v', 2.0), 'rate': ('w', 4.0)}


def spiked(record, random):
    """Return a record with five single samples of each state off by much, as damaged messages."""
    columns = {}
    for letter, size in SPIKES.values():
        for axis in 'xyz':
            name = f'{letter}{axis}'
            columns[name] = record.columns[name].copy()
        rows = random.choice(np.arange(10, len(record) - 10, 7), 5, replace=False)
        for axis in 'xyz':
            columns[f'{letter}{axis}'][rows] += size * random.normal(size=5)
    return changed(record, **columns)


def test_single_samples_that_are_off_do_not_alter_the_verdict(dragged, clean):
    random = np.random.default_rng(4)
    data = diagnose([spiked(record, random) for record in dragged], VEHICLE).as_data()
    assert data['verdict'] == clean['verdict'] == ['rotor_drag']
    for name in SPIKES:
        assert data['gap']['after'][name] == pytest.approx(clean['gap']['after'][name], rel=0.2)
    told = {one['code'] for one in data['findings']}
    assert told >= {f'{name}_glitch' for name in SPIKES}
    assert not {f'{name}_glitch' for name in SPIKES} & {one['code'] for one in clean['findings']}


def test_single_attitudes_that_are_off_are_found_and_no_others(dragged):
    record, off = spoilt(dragged[0], np.random.default_rng(2))
    rates = record.stack('wx', 'wy', 'wz')
    large = np.zeros(len(record), bool)
    true = rotation_matrix(attitude_of(dragged[0]))
    wrong = rotation_matrix(attitude_of(record))
    large[:] = np.einsum('nij,nij->n', true, wrong) < 1.0 + 2.0 * np.cos(0.1)
    found = glitches(record.t, attitude_of(record), rates)
    assert found[large].all() and not found[~off].any()
    assert not glitches(dragged[0].t, attitude_of(dragged[0]), rates).any()
    [finding] = [one for one in findings(record, VEHICLE) if one.code == 'attitude_glitch']
    assert f'the attitude jumps off and back {int(found.sum())} times' in finding.message


@pytest.mark.parametrize('lost', [range(145, 150), range(151, 156), range(145, 150, 4)])
def test_an_attitude_that_is_off_beside_lost_rows_is_a_glitch_and_these_are_none(lost):
    random, t = np.random.default_rng(3), 0.01 * np.arange(300)
    turns = np.stack([0.3 * np.sin(2.0 * t), *np.zeros((2, 300))], axis=1)
    rates = np.stack([0.6 * np.cos(2.0 * t), *np.zeros((2, 300))], axis=1)
    q = product(turn(turns), turn(random.normal(0.0, 0.002, (300, 3))))
    kept = np.delete(np.arange(300), lost)
    assert not glitches(t[kept], q[kept], rates[kept]).any()
    q[150] = product(q[150], turn([0.0, 0.3, 0.0]))
    assert list(kept[glitches(t[kept], q[kept], rates[kept])]) == [150]


@pytest.mark.parametrize(('rate', 'name', 'size'), [
    (50.0, 'position', 0.2), (100.0, 'velocity', 2.0), (100.0, 'rate', 5.0),
    (500.0, 'rate', 10.0)])
def test_single_samples_that_are_off_are_found_and_steps_and_turns_are_none(rate, name, size):
    t = np.arange(0.0, 8.0, 1.0 / rate)
    noise = 0.005 * np.random.default_rng(5).normal(size=(len(t), 3))
    values = size * np.sin(2.0 * np.pi * np.outer(t, [0.5, 1.0, 2.0])) + noise
    assert not spikes(t, values, name).any()
    one = len(t) // 3
    values[one, 1] += size
    found = np.flatnonzero(spikes(t, values, name))
    # The median beside a jump is that of fewer samples.
    assert one in found and np.abs(t[found] - t[one]).max() < 0.04
    reset = noise + size * (t > 4.0)[:, None]
    assert not spikes(t, reset, name).any()


@pytest.mark.parametrize(('rate', 'speed'), [(50.0, 40.0), (100.0, 40.0), (100.0, 100.0),
                                             (250.0, 60.0), (1000.0, 40.0)])
def test_quick_turns_that_the_attitude_has_too_are_no_glitches_of_the_rate(rate, speed):
    """Steps of 0.3 rad, as a controller of the second order follows them, and damaged messages."""
    random = np.random.default_rng(0)
    t = np.arange(0.0, 20.0, 1.0 / rate)
    tilt, rates = np.zeros(len(t)), 0.01 * random.normal(size=(len(t), 3))
    for number, begin in enumerate(range(1, 19, 2)):
        after, size = np.maximum(t - begin, 0.0), 0.3 * (-1) ** number
        tilt += size * (1.0 - (1.0 + speed * after) * np.exp(-speed * after))
        rates[:, 0] += size * speed ** 2 * after * np.exp(-speed * after)
    half = 0.5 * (tilt + 2e-3 * random.normal(size=len(t)))
    q = np.stack([np.cos(half), np.sin(half), 0.0 * t, 0.0 * t], axis=1)
    assert spikes(t, rates, 'rate').any()       # the rates alone do not tell
    assert not spikes(t, rates + [0.02, 0.0, -0.02], 'rate', q).any()
    one = len(t) // 2 + round(0.4 * rate)
    rates[one] += 3.0, -3.0, 1.5
    assert list(np.flatnonzero(spikes(t, rates, 'rate', q))) == [one]
    record = FlightRecord(t, {**dict(zip(('qw', 'qx', 'qy', 'qz'), q.T, strict=True)),
                              **dict(zip(('wx', 'wy', 'wz'), rates.T, strict=True))})
    [found] = others(record, None)
    assert found.code == 'rate_glitch' and 'once' in found.message


def test_an_attitude_that_turns_and_stays_is_no_glitch():
    t = 0.01 * np.arange(300)
    q = np.tile([1.0, 0.0, 0.0, 0.0], (300, 1))
    q[150:] = turn([0.0, 0.0, 0.4])
    assert not glitches(t, q, np.zeros((300, 3))).any()


def test_lost_rows_hardly_move_the_estimate(dragged):
    random = np.random.default_rng(4)
    flights = []
    for record in dragged:
        kept = np.ones(len(record), bool)
        while kept.mean() > 0.95:
            k = int(random.integers(1, len(record) - 1))
            kept[k:k + int(random.geometric(0.4))] = False
        flights.append(FlightRecord(record.t[kept], {name: values[kept] for name, values in
                                                     record.columns.items()}, record.info))
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == ['rotor_drag']
    value, std = parameters(data, 'rotor_drag')['coefficient']
    assert abs(value - DRAG['rotor_drag']['coefficient']) < 4 * std


def test_rows_that_were_lost_count_for_nothing(dragged):
    record = dragged[0]
    kept = np.ones(len(record), bool)
    kept[[400, 401, 700]] = False
    short = FlightRecord(record.t[kept], {name: values[kept] for name, values in
                                          record.columns.items()}, record.info)
    flight, whole = (flight_of(track_of(one, VEHICLE)) for one in (short, record))
    np.testing.assert_allclose(flight.course.t, whole.course.t, atol=1e-12)
    np.testing.assert_array_equal(np.flatnonzero(~flight.seen.all(axis=1)), [400, 401, 700])
    np.testing.assert_allclose(flight.states[kept], whole.states[kept], atol=1e-12)
    assert flight.seen[flight.first].all()


@pytest.mark.parametrize('name', VEHICLES)
def test_a_negative_delay_undoes_a_positive_one(name):
    count = len(VEHICLES[name].rotors)
    t = 0.01 * np.arange(100)
    commands = 100.0 + np.cumsum(np.random.default_rng(0).normal(size=(100, count)), axis=0)
    late, *_ = acted(t, commands, 0.03)
    back, *_ = acted(t, late, -0.03)
    np.testing.assert_allclose(back[:97], commands[:97], rtol=1e-9)
    # What the delay has pushed out of the record is gone: the last that is left is held.
    np.testing.assert_allclose(back[96:], np.tile(commands[96], (4, 1)), rtol=1e-9)


def test_thrust_and_wind_by_flight_are_asked_of_several_flights_alone(dragged):
    tracks = [track_of(record, VEHICLE) for record in dragged]
    names = [{kind.name for kind in nuisances(VEHICLE, tracks[:count])} for count in (1, 2)]
    assert names[1] - names[0] == {'thrust_scale_by_flight', 'wind_by_flight'}


def test_gusts_are_asked_of_flights_only_where_they_are_looked_for(dragged):
    tracks = [track_of(record, VEHICLE) for record in dragged]
    names = [{kind.name for kind in nuisances(VEHICLE, tracks, gusty)} for gusty in (False, True)]
    assert names[1] - names[0] == {'gusts'}


def test_a_battery_that_was_fuller_in_one_flight_is_no_effect():
    truths = [{**DRAG, 'thrust_scale': {'factor': factor}} for factor in (1.02, 0.98, 1.0)]
    flights = [fly_closed_loop(VEHICLE, truth, 'lissajous', duration=12.0, seed=seed,
                               noise=SENSORS['mocap_imu']) for seed, truth in enumerate(truths)]
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == ['rotor_drag']
    thrust = data['nuisances']['thrust_scale_by_flight']
    assert np.ravel([*thrust['values'], thrust['held_out']]) == pytest.approx(
        [0.02, -0.02, 0.0], abs=0.004)
