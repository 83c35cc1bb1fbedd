# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What commands answer shows the clocks of states and commands, whatever the vehicle does."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.data.aligned import STREAMS
from quad_ident_ros.data.clocks import clocks_of, controllers_own, on_one_clock
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.quality.answer import Answer, answer_of
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import CLEAN, Noise, SENSORS, Sensors
from quad_ident_ros.greybox.fit import fit
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
NOISE = Sensors(white=Noise(position=5e-4, velocity=0.01, attitude=2e-3, rate=0.01))
DELAY = {'actuation_delay': {'delay': 0.017}}
LATE = (0.021, -0.014, 0.012)   # s that the states of flights are stamped late


def flown(seed=0, truth=None, noise=NOISE, rate=100.0, duration=12.0, course='lissajous'):
    return fly_closed_loop(VEHICLE, truth or {}, course, duration=duration, seed=seed, rate=rate,
                           noise=noise)


def stamped(record, late, drift=0.0, streams=('pose', 'velocity', 'rate')):
    """Return a record whose states are stamped late by so many s in the middle, and s/s."""
    at = record.t - late - drift * (record.t - record.t.mean())
    there = (at >= record.t[0]) & (at <= record.t[-1])
    columns = dict(record.columns)
    for name in (name for stream in streams for name in STREAMS[stream] if record.has(name)):
        columns[name] = np.interp(at, record.t, columns[name])
    return replace(record, t=record.t[there],
                   columns={name: values[there] for name, values in columns.items()})


def without(record, share):
    """Return a record without rows, lost in bursts."""
    random, kept = np.random.default_rng(1), np.ones(len(record), bool)
    while kept.mean() > 1.0 - share:
        k = int(random.integers(1, len(record) - 1))
        kept[k:k + int(random.geometric(0.4))] = False
    return replace(record, t=record.t[kept],
                   columns={name: values[kept] for name, values in record.columns.items()})


@pytest.mark.slow
@pytest.mark.parametrize('rate', [50.0, 100.0, 200.0, 500.0])
@pytest.mark.parametrize('late', [-0.0237, 0.0, 0.0161])
def test_the_clock_is_told_within_a_tenth_of_a_sample(rate, late):
    found = answer_of(stamped(flown(rate=rate), late))
    assert found.lag == pytest.approx(-late, abs=0.1 / rate)
    assert found.std < 0.05 / rate


@pytest.mark.parametrize('truth', [DELAY, {'motor_lag': {'time_constant': 0.04}},
                                   {'inertia_mismatch': {'factor_x': 1.3, 'factor_y': 1.3}}],
                         ids=lambda one: next(iter(one)))
def test_what_the_vehicle_does_with_its_commands_does_not_matter(truth):
    assert answer_of(flown(truth=truth)).lag == pytest.approx(0.0, abs=5e-4)


def test_lost_rows_do_not_matter():
    found = answer_of(without(stamped(flown(), 0.0161), 0.08))
    assert found.lag == pytest.approx(-0.0161, abs=1e-3)


@pytest.mark.slow
def test_a_clock_that_drifts_is_told_so():
    found = answer_of(stamped(flown(duration=30.0), 0.013, drift=1e-4))
    assert found.lag == pytest.approx(-0.013, abs=1e-3)
    assert found.drift == pytest.approx(-1e-4, abs=2e-5)
    assert answer_of(flown(duration=30.0)).drift == 0.0


def test_where_no_controller_sees_the_noise_there_is_no_answer():
    record = flown(noise=CLEAN)
    assert answer_of(record) is None    # motion alone is alike at many lags
    random = np.random.default_rng(0)
    names = [name for names in STREAMS.values() for name in names if record.has(name)]
    noisy = {name: record.columns[name] + 0.01 * random.normal(size=len(record)) for name in names}
    assert answer_of(replace(record, columns=record.columns | noisy)) is None


def test_without_commands_or_in_a_short_record_there_is_no_answer():
    record = flown()
    states = {name: values for name, values in record.columns.items() if name[:3] != 'cmd'}
    assert answer_of(replace(record, columns=states)) is None
    assert answer_of(record.slice(0, 150)) is None


def of(*lags, share=0.9, period=0.01):
    return [None if lag is None else Answer(lag, 2e-4, 0.0, share, period) for lag in lags]


@pytest.mark.parametrize(('lags', 'late'), [
    ((0.0, 0.0, 0.0), (0, 0, 0)),
    ((0.004, 0.004, 0.0042), (0, 0, 0)),            # the controller's own
    ((0.015, 0.0152, 0.015), (0, 0, 0)),
    ((0.004, 0.004, 0.024), (0, 0, -0.02)),         # one flight has another clock
    ((0.01, 0.01, None, -0.01), (0, 0, None, 0.02)),
    ((0.025, 0.0255, 0.015), (-0.025, -0.0255, -0.015)),    # two are alike by chance
    ((0.02, -0.015, 0.012), (-0.02, 0.015, -0.012)),
    ((-0.02, -0.02, -0.02), (0.02, 0.02, 0.02)),    # nobody answers beforehand
    ((None, None, 0.004), (None, None, 0)), ((None, None), (None, None))])
def test_a_lag_that_flights_share_is_the_controllers_own(lags, late):
    clocks = clocks_of(of(*lags))
    assert [clock and clock.late for clock in clocks] == [
        one if one is None else pytest.approx(one, abs=2e-4) for one in late]


@pytest.mark.parametrize(('lag', 'error', 'own'), [
    (0.004, 1e-4, True), (0.0093, 1e-4, True), (0.0075, 2e-4, False), (0.0075, 0.002, True),
    (0.017, 1e-3, False), (0.0002, 1e-4, True)])
def test_controllers_answer_soon_or_a_row_later(lag, error, own):
    assert controllers_own(lag, error, period=0.01) is own


def test_faint_answers_count_beside_a_clear_one_only():
    clear, [faint] = of(0.0, -0.02), of(-0.015, share=0.55)
    assert clocks_of([*clear, faint])[2].late == pytest.approx(0.015)
    assert clocks_of([faint]) == [None]


def test_the_flight_held_out_has_no_part_in_the_clocks_of_the_others():
    first, second, held_out = of(0.004, 0.004, 0.03)
    assert [one.late for one in clocks_of([first, second], [held_out])] == [
        0.0, 0.0, pytest.approx(-0.026)]
    assert clocks_of([None, None], [held_out]) == [None, None, None]
    assert clocks_of([None, None], [None]) == [None, None, None]


@pytest.mark.slow
def test_streams_that_were_moved_leave_open_which_of_them_is_answered():
    record = stamped(flown(), 0.02, streams=('pose', 'velocity'))
    [(moved, late, answer)] = on_one_clock([record])
    assert late.keys() == {'pose', 'velocity'} and answer is None
    assert len(moved) < len(record)


@pytest.mark.slow
def test_a_delay_is_told_beside_clocks_that_differ():
    flights = [stamped(flown(seed, DELAY), late) for seed, late in enumerate(LATE)]
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == ['actuation_delay']
    [row] = [row for row in data['ranking'] if row['effect'] == 'actuation_delay']
    delay = row['parameters']['delay']
    assert abs(delay['value'] - 0.017) < 3 * delay['std'] < 0.006
    clocks = data['nuisances']['clock_offset']
    assert np.ravel([*clocks['values'], clocks['held_out']]) == pytest.approx(LATE, abs=0.003)
    assert clocks['hidden_delay'] is None


@pytest.mark.slow
def test_clocks_that_are_alike_in_all_flights_are_no_delay():
    flights = [stamped(flown(seed), 0.02) for seed in range(3)]
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == ['none']
    assert data['nuisances']['clock_offset']['held_out'] == pytest.approx([0.02], abs=0.003)
    [finding] = [one for one in findings(flights[0], VEHICLE) if one.code == 'clock_offset']
    assert 'before these are stamped' in finding.message
    assert not [one for one in findings(flown(), VEHICLE) if one.code == 'clock_offset']


def answering_late(seed):
    """Return a flight whose commands come and act 0.01 s after what they answer."""
    record = flown(seed, {'actuation_delay': {'delay': 0.01}})
    columns = {name: values[:-1] if name[:3] == 'cmd' else values[1:]
               for name, values in record.columns.items()}
    return replace(record, t=record.t[1:], columns=columns)


@pytest.mark.slow
def test_a_lag_of_the_controller_is_no_delay_whatever_the_clocks():
    """With clocks that differ, no record distinguishes it from commands that act as much later."""
    one_clock = [answering_late(seed) for seed in range(3)]
    assert answer_of(one_clock[0]).lag == pytest.approx(0.01, abs=1e-3)
    data = diagnose(one_clock, VEHICLE).as_data()
    assert data['verdict'] == ['none'] and data['nuisances'] is None
    late = (0.0, 0.021, -0.014)
    data = diagnose([stamped(record, one) for record, one in zip(one_clock, late, strict=True)],
                    VEHICLE).as_data()
    assert data['verdict'] == ['none']
    clocks = data['nuisances']['clock_offset']
    assert np.ravel([*clocks['values'], clocks['held_out']]) == pytest.approx(late, abs=0.003)
    assert clocks['hidden_delay'] == pytest.approx(0.01, abs=0.003)


@pytest.mark.slow
def test_clocks_that_drift_are_put_right():
    flights = [stamped(flown(seed, duration=30.0), 0.012, drift=8e-4) for seed in range(3)]
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == ['none']
    assert data['gap']['after']['rate'] < 1.1 * data['gap']['noise']['rate']


@pytest.mark.slow
def test_a_fit_puts_the_clocks_right_too():
    found = fit([stamped(flown(1, DELAY), 0.02)], VEHICLE, ['actuation_delay'])
    [delay] = found.parameters
    assert delay.value == pytest.approx(0.017, abs=0.002)


@pytest.mark.slow
@pytest.mark.parametrize('vehicle', ['hummingbird', 'iris', 'crazyflie', 'paper_quadrotor'])
@pytest.mark.parametrize('noise', ['clean', 'mocap_imu'])
def test_a_clean_flight_has_no_cautions(vehicle, noise):
    """In hover without noise the rounding was taken for it: commands 13 ms too early."""
    nominal = load_vehicle(vehicle)
    for trajectory in ('hover', 'figure8'):
        record = fly_closed_loop(nominal, {}, trajectory, duration=20.0, seed=1008,
                                 noise=SENSORS[noise])
        assert [one for one in findings(record, nominal) if one.severity != 'info'] == []
