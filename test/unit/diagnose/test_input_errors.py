# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of commands make a vehicle seem to answer less: the range that holds what is true."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.advice import by_input_errors
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.input_errors import answers, by_instruments, gains, ranges
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.errors import ERRORS
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.greybox.linear import errors_along
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
ROLL = {'inertia_mismatch.factor_x': -1, 'inertia_mismatch.arms_y': 1}
NOISE = 0.1


def fitted(name, errors, seed=3):
    """
    Return the fit of a rate that answers commands exactly, where these are recorded with errors.

    The rate is the true command; errors: their variance beside that of the command. What a least
    squares fit has for the gain is 1 / (1 + errors).
    """
    rng = np.random.default_rng(seed)
    true = rng.normal(size=(400, 51))
    recorded = true + np.sqrt(errors) * rng.normal(size=true.shape)
    measured = true + NOISE * rng.normal(size=true.shape)
    gain = np.sum(recorded * measured) / np.sum(recorded ** 2)
    z = nominal(VEHICLE)
    z[INDEX[name]] = gain ** ROLL[name]
    residual, slope = (np.zeros((*true.shape, ERRORS)) for _ in range(2))
    residual[..., 9] = measured - gain * recorded
    # d(gain recorded) / d parameter, with gain = parameter^power.
    slope[..., 9] = ROLL[name] * gain * recorded / z[INDEX[name]]
    table = np.zeros((len(true), ERRORS + 2, slope[0].size))
    table[:, ERRORS] = slope.reshape(len(true), -1)
    slopes = SimpleNamespace(columns=[INDEX[name]], tangents=[SimpleNamespace(table=table)])
    return SimpleNamespace(z=z, columns=[INDEX[name]], residuals=[residual]), slopes


@pytest.mark.parametrize('name', ROLL)
@pytest.mark.parametrize('errors', [0.1, 1.0, 4.0])
def test_where_the_commands_alone_have_errors_the_reverse_regression_is_the_truth(name, errors):
    fit, slopes = fitted(name, errors)
    deviation = np.zeros(ERRORS)
    deviation[9] = NOISE
    [(column, (least, most))] = ranges(fit, slopes, SimpleNamespace(deviation=deviation)).items()
    assert column == INDEX[name]
    ends = (least, most) if ROLL[name] < 0 else (most, least)
    assert ends[0] == pytest.approx(1.0, rel=0.05)
    assert ends[1] == fit.z[column] == pytest.approx((1.0 + errors) ** -ROLL[name], rel=0.1)


@pytest.mark.parametrize('name', ROLL)
def test_commands_without_errors_leave_no_range(name):
    fit, slopes = fitted(name, 0.0)
    deviation = np.zeros(ERRORS)
    deviation[9] = NOISE
    [(least, most)] = ranges(fit, slopes, SimpleNamespace(deviation=deviation)).values()
    assert most - least < 0.001


def test_what_an_answer_grows_with_is_known_by_its_direction():
    columns = [INDEX[name] for name in (*ROLL, 'wind.x', 'motor_lag.time_constant')]
    assert {column: one.gain for column, one in gains(columns).items()} == {
        INDEX[name]: power for name, power in ROLL.items()}


def test_what_errors_may_have_made_is_said_with_its_range():
    columns = tuple(INDEX[f'inertia_mismatch.factor_{axis}'] for axis in 'xyz')
    cause = Candidate('inertia_mismatch', 'factors', columns)
    judged = SimpleNamespace(model=SimpleNamespace(effects=(cause,)), stand_ins=(cause,),
                             by_commands={columns[0]: (0.6, 4.1)})
    [one] = by_input_errors(judged, False)
    assert one['where'] in EFFECTS and 'factor_x 0.6 to 4.1' in one['message']
    assert 'is not named' in one['message'] and 'factor_y' not in one['message']
    judged.stand_ins = ()
    assert 'is not named' not in by_input_errors(judged, False)[0]['message']


def answered(error=0.0, gain=1.0, late=0.0, noise=0.0, seed=5):
    """
    Return what a model answers to commands, and what it leaves, by rollout and sample, (B, N, 3).

    The vehicle answers commands that hang together over some samples, so many times as much as
    the model, with a share of it a sample late; those that the log has differ by independent
    errors, and follow the noise of the rates, which the controller acts against.
    """
    rng = np.random.default_rng(seed)
    true = rng.normal(size=(300, 27, 3))
    true = true[:, 2:] + 0.8 * true[:, 1:-1] + 0.6 * true[:, :-2]
    measured = noise * rng.normal(size=(300, 26, 3))
    true = true - measured[:, :-1]
    logged = true + error * rng.normal(size=true.shape)
    vehicle = gain * ((1.0 - late) * true + late * np.roll(true, 1, axis=1))
    return logged, vehicle + np.diff(measured, axis=1) - logged


@pytest.mark.parametrize('gain', [0.8, 1.0, 1.3])
@pytest.mark.parametrize('error', [0.5, 1.0, 2.0])
def test_commands_of_before_tell_the_answer_whatever_the_errors(gain, error):
    told = by_instruments([answered(error, gain)])
    assert told.lateness > 5.0
    assert (np.abs(told.gain - gain) < 3.0 * told.error).all()
    # A regression on the commands themselves would have another answer by far.
    assert (np.abs(gain / (1.0 + error ** 2 / 2.0) - gain) > 3.0 * told.error).any()


@pytest.mark.parametrize('gain', [0.8, 1.0, 1.3])
def test_without_errors_the_answer_is_told_as_well_and_no_errors_are_seen(gain):
    told = by_instruments([answered(gain=gain, noise=0.01)])
    assert abs(told.lateness) < 3.0
    assert told.gain == pytest.approx([gain] * 3, abs=0.03)


def test_noise_that_commands_answer_is_none_of_their_errors():
    assert by_instruments([answered(noise=0.5)]).lateness < -3.0


def test_an_answer_that_comes_later_shows_as_errors_do():
    assert by_instruments([answered(late=0.3)]).lateness > 3.0


def by_chance(rollouts, draws=1000):
    """Return how often commands without errors seem to have some, of so many rollouts."""
    rng, found = np.random.default_rng(7), 0
    for _ in range(draws):
        answer = rng.normal(size=(rollouts, 28, 3))
        answer = answer[:, 2:] + 0.8 * answer[:, 1:-1] + 0.6 * answer[:, :-2]
        told = by_instruments([(answer, rng.normal(size=answer.shape))])
        found += told.lateness >= Rules().shown
    return found / draws


def test_from_as_many_rollouts_as_are_asked_for_chance_rarely_shows_errors():
    assert by_chance(Rules().told_by) < 0.01 < by_chance(3)


def test_a_complete_log_of_one_flight_leaves_what_others_lack_to_be_seen():
    complete, lacking = answered(noise=0.01), answered(1.0, seed=6)
    short = tuple(each[:, :10] for each in complete)
    assert by_instruments([short, lacking, lacking]).lateness > 5.0


def thinned(record, every):
    """Return a record of which one in so many rows is logged."""
    return FlightRecord(record.t[::every], {name: values[::every] for name, values
                                            in record.columns.items()}, record.info)


@pytest.mark.parametrize('factor', [0.8, 1.0, 1.25])
def test_the_answer_of_another_inertia_is_told(factor):
    truth = {'inertia_mismatch': dict.fromkeys(('factor_x', 'factor_y', 'factor_z'), factor)}
    flights = [flight_of(track_of(fly_closed_loop(VEHICLE, truth, course, duration=20.0,
                                                  seed=seed), VEHICLE))
               for seed, course in enumerate(('lissajous', 'steps'))]
    z = nominal(VEHICLE)
    starts = [flight.states[flight.first] for flight in flights]
    fit = SimpleNamespace(vectors=[z, z], starts=starts, residuals=[
        errors_along(flight, VEHICLE, z, start)
        for flight, start in zip(flights, starts, strict=True)])
    told = answers(fit, flights, VEHICLE, Rules())
    assert told.gain == pytest.approx([1.0 / factor] * 3, abs=0.05)
    more = sum(len(flight.first) for flight in flights) + 1
    assert answers(fit, flights, VEHICLE, replace(Rules(), told_by=more)) is None


@pytest.mark.slow
@pytest.mark.parametrize('every', [1, 5])
def test_an_inertia_is_named_in_a_log_that_lacks_commands_as_well(every):
    truth = {'inertia_mismatch': {'factor_x': 1.5, 'factor_y': 1.5, 'factor_z': 1.2}}
    found = diagnose([thinned(fly_closed_loop(VEHICLE, truth, 'lissajous', duration=20.0,
                                              seed=seed, noise=SENSORS['mocap_imu']), every)
                      for seed in (1, 2, 3)], VEHICLE)
    assert 'inertia_mismatch' in found.verdict


@pytest.mark.slow
def test_a_log_that_is_slower_than_the_controller_says_so_and_blames_no_effect():
    seeds = (1, 2, 3)
    flights = [fly_closed_loop(VEHICLE, {}, 'lissajous', duration=20.0, rate=100.0, seed=seed,
                               noise=SENSORS['mocap_imu']) for seed in seeds]
    coarse = [thinned(record, 5) for record in flights]
    for records, seen in ((flights, False), (coarse, True)):
        found = diagnose(records, VEHICLE)
        assert found.verdict == ('none',)
        assert any(one['code'] == 'input_errors' for one in found.findings) == seen
