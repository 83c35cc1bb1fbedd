# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A function of state and command is learnt where there is one, and from nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.diagnose.residual_fit import residual_fit, Windows
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.model.residual_function import INPUTS

COUNT, NOISE = 900, 0.02
AIR_X, AIR_Y, THRUST = (INPUTS.index(name) for name in ('air_x', 'air_y', 'thrust'))


def force(x):
    """Return a force along x and a moment about z, (N, 6), that no one input gives alone."""
    made = np.zeros((len(x), 6))
    made[:, 0] = -0.2 * x[:, AIR_X] * np.abs(x[:, AIR_X]) + 0.1 * x[:, AIR_Y] * x[:, THRUST]
    made[:, 5] = 0.01 * np.sin(2.0 * x[:, AIR_X])
    return made


def windows(seed, made=force, folds=3):
    """Return Windows of as many flights, 40 windows in a block, with noise in all channels."""
    random = np.random.default_rng(seed)
    x = random.uniform(-1.0, 1.0, (COUNT, len(INPUTS)))
    y = made(x) + NOISE * random.normal(size=(COUNT, 6)) * [1, 1, 1, 0.05, 0.05, 0.05]
    return Windows(x, y, np.arange(COUNT) * folds // COUNT, np.arange(COUNT) // 40)


def value(function, x):
    """Return what a ResidualFunction says of inputs (N, 22), by its definition, (N, 6)."""
    scaled = np.stack([np.clip((2.0 * x[:, INPUTS.index(name)] - one.low - one.high)
                               / (one.high - one.low), -1.0, 1.0)
                       for name, one in function.inputs], axis=1)
    total = np.array(function.constant) + scaled @ [one.weights for _, one in function.inputs]
    for wave in function.waves:
        angle = scaled[:, list(wave.inputs)] @ wave.frequencies + wave.phase
        total += np.cos(angle)[:, None] * wave.weights
    return np.clip(total, -np.array(function.limit), function.limit)


def test_a_smooth_function_is_learnt_where_it_is_one():
    function = residual_fit(windows(1), RULES)
    unseen = np.random.default_rng(2).uniform(-0.95, 0.95, (500, len(INPUTS)))
    truth, found = force(unseen), value(function, unseen)
    for channel in (0, 5):
        left = np.mean((found - truth)[:, channel] ** 2) / np.mean(truth[:, channel] ** 2)
        assert left < 0.1
    np.testing.assert_array_equal(found[:, [1, 2, 3, 4]], 0.0)


@pytest.mark.parametrize('seed', range(5))
def test_nothing_is_learnt_from_noise(seed):
    assert residual_fit(windows(seed, lambda x: np.zeros((len(x), 6))), RULES) is None


def test_what_no_input_tells_is_not_learnt():
    """A force that drifts as it likes hangs on neither state nor command."""
    drift = np.cumsum(np.random.default_rng(3).normal(size=COUNT)) / 30.0
    assert residual_fit(windows(4, lambda x: drift[:, None] * np.eye(6)[0]), RULES) is None


def test_it_is_no_larger_than_on_what_it_was_learnt_from():
    seen = windows(1)
    function = residual_fit(seen, RULES)
    far = value(function, 50.0 * np.random.default_rng(5).normal(size=(500, len(INPUTS))))
    assert (np.abs(far) <= np.array(function.limit)).all()
    assert (np.array(function.limit) <= 1.5 * np.abs(force(seen.x)).max(axis=0) + 3 * NOISE).all()


def test_inputs_that_a_flight_does_not_tell_are_left_out():
    seen = windows(1)
    x = seen.x.copy()
    x[:300, AIR_Y] = np.nan
    x[:, THRUST] = 7.0
    function = residual_fit(replace(seen, x=x), RULES)
    names = {name for name, _ in function.inputs}
    assert names == set(INPUTS) - {'air_y', 'thrust'}


def test_one_part_alone_cannot_be_checked():
    assert residual_fit(windows(1, folds=1), RULES) is None


def test_the_same_windows_give_the_same_function():
    assert residual_fit(windows(1), RULES) == residual_fit(windows(1), RULES)
