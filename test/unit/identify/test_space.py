# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The search space: that its bounds, which come from the data, hold the truth and little more."""

import numpy as np
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.excitation import excite
from quad_ident_ros.identify.objective import Objective
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.space import COMPLEX_PENALTY, find_space, literal_space, SIZE, Space
from quad_ident_ros.identify.transfer import response, SecondOrder

KINDS = ('step', 'prbs', 'chirp', 'doublet')


def objective(model, kind='prbs', duration=5.0, period=0.01, noise=0.0, seed=0):
    t = np.arange(round(duration / period) + 1) * period
    u = excite('u', {'type': kind, 'amplitude': 0.1}, t)
    y = response(model, u, period)
    y = y + noise * np.ptp(y) * np.random.default_rng(seed).normal(size=len(y))
    return Objective(Signal('phi', t, u, y, period, True))


def systems(form, count, duration, seed=0):
    """Draw systems from those that grow e^8-fold over a record to those of 1 % of its length."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        if form == 'real':
            poles = [random.uniform(-8, 0) if random.random() < 0.25
                     else 10 ** random.uniform(-1, 2.2) for _ in range(2)]
            yield SecondOrder.from_poles(1.0, *np.array(poles) / duration)
        else:
            turn = 10 ** random.uniform(0.3, 1.8)
            yield SecondOrder.from_half_difference(
                1.0, turn * random.uniform(-0.05, 1.0) / duration, -turn / duration)


def ends(model):
    """Return what a box must hold: b and a, or m - w and m + w of a pair."""
    half = abs(model.a - model.b) / 2
    return model.c1 / 2 - half, model.c1 / 2 + half


@pytest.mark.parametrize('duration', [5.0, 20.0])
@pytest.mark.parametrize('form', ['real', 'complex'])
def test_bounds_hold_the_truth(form, duration):
    # Measured over 960 draws: 99.6 % of the real, 99.4 % of the complex ones.
    held, sizes = [], []
    for k, model in enumerate(systems(form, 40, duration)):
        space = find_space(objective(model, KINDS[k % 4], duration))
        low, high = ends(model)
        held.append(space.poles[0] <= low and high <= space.poles[1])
        least = max(high, 2.5 / duration) - min(low, -2.5 / duration)
        sizes.append((space.poles[1] - space.poles[0]) / least)
    assert np.mean(held) >= 0.95
    # And little more than twice what must be in it: the search has something to find it in.
    assert np.median(sizes) < 2.2


def test_bounds_hold_a_fast_pole_of_a_long_record():
    # 60 s of yaw with its pole at 28 1/s: 1700 times faster than the record is long.
    space = find_space(objective(SecondOrder.from_poles(1090.0, 28.0, 0.0), 'prbs', 60.0, 0.01))
    assert space.poles[0] <= 0.0 and 28.0 <= space.poles[1] < 150.0


def test_bounds_are_never_narrower_than_what_a_record_can_tell_from_zero():
    space = find_space(objective(SecondOrder.from_poles(1.0, 0.0, 0.0)))
    assert space.poles == pytest.approx((-2.5 / 5.01, 2.5 / 5.01))


def test_gain_bounds_hold_the_gain():
    for model in systems('real', 20, 5.0):
        low, high = find_space(objective(model)).gain
        assert low < model.gain < high and low == -high


@pytest.mark.parametrize('noise', [0.01, 0.05])
def test_noise_does_not_blow_the_bounds_up(noise):
    model = SecondOrder.from_poles(3.5, 2.0, 0.5)
    for seed in range(10):
        space = find_space(objective(model, noise=noise, seed=seed))
        assert space.poles[0] <= 0.5 and 2.0 <= space.poles[1] < 20.0


def test_given_bounds_are_taken_and_cost_nothing():
    task = objective(SecondOrder.from_poles(3.5, 2.0, 0.5))
    space = find_space(task, pole_bounds=(-1.0, 9.0), gain_bounds=(0.0, 5.0))
    assert (space.poles, space.gain, space.evaluations) == ((-1.0, 9.0), (0.0, 5.0), 0)
    found = find_space(task)
    assert 50 < found.evaluations < 500
    assert find_space(task, pole_bounds=(-1.0, 9.0)).poles == (-1.0, 9.0)


@pytest.mark.parametrize('name', ['pole_bounds', 'gain_bounds'])
@pytest.mark.parametrize('bounds', [(1.0, 1.0), (2.0, 1.0), (float('nan'), 1.0),
                                    (0.0, float('inf'))], ids=str)
def test_bounds_that_are_none_are_refused(name, bounds):
    with pytest.raises(InputError, match=name):
        find_space(objective(SecondOrder.from_poles(3.5, 2.0, 0.5)), **{name: bounds})


def test_the_same_data_give_the_same_bounds():
    task = objective(SecondOrder.from_poles(3.5, 2.0, 0.5), noise=0.01)
    assert find_space(task) == find_space(task)


def test_the_box_stands_for_real_poles_and_pairs():
    space = Space((-10.0, 90.0), (-1.0, 1.0), COMPLEX_PENALTY['auto'])
    points = np.array([[0.0, 0.0], [SIZE, SIZE], [100.0, 60.0], [60.0, 100.0]])
    mean, half = space.mean_and_half(points)
    # The corners are double poles at the bounds; above the diagonal lie a = 40, b = 20, below it
    # the pair 30 +- 10j.
    assert np.allclose(mean, [-10.0, 90.0, 30.0, 30.0])
    assert np.allclose(half, [0.0, 0.0, 10.0, -10.0])
    real = Space((-10.0, 90.0), (-1.0, 1.0), COMPLEX_PENALTY['real'])
    assert (real.mean_and_half(points)[1] >= 0).all()


def test_pairs_cost_by_the_parameter_poles():
    task = objective(SecondOrder.from_half_difference(5.0, 0.5, -3.0))
    point = np.array([[60.0, 100.0]])
    spaces = {name: Space((-10.0, 10.0), (-1.0, 1.0), penalty)
              for name, penalty in COMPLEX_PENALTY.items()}
    costs = {name: space.cost(task, point)[0] for name, space in spaces.items()}
    assert costs['auto'] == pytest.approx(4 * costs['any'])
    assert np.isfinite(costs['real'])   # it stands for real poles there


def test_the_literal_box_is_the_paper_s():
    space = literal_space()
    assert space.poles == space.gain == (0.0, 200.0)
