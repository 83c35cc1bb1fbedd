# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lagging motors and delayed commands against closed forms."""

from dataclasses import replace

from effect_flights import acted, BARE, held, hover_speed, roll, state, steps, VEHICLE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.effects.registry import NULL, SLICES
from quad_ident_ros.model.dynamics import Course, predict

FAST = settings(deadline=None, max_examples=60)
GRAVITY = BARE.gravity
HOVER = hover_speed(BARE)


def test_a_lagging_motor_answers_a_step_with_an_exponential():
    t = np.arange(51) * 0.01
    commands = np.full((51, 1), 500.0)
    commands[10:] = 700.0
    speeds = acted(t, commands, lag=0.05)[1][:, 0]
    exact = np.where(t < 0.1, 500.0, 700.0 - 200.0 * np.exp(-(t - 0.1) / 0.05))
    assert np.abs(speeds - exact).max() < 1e-10


@pytest.mark.parametrize('lag', [0.2, 0.05, 0.01])
def test_a_lagging_motor_lifts_with_the_square_of_its_speed(lag):
    # From hover to 1.1 of its speed: the integral of (c + g exp(-t / lag))^2.
    course = held(BARE, 1.1 * HOVER, seconds=0.5, period=0.002)
    course.commands[0] = HOVER
    t = course.t - course.t[1]
    gap = -0.1
    lifted = (1.21 * t + 2.2 * gap * lag * -np.expm1(-t / lag)
              + gap ** 2 * lag / 2 * -np.expm1(-2 * t / lag))
    found = roll(BARE, {'motor_lag': {'time_constant': lag}}, course, state())[1:, 5]
    # Steps of 2 ms: (h / lag)^4 / 180 of the part of exp(-2 t / lag), at most.
    assert np.abs(found - GRAVITY * (lifted - t)[1:]).max() < 1e-6


def test_a_lag_much_shorter_than_the_step_is_the_mean_of_its_exponential():
    course = held(BARE, 1.1 * HOVER)
    course.commands[0] = HOVER
    without = roll(BARE, {}, course, state())[-1]
    for lag in (1e-3, 1e-5, 1e-9):
        found = roll(BARE, {'motor_lag': {'time_constant': lag}}, course, state())[-1]
        # The thrust is 0.21 of the weight too small for about a lag, less the square of the gap.
        assert without[5] - found[5] == pytest.approx(0.22 * GRAVITY * lag, rel=0.06)


@pytest.mark.parametrize('count', [0, 1, 3, 20])
def test_a_delay_of_whole_samples_moves_the_commands_by_these(count):
    course = steps(VEHICLE)
    moved = np.concatenate([np.tile(course.commands[:1], (count, 1)), course.commands])[:101]
    # What acts after the last sample is nobody's to know.
    found, *_ = acted(course.t, course.commands, count * 0.01)
    assert np.abs(found - moved)[:-1].max() < 1e-10
    found = roll(VEHICLE, {'actuation_delay': {'delay': count * 0.01}}, course, state())
    expected = roll(VEHICLE, {}, replace(course, commands=moved), state())
    assert np.abs(found - expected).max() < 1e-10


@pytest.mark.slow
@FAST
@given(st.floats(0, 0.3), st.lists(st.floats(1e-3, 0.1), min_size=2, max_size=20),
       st.integers(0, 1000))
def test_a_delayed_command_has_the_mean_thrust_of_the_command(delay, steps, seed):
    # What acts until the end is what was commanded until a delay before, whatever the samples.
    t = np.concatenate([[0.0], np.cumsum(steps)])
    commands = np.random.default_rng(seed).uniform(0, 1000, (len(t), 2))
    followed, _, added = acted(t, commands, delay)
    # Simpson's rule, as steps of the integration weigh what acts in them.
    acting = (followed[:, None] + added) ** 2
    found = np.diff(t) @ np.einsum('p,npk->nk', [1 / 6, 4 / 6, 1 / 6], acting)[:-1]
    # The command held to the next sample, and the first one before it.
    until = np.clip(t[-1] - delay - t[:-1], 0.0, np.diff(t))
    expected = until @ commands[:-1] ** 2 + min(delay, t[-1]) * commands[0] ** 2
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize(('delay', 'lag'), [(0.0035, 0.0), (0.0135, 0.0), (0.0035, 0.02),
                                            (0.0135, 0.02), (0.0478, 0.05), (-0.0035, 0.02),
                                            (-0.0135, 0.05)])
@pytest.mark.parametrize('period', [0.005, 0.01, 0.02])
def test_a_command_that_acts_from_within_a_sample_on_acts_from_there(delay, lag, period):
    # Beside a grid so fine that commands change at its samples alone.
    fine = 0.0005
    random = np.random.default_rng(0)
    count, pieces = round(1.0 / period), round(period / fine)
    commands = HOVER * random.uniform(0.95, 1.05, (count + 1, len(VEHICLE.rotors)))
    coarse = Course(period * np.arange(count + 1), commands, np.zeros(count + 1))
    t = fine * np.arange(count * pieces + 1)
    exact = Course(t, np.repeat(commands, pieces, axis=0)[:len(t)], np.zeros(len(t)))
    late = round(delay / fine)
    acts = exact.commands[np.clip(np.arange(count * pieces) - late, 0, count * pieces)]
    means = np.sqrt((acts.reshape(count, pieces, -1) ** 2).mean(axis=1))
    smoothed = Course(coarse.t, np.concatenate([means, means[-1:]]), coarse.volt_drop)

    def flown(course, delay):
        theta = NULL.copy()
        theta[SLICES['actuation_delay']], theta[SLICES['motor_lag']] = delay, lag
        return predict(VEHICLE, theta, course, state()[None], [0], len(course.t) - 1)[0]

    expected = flown(exact, delay)[::pieces]
    found, mean = (np.abs(flown(course, each) - expected).max()
                   for course, each in ((coarse, delay), (smoothed, 0.0)))
    assert found < 1e-4
    # With the mean command of each sample in place of it, it is far off.
    assert found < 0.1 * mean


def test_a_command_that_the_integration_cannot_follow_has_its_mean_thrust():
    # Rotors that stand and are to turn late in a sample: no parabola above zero does that.
    t = 0.01 * np.arange(4)
    followed, _, added = acted(t, np.array([[0.0], [0.0], [1000.0], [1000.0]]), 0.009)
    acting = (followed[2] + added[2, :, 0]) ** 2
    assert acting == pytest.approx(np.full(3, 0.1 * 1000.0 ** 2))
