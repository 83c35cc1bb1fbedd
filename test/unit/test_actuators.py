# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Lagging motors and delayed commands against closed forms."""

from dataclasses import replace

from flight import BARE, held, hover_speed, roll, state, steps, VEHICLE
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.model.actuators import delayed, lagged

FAST = settings(deadline=None, max_examples=60)
GRAVITY = BARE.gravity
HOVER = hover_speed(BARE)


def test_a_lagging_motor_answers_a_step_with_an_exponential():
    t = np.arange(51) * 0.01
    commands = np.full((51, 1), 500.0)
    commands[10:] = 700.0
    speeds = lagged(t, commands, 0.05)[:, 0]
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
        # The thrust lacks 0.21 of the weight for about a lag, less the square of the gap.
        assert without[5] - found[5] == pytest.approx(0.22 * GRAVITY * lag, rel=0.06)


@pytest.mark.parametrize('count', [0, 1, 3, 20])
def test_a_delay_of_whole_samples_moves_the_commands_by_these(count):
    course = steps(VEHICLE)
    moved = np.concatenate([np.tile(course.commands[:1], (count, 1)), course.commands])[:101]
    # What acts after the last sample is nobody's to know.
    found = delayed(course.t, course.commands, count * 0.01)
    assert np.abs(found - moved)[:-1].max() < 1e-10
    found = roll(VEHICLE, {'actuation_delay': {'delay': count * 0.01}}, course, state())
    expected = roll(VEHICLE, {}, replace(course, commands=moved), state())
    assert np.abs(found - expected).max() < 1e-10


@FAST
@given(st.floats(0, 0.3), st.lists(st.floats(1e-3, 0.1), min_size=2, max_size=20),
       st.integers(0, 1000))
def test_a_delayed_command_has_the_mean_thrust_of_the_command(delay, steps, seed):
    # What acts until the end is what was commanded until a delay before, whatever the samples.
    t = np.concatenate([[0.0], np.cumsum(steps)])
    commands = np.random.default_rng(seed).uniform(0, 1000, (len(t), 2))
    found = np.diff(t) @ delayed(t, commands, delay)[:-1] ** 2
    # The command held to the next sample, and the first one before it.
    until = np.clip(t[-1] - delay - t[:-1], 0.0, np.diff(t))
    expected = until @ commands[:-1] ** 2 + min(delay, t[-1]) * commands[0] ** 2
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-6)
