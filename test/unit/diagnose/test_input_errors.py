# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors of commands make a vehicle seem to answer less: the range that holds what is true."""

from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose.advice import by_input_errors
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.input_errors import gains, ranges
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.errors import ERRORS
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
    [one] = by_input_errors(judged)
    assert one['where'] in EFFECTS and 'factor_x 0.6 to 4.1' in one['message']
    assert 'is not named' in one['message'] and 'factor_y' not in one['message']
    judged.stand_ins = ()
    assert 'is not named' not in by_input_errors(judged)[0]['message']
