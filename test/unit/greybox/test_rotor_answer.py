# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What measured rotor speeds beside commands say of lag, delay and sag."""

from dataclasses import replace

from effect_flights import acted
from flightmaker import flight
import numpy as np
import pytest

from quad_ident_ros.data.commands import with_commands
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.greybox.rotor_answer import rotor_answer, RotorAnswer, ruled_out_by
from quad_ident_ros.model.vehicle import load_vehicle

FLIGHT = flight(seconds=20.0, noise=0.0)
CMD = ('cmd1', 'cmd2', 'cmd3', 'cmd4')
NOISE = 5.0     # rad/s


def measured(delay=0.0, lag=0.0, noise=NOISE, gain=1.0, per_volt=0.0, **columns):
    """Return FLIGHT with speeds that follow restless commands so late, as a sensor has them."""
    random = np.random.default_rng(0)
    held = np.repeat(random.normal(0.0, 40.0, (len(FLIGHT) // 5 + 1, 4)), 5, axis=0)
    commands = np.ascontiguousarray(FLIGHT.stack(*CMD) + held[:len(FLIGHT)])
    t = FLIGHT.t - FLIGHT.t[0]
    volts = 12.0 - 0.05 * t
    speeds = gain * acted(t, commands, delay, lag)[1] * (1 + per_volt * (volts - 11.5))[:, None]
    speeds = speeds + noise * random.standard_normal(speeds.shape)
    columns = {**FLIGHT.columns, 'vbat': volts, **columns}
    for prefix, values in (('cmd', commands), ('rotor', speeds)):
        columns |= {f'{prefix}{k}': column for k, column in enumerate(values.T, 1)}
    return FlightRecord(FLIGHT.t, columns)


@pytest.mark.parametrize(('truth', 'without'), [
    ((0.0, 0.03), ['actuation_delay']), ((0.021, 0.0), ['motor_lag']), ((0.012, 0.045), []),
    # Where speeds step at once, a delay of less than a sample does not show.
    ((0.0, 0.0), ['motor_lag'])], ids=str)
def test_delay_and_lag_are_told_apart_with_their_errors(truth, without):
    answer = rotor_answer(measured(*truth))
    for (value, error), true in zip((answer.delay, answer.lag), truth, strict=True):
        assert error < 5e-3 and abs(value - true) < 4 * error + 1e-4
    assert set(ruled_out_by([answer], RULES.shown)) == set(without)


def test_a_map_that_is_off_and_a_sag_of_speed_are_told_beside():
    answer = rotor_answer(measured(0.0, 0.03, gain=0.93, per_volt=0.04))
    assert answer.gain[0] == pytest.approx(0.93, abs=5e-3)
    assert abs(answer.per_volt[0] - 0.04) < 4 * answer.per_volt[1] + 2e-3
    assert answer.lag[0] == pytest.approx(0.03, abs=1e-3)
    assert 'with a lag of 30' in answer.said() and '% per volt' in answer.said()


def test_a_gap_between_parts_of_a_recording_takes_no_part():
    """Parts of 8 and 10 s that lie 52 s apart: the second alone has what is reported of both."""
    record = measured(0.0, 0.03, per_volt=0.04)
    first, second = record.t - record.t[0] < 8.0, record.t - record.t[0] >= 10.0
    t = np.concatenate([record.t[first], record.t[second] + 50.0])
    parts = FlightRecord(t, {name: np.concatenate([values[first], values[second]])
                             for name, values in record.columns.items()})
    alone = FlightRecord(record.t[second], {name: values[second] for name, values in
                                            record.columns.items()})
    answer, expected = rotor_answer(parts), rotor_answer(alone)
    assert answer.lag[0] == pytest.approx(0.03, abs=1e-3)
    for name in ('delay', 'lag', 'gain', 'per_volt'):
        np.testing.assert_allclose(getattr(answer, name), getattr(expected, name), atol=1e-6)
    # Rows that are lost here and there are no gap.
    lost = np.arange(len(record)) % 50 != 7
    few = rotor_answer(FlightRecord(record.t[lost], {name: values[lost] for name, values in
                                                     record.columns.items()}))
    assert few.lag[0] == pytest.approx(0.03, abs=1e-3)


def test_what_is_no_measurement_tells_nothing():
    record = measured(0.0, 0.03)
    assert rotor_answer(measured(noise=0.0)) is None        # a copy of the commands
    bare = {name: values for name, values in record.columns.items()
            if not name.startswith('rotor')}
    assert rotor_answer(replace(record, columns=bare)) is None
    other = {f'rotor{k}': np.random.default_rng(k).normal(900.0, 40.0, len(FLIGHT))
             for k in range(1, 5)}
    answer = rotor_answer(replace(record, columns={**record.columns, **other}))
    assert answer.explained < RULES.follows
    # Ten measurements a second, interpolated, do not show a lag.
    slow = {f'rotor{k}': np.interp(FLIGHT.t, FLIGHT.t[::10], record.columns[f'rotor{k}'][::10])
            for k in range(1, 5)}
    assert rotor_answer(replace(record, columns={**record.columns, **slow})) is None


def test_effects_are_ruled_out_by_all_flights_together():
    sure = RotorAnswer((0.0, 1e-4), (0.03, 1e-4), (1.0, 0.0), None, 0.99)
    vague = replace(sure, delay=(0.001, 0.01))
    against = replace(sure, delay=(0.02, 1e-3))
    for nothing in ([], [None], [vague], [sure, against]):
        assert ruled_out_by(nothing, RULES.shown) == ()
    assert ruled_out_by([sure, vague, None], RULES.shown) == ('actuation_delay',)


def test_measured_speeds_take_the_place_of_commands_that_are_missing():
    vehicle, t = load_vehicle('iris'), np.linspace(0.0, 1.0, 101)
    speeds = {f'rotor{j}': 500.0 + 100.0 * t * j for j in range(1, 5)}
    made = with_commands(FlightRecord(t, speeds), vehicle)
    for j in range(1, 5):   # on a line the mean over a step is that in its middle
        middle = 500.0 + 100.0 * (t[:-1] + 0.005) * j
        np.testing.assert_allclose(made.columns[f'cmd{j}'][:-1], middle)
    assert not made.has('rotor1')
    beside = FlightRecord(t, speeds | {f'cmd{j}': 0.0 * t for j in range(1, 5)})
    assert with_commands(beside, vehicle) is beside


@pytest.mark.slow
def test_a_lag_before_speeds_that_were_measured_plays_no_part():
    vehicle = load_vehicle('iris')
    truth = {'rotor_drag': {'coefficient': 0.4}, 'motor_lag': {'time_constant': 0.05}}
    flights = [fly_closed_loop(vehicle, truth, path, duration=20.0, rate=200.0, seed=seed,
                               noise=MOCAP_IMU)
               for seed, path in enumerate(('figure8', 'lissajous', 'low_passes'))]
    told = diagnose([FlightRecord(one.t, {name: values for name, values in one.columns.items()
                                          if not name.startswith('cmd')}, one.info)
                     for one in flights], vehicle)
    assert told.verdict == ('rotor_drag',)
    value = told.ranking[0].parameters['coefficient']
    assert abs(value.value - 0.4) < 4.0 * value.std
    assert any(finding['code'] == 'rotor_speeds' for finding in told.findings)
