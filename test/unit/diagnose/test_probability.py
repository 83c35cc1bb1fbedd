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
    relative_size,
    Support,
    told_apart,
)
from quad_ident_ros.diagnose.rules import RULES

Named = namedtuple('Named', 'effect form')
RULE = replace(RULES, calibration=(-1.0, 1.5, 2.0, -0.7, 0.3))


def of(contribution, distance, explained=0.9, relative=1.0, companions=0, stability=5.0):
    return Support(contribution, stability, explained, {}, distance, relative, companions)


@pytest.mark.parametrize('distance', [0.0, 2.0, 1e4])
@pytest.mark.parametrize('explained', [0.0, 0.8])
@pytest.mark.parametrize(('relative', 'companions'), [(0.0, 3), (0.3, 1), (1.0, 0)])
def test_it_is_the_logistic_function_of_a_weighted_sum(distance, explained, relative, companions):
    value = (-1.0 + 1.5 * explained + (2.0 - 0.7 * (1.0 - relative)) * np.log(1.0 + distance)
             + 0.3 * companions)
    assert presence(of(0.4, distance, explained, relative, companions), RULE) == pytest.approx(
        1.0 / (1.0 + np.exp(-value)))


def test_more_of_anything_that_speaks_for_it_makes_it_more_probable():
    base = presence(of(0.1, 5.0, 0.5, 0.4), RULES)
    assert presence(of(0.1, 9.0, 0.5, 0.4), RULES) > base
    assert presence(of(0.1, 5.0, 0.9, 0.4), RULES) > base
    assert presence(of(0.1, 5.0, 0.5, 0.6), RULES) > base
    assert presence(of(0.1, 5.0, 0.5, 0.4, 1), RULES) > base


def test_all_that_there_is_at_two_standard_errors_is_as_probable_as_not():
    assert presence(of(1.0, 2.0, explained=1.0), RULES) == pytest.approx(0.5, abs=0.005)


@pytest.mark.parametrize(('contribution', 'most', 'size'), [
    (0.5, 0.5, 1.0), (0.125, 0.5, 0.5), (0.02, 2.0, 0.1), (0.0, 0.5, 0.0), (-0.1, 0.5, 0.0),
    (-0.1, -0.1, 1.0), (0.0, 0.0, 1.0)])
def test_a_small_effect_makes_a_gap_by_the_square_of_its_size(contribution, most, size):
    assert relative_size(contribution, most) == pytest.approx(size)


def test_sizes_are_beside_the_greatest_effect():
    found = beside_others({'a': of(0.18, 9.0), 'b': of(0.5, 2.0), 'c': of(-0.1, 5.0)}, RULES)
    assert [found[name].relative for name in 'abc'] == pytest.approx([0.6, 1.0, 0.0])
    assert beside_others({'a': of(0.3, 9.0)}, RULES)['a'].relative == 1.0
    assert beside_others({}, RULES) == {}


def test_companions_are_the_others_that_clearly_contribute():
    supports = {'a': of(0.5, 0.9), 'b': of(0.3, 0.9), 'c': of(0.3, 0.9, stability=2.0),
                'd': of(0.05, 0.9)}
    found = beside_others(supports, RULES)
    assert [found[name].companions for name in 'abcd'] == [1, 1, 2, 2]


@pytest.mark.parametrize('contribution', [-1.0, 0.0, 1e6])
@pytest.mark.parametrize('distance', [0.0, 1e3])
@pytest.mark.parametrize('relative', [0.0, 1.0])
def test_nothing_is_certain(contribution, distance, relative):
    assert 0.0 < presence(of(contribution, distance, relative=relative), RULES) < 1.0


def test_what_is_not_in_the_best_set_keeps_its_posterior_summed_over_its_forms():
    drag, wind, gust = (Named('drag', 'a'), Named('wind', 'a'), Named('wind', 'b'))
    supports = {drag: of(0.8, 0.9)}
    found = probabilities({drag: 0.99, wind: 0.03, gust: 0.02}, supports, RULE)
    assert found == {'drag': presence(of(0.8, 0.9), RULE), 'wind': pytest.approx(0.05)}


def test_effects_that_are_not_told_apart_share_their_probability():
    """Each form of the mass counts for it; the drag has no rival and stays as it is."""
    mass, other, thrust = Named('mass', 'a'), Named('mass', 'b'), Named('thrust', 'a')
    posterior = {mass: 0.5, other: 0.2, thrust: 0.3, Named('drag', 'a'): 0.6}
    found = told_apart({'mass': 0.98, 'thrust': 0.3, 'drag': 0.9}, posterior, [mass])
    assert found == pytest.approx({'mass': 0.98 * 0.7, 'thrust': 0.3, 'drag': 0.9})
