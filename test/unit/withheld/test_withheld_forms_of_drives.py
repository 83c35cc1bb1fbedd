# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors, lines of commands and batteries of other forms: what each does."""

import numpy as np
import pytest
from withheld_parts import HOVER, made, PARAMS

from withheld.forms import drives, supplies, traffic


def turned(motor, speeds, command, seconds, step=0.001):
    """Return the speeds of rotors after some seconds, all of those in hover."""
    speeds = HOVER * np.array(speeds)
    for _ in range(round(seconds / step)):
        speeds = motor.turn(speeds, HOVER * np.array(command), step)
    return speeds / HOVER


def test_a_motor_at_its_limit_of_current_speeds_up_slowly_and_slows_down_fast():
    motor = drives.CurrentLimited(3.0, PARAMS, None)
    slow, fast, *_ = turned(motor, [0.7, 1.3, 1.0, 1.0], [1.3, 0.7, 1.0, 1.0], 0.02)
    # dw/dt = B (L - w^2) or -B (L + w^2), in terms of hover; B (L - 1) = 8 / grown per s.
    limit = 1.1 * (PARAMS['rotor_speed_max'] / HOVER) ** 2
    root, change = np.sqrt(limit), 8.0 / (limit - 1.0) / 3.0 ** 0.7 * 0.02
    assert slow == pytest.approx(
        root * np.tanh(root * change + np.arctanh(0.7 / root)), rel=2e-3)
    assert fast == pytest.approx(
        root * np.tan(np.arctan(1.3 / root) - root * change), rel=2e-3)
    assert 1.3 - fast > 1.3 * (slow - 0.7)


def test_a_limit_of_current_leaves_a_motor_its_top_speed():
    top = PARAMS['rotor_speed_max'] / HOVER
    assert turned(drives.CurrentLimited(6.0, PARAMS, None), [1.0] * 4, [top] * 4, 3.0) == (
        pytest.approx(np.full(4, top)))


def test_a_motor_below_its_limit_of_current_is_a_lag():
    motor = drives.CurrentLimited(3.0, PARAMS, None)
    [speed, *_] = turned(motor, [1.0] * 4, [1.01] * 4, 0.01)
    assert 1.01 - speed == pytest.approx(0.01 * np.exp(-0.01 / motor.parameters['time']))
    [speed, *_] = turned(motor, [1.0] * 4, [1.2] * 4, 2.0)
    assert speed == pytest.approx(1.2)


def test_one_motor_is_slow_and_all_together_have_the_mean_time():
    motor = made('motor_lag', 'one_slow', 2.0)
    missing = 1.2 - turned(motor, [1.0] * 4, [1.2] * 4, 0.03)
    times = -0.03 / np.log(missing / 0.2)
    assert np.mean(times) == pytest.approx(0.024)
    assert sorted(times / 0.024) == pytest.approx([0.6, 0.6, 0.6, 2.2])


def test_a_command_is_sent_again_as_often_as_it_fails():
    line = traffic.Retransmitted(1.0, PARAMS, None)
    line.begin(np.random.default_rng(1))
    tries = np.array([line.waits(0.0) for _ in range(4000)]) / (0.5 * line.delay)
    assert tries == pytest.approx(np.round(tries)) and 5.0 < tries.max() <= 10.0
    shares = [np.mean(np.round(tries) == count) for count in (1, 2, 3)]
    assert shares == pytest.approx([0.5, 0.25, 0.125], abs=0.03)
    assert tries.mean() == pytest.approx(2.0, abs=0.1)


def test_commands_wait_together_until_the_card_is_written():
    line = made('actuation_delay', 'blocked', 2.0)
    times = np.arange(0.0, 30.0, 0.001)
    waits = np.array([line.waits(t) for t in times])
    assert waits.mean() == pytest.approx(line.delay, rel=0.02)
    assert waits.min() == pytest.approx(0.6 * line.delay)
    # Those that wait for the card come at one time.
    held = waits > 0.6 * line.delay + 1e-9
    comes = (times + waits)[held]
    assert len(np.unique(np.round(comes, 6))) == pytest.approx(30.0 / line.EVERY, abs=1.0)
    assert held.mean() == pytest.approx(line.writes / line.EVERY, rel=0.02)


def test_a_cell_whose_ions_diffuse_sags_with_the_root_of_the_time():
    battery, shown = supplies.Diffusing(2.0, PARAMS, None), {}
    for k in range(1, 2001):
        battery.drain(0.0, 0.01, np.ones(4))
        shown[k] = 1.0 - battery.ratio
    for k in (100, 200, 500):
        assert np.log(shown[4 * k] / shown[k]) / np.log(4.0) == pytest.approx(0.5, abs=0.13)
    for _ in range(2000):
        battery.drain(0.0, 0.01, np.zeros(4))
    assert 0.0 < 1.0 - battery.ratio < 0.5 * shown[2000]        # it recovers, as slowly


def cut(loads):
    """Return the power that is taken away, in stages, after each load of one s."""
    battery, shown = supplies.SoftCutoff(2.0, PARAMS, None), []
    for load in loads:
        for _ in range(100):
            battery.drain(0.0, 0.01, np.full(4, load ** (1.0 / 3.0)))
        shown.append((1.0 - battery.gain(np.ones(4))) / 0.02)
    return shown


def test_a_controller_takes_power_in_stages_as_the_voltage_falls():
    shown = cut([1.0] * 20)
    assert [shown[k] for k in (2, 7, 12, 19)] == pytest.approx([0.0, 1.0, 2.0, 3.0], abs=0.1)


def test_what_a_controller_takes_at_a_high_load_does_not_come_back():
    shown = cut([1.0, 1.9, 1.9, 0.3, 0.3, 0.3])
    assert cut([1.0] * 3)[-1] == pytest.approx(0.0) and shown[-1] == pytest.approx(1.0, abs=0.02)
