# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Standard errors over sets that differ in what flights have of their own."""

from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.fitted import Fitted
from quad_ident_ros.diagnose.select import Selection
from quad_ident_ros.greybox.own import Nuisance

EFFECT, OTHER = Candidate('a', 'a', (0,)), Candidate('b', 'b', (1,))


def own(spread):
    kind = Nuisance('bias', 'bias', 'rad/s', (0,), (spread,))
    return Candidate('bias', 'bias', (0,), kind)


def fitted(chosen, value, error, evidence):
    estimate = SimpleNamespace(z=np.array([value, 0.0]), columns=[0], errors=np.array([error]))
    return Fitted(chosen, estimate, evidence)


def errors(*sets):
    return Selection(sets[0], sets, {}, None, {}, []).errors


NARROW = fitted((EFFECT, own(0.003)), 1.0, 0.1, 0.0)


def test_one_set_has_its_own():
    assert errors(NARROW) == pytest.approx([0.1])


def test_sets_that_are_as_good_count_alike_with_what_they_differ_in():
    wide = fitted((EFFECT, own(0.01)), 1.4, 0.3, 0.0)
    assert errors(NARROW, wide) == pytest.approx([np.sqrt((0.1 ** 2 + 0.3 ** 2 + 0.4 ** 2) / 2)])


def test_they_count_by_their_evidence():
    wide = fitted((EFFECT, own(0.01)), 1.0, 0.3, -np.log(3.0))
    assert errors(NARROW, wide) == pytest.approx([np.sqrt((3 * 0.1 ** 2 + 0.3 ** 2) / 4)])


def test_sets_with_other_effects_do_not_count():
    assert errors(NARROW, fitted((EFFECT, OTHER), 2.0, 5.0, 3.0)) == pytest.approx([0.1])


def test_a_set_is_within_one_that_has_more_effects_and_no_less_of_anything():
    alone = fitted((EFFECT,), 1.0, 0.1, 0.0)
    both = fitted((EFFECT, OTHER), 1.0, 0.1, 0.0)
    assert alone.within(both) and not both.within(alone) and not alone.within(alone)
    assert not NARROW.within(both)      # which has no bias of flights
    assert not alone.within(NARROW)     # which has no more effects
