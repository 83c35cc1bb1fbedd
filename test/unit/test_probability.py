# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The probability that an effect is present: a logistic regression, and its limits."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose.probability import presence, probabilities
from quad_ident_ros.diagnose.rules import RULES

RULE = replace(RULES, calibration=(-1.0, 0.6, 1.5, 0.05))


@pytest.mark.parametrize(('posterior', 'stability', 'contribution'), [
    (0.5, 0.0, 1.0), (0.9, 3.0, 0.1), (0.1, -2.0, 0.01)])
def test_it_is_the_logistic_function_of_a_weighted_sum(posterior, stability, contribution):
    odds = np.log(posterior / (1.0 - posterior))
    value = -1.0 + 0.6 * stability + 1.5 * np.log10(contribution) + 0.05 * odds
    assert presence(posterior, stability, contribution, RULE) == pytest.approx(
        1.0 / (1.0 + np.exp(-value)))


def test_more_of_anything_that_speaks_for_it_makes_it_no_less_probable():
    base = presence(0.6, 2.0, 0.1, RULES)
    for more in ((0.9, 2.0, 0.1), (0.6, 4.0, 0.1), (0.6, 2.0, 0.5)):
        assert presence(*more, RULES) >= base


@pytest.mark.parametrize('posterior', [0.0, 1.0])
def test_nothing_is_certain(posterior):
    for stability in (-1e6, 1e6):
        for contribution in (-1.0, 0.0, 1e6):
            assert 0.0 < presence(posterior, stability, contribution, RULES) < 1.0


def test_what_is_not_in_the_best_set_keeps_its_posterior():
    weights = {'drag': SimpleNamespace(stability=5.0, contribution=0.8)}
    found = probabilities({'drag': 0.99, 'wind': 0.03}, weights, RULE)
    assert found == {'drag': presence(0.99, 5.0, 0.8, RULE), 'wind': 0.03}
