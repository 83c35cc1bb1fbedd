# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""States that a low pass of the gyro makes late are no lag of the motors."""

from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose import nuisances
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import Noise, Sensors
from quad_ident_ros.greybox.nuisances import APART, CLOCK, CLOCK_TITLE, Nuisance
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.vehicle import load_vehicle

SENSORS = {
    'filter': Sensors(white=Noise(position=1e-3, velocity=1e-2, attitude=2e-4, rate=1e-2)),
    'tracked': Sensors(white=Noise(position=1e-3, velocity=1e-2, attitude=2e-3, rate=1e-2)),
    'simulated': Sensors(white=Noise(position=1e-4, velocity=1e-3, attitude=1e-5, rate=1e-5))}


def diagnosed(effects, sensors):
    """Return the diagnosis of flights whose states are of a kind of sensors."""
    vehicle = load_vehicle('hummingbird')
    return diagnose([fly_closed_loop(vehicle, effects, course, duration=10.0, seed=seed,
                                     noise=SENSORS[sensors])
                     for seed, course in enumerate(('lissajous', 'figure8'))],
                    vehicle)


@pytest.mark.slow
@pytest.mark.parametrize('effects', [{'actuation_delay': {'delay': 0.0035}},
                                     {'motor_lag': {'time_constant': 0.003}}], ids=str)
def test_what_a_low_pass_may_be_is_told_as_a_clock_where_a_filter_has_the_attitude(effects):
    """A rate that is 3 ms late, and an attitude that follows it, look like such a delay."""
    [[value]] = [one.values() for one in effects.values()]
    found = diagnosed(effects, 'filter')
    assert found.verdict == ('none',)
    assert found.nuisances['clock_offset']['values'][0][0] == pytest.approx(value, abs=1e-3)
    assert found.nuisances['clock_offset']['hidden_delay'] == pytest.approx(value, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize('sensors', ['tracked', 'simulated'])
def test_a_short_delay_is_named_where_the_attitude_follows_no_gyro(sensors):
    [name] = diagnosed({'actuation_delay': {'delay': 0.005}}, sensors).verdict
    assert name in ('actuation_delay', 'motor_lag')


@pytest.mark.slow
def test_a_lag_that_is_longer_than_a_low_pass_is_named():
    found = diagnosed({'motor_lag': {'time_constant': 0.02}}, 'filter')
    assert found.verdict == ('motor_lag',)


DELAY, LAG, SLEW = 'actuation_delay.delay', 'motor_lag.time_constant', 'motor_lag.slew'


@pytest.mark.parametrize(('values', 'errors', 'correlation', 'late'), [
    ({DELAY: 0.003}, [0.0005], 0.0, 0.003),
    ({DELAY: 0.002, LAG: 0.003}, [0.003, 0.003], -0.95, 0.005),
    ({DELAY: 0.006, LAG: 0.006}, [0.003, 0.003], -0.95, 0.0),   # their sum is sure: 12 ms
    ({DELAY: 0.012, LAG: 0.0}, [0.004, 1e-6], 0.0, 0.006),      # no more than a low pass
    ({DELAY: 0.020, LAG: -0.016}, [0.001, 0.001], 0.0, 0.0),    # less lag than the file has
    ({DELAY: 0.003, SLEW: 1e-4}, [0.001, 1e-5], 0.0, 0.0)])     # a slew has no time of its own
def test_delays_and_lags_together_are_held_against_the_low_pass(values, errors, correlation, late,
                                                                monkeypatch):
    monkeypatch.setattr(nuisances, 'follows_gyro', lambda *_: True)
    vehicle = load_vehicle('hummingbird')
    z, columns = nominal(vehicle).copy(), [INDEX[name] for name in values]
    z[columns] += list(values.values())
    covariance = np.diag(np.square(errors))
    if len(errors) == 2:
        covariance[0, 1] = covariance[1, 0] = correlation * errors[0] * errors[1]
    causes = [SimpleNamespace(effect=name.partition('.')[0], columns=(INDEX[name],))
              for name in values]
    selection = SimpleNamespace(covariance_by_noise=covariance, best=SimpleNamespace(
        estimate=SimpleNamespace(z=z, columns=columns), causes=causes))
    assert nuisances.late_gyro(selection, [], vehicle, RULES) == pytest.approx(late, abs=1e-12)


def test_the_delay_that_clocks_may_hide_counts_from_where_the_commands_were_moved_to():
    column = INDEX[DELAY]
    kind = Nuisance(CLOCK, CLOCK_TITLE, 's', (column,), (APART,), 1e-4)
    flights = np.zeros((5, len(nominal(load_vehicle('hummingbird')))))
    flights[:, column] = -0.01, 0.01, -0.01, 0.01, 0.0
    still, moved = (nuisances.as_data([kind], list(flights), [{}] * 5, [None] * 5, prompt)[CLOCK]
                    for prompt in (0.0, 0.005))
    assert moved['hidden_delay'] == pytest.approx(still['hidden_delay'] + 0.005)
    assert np.subtract(moved['values'], still['values']) == pytest.approx(0.005)
