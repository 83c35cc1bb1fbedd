# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The probability that an effect is present: a logistic regression, and its limits."""

from collections import namedtuple
from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.diagnose.probability import (
    beside_others,
    presence,
    probabilities,
    size_shown,
    told_apart,
    Weight,
)
from quad_ident_ros.diagnose.rules import RULES

Named = namedtuple('Named', 'effect form')
RULE = replace(RULES, calibration=(-1.0, 1.5, 2.0, 0.3, -0.7))


def of(contribution, distance, companions=0, stability=5.0, lesser=False):
    return Weight(contribution, stability, 0.9, {}, distance, companions, lesser)


@pytest.mark.parametrize(('contribution', 'distance', 'companions', 'size'),
                         [(1.0, 0.0, 0, 0.0), (0.25, 1.0, 3, 0.0),
                          (0.25, 2.0, 3, 0.5 * 0.75 ** 0.5),
                          (0.01, 1e4, 1, 0.1), (-1.0, 9.0, 0, 0.0), (4.0, 1e6, 0, 1.0)])
def test_it_is_the_logistic_function_of_a_weighted_sum(contribution, distance, companions, size):
    """Of the square of what is twice its standard error, a quarter is by chance."""
    assert size_shown(contribution, distance) == pytest.approx(size, rel=1e-6)
    value = -1.0 + 1.5 * size + 2.0 * np.log(1.0 + distance) + 0.3 * companions
    assert presence(of(contribution, distance, companions), RULE) == pytest.approx(
        1.0 / (1.0 + np.exp(-value)))
    value -= 0.7 * np.log(1.0 + distance)
    assert presence(of(contribution, distance, companions, lesser=True), RULE) == pytest.approx(
        1.0 / (1.0 + np.exp(-value)))


def test_more_of_anything_that_speaks_for_it_makes_it_more_probable():
    base = presence(of(0.1, 5.0), RULES)
    assert presence(of(0.5, 5.0), RULES) > base
    assert presence(of(0.1, 9.0), RULES) > base
    assert presence(of(0.1, 5.0, 1), RULES) > base
    assert presence(of(0.1, 5.0, lesser=True), RULES) < base


def test_all_that_there_is_at_two_standard_errors_is_as_probable_as_not():
    assert presence(of(1.0, 2.0), RULES) == pytest.approx(0.5, abs=0.005)


def test_companions_are_the_others_that_clearly_contribute():
    weights = {'a': of(0.5, 0.9), 'b': of(0.3, 0.9), 'c': of(0.3, 0.9, stability=2.0),
               'd': of(0.05, 0.9)}
    found = beside_others(weights, RULES)
    assert [found[name].companions for name in 'abcd'] == [1, 1, 2, 2]


def test_all_but_the_greatest_are_lesser_ones():
    found = beside_others({'a': of(0.3, 9.0), 'b': of(0.5, 2.0), 'c': of(0.1, 5.0)}, RULES)
    assert [found[name].lesser for name in 'abc'] == [True, False, True]
    assert not beside_others({'a': of(0.3, 9.0)}, RULES)['a'].lesser


@pytest.mark.parametrize('contribution', [-1.0, 0.0, 1e6])
@pytest.mark.parametrize('distance', [0.0, 1e3])
@pytest.mark.parametrize('companions', [0, 7])
def test_nothing_is_certain(contribution, distance, companions):
    assert 0.0 < presence(of(contribution, distance, companions), RULES) < 1.0


def test_what_is_not_in_the_best_set_keeps_its_posterior_summed_over_its_forms():
    drag, wind, gust = (Named('drag', 'a'), Named('wind', 'a'), Named('wind', 'b'))
    weights = {drag: of(0.8, 0.9)}
    found = probabilities({drag: 0.99, wind: 0.03, gust: 0.02}, weights, RULE)
    assert found == {'drag': presence(of(0.8, 0.9), RULE), 'wind': pytest.approx(0.05)}


def test_effects_that_are_not_told_apart_share_their_probability():
    """Each form of the mass counts for it; the drag has no rival and stays as it is."""
    mass, other, thrust = Named('mass', 'a'), Named('mass', 'b'), Named('thrust', 'a')
    posterior = {mass: 0.5, other: 0.2, thrust: 0.3, Named('drag', 'a'): 0.6}
    found = told_apart({'mass': 0.98, 'thrust': 0.3, 'drag': 0.9}, posterior, [mass])
    assert found == pytest.approx({'mass': 0.98 * 0.7, 'thrust': 0.3, 'drag': 0.9})
