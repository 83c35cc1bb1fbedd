# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Causes between which flights cannot decide, by the evidence of sets."""

from types import SimpleNamespace

import numpy as np

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.doubts import doubts_of
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.greybox.parameters import INDEX

MASS, THRUST, BIAS = (Candidate(name, name, (INDEX[f'{name}.{parameter}'],))
                      for name, parameter in (('mass_offset', 'mass'), ('thrust_scale', 'factor'),
                                              ('gyro_bias', 'x')))


def at_once(cause, rival, having):
    """Say that every rival does what the cause does."""
    return True


def selected(*sets, posterior):
    """Return a selection of sets of causes by their log-evidence, the best first."""
    fitted = [SimpleNamespace(causes=causes, evidence=evidence) for causes, evidence in sets]
    return SimpleNamespace(best=fitted[0], fitted=fitted, posterior=posterior)


def test_only_what_stands_in_its_place_is_a_rival():
    """The rate's bias is present or not with either of the two, and so is no rival."""
    sets = [((MASS,), 0.0), ((THRUST,), -0.4), ((MASS, BIAS), -0.1), ((THRUST, BIAS), -0.5),
            ((), -90.0)]
    unsure = selected(*sets, posterior={MASS: 0.6, THRUST: 0.4, BIAS: 0.5})
    doubts = doubts_of(unsure, (MASS,), RULES, at_once)
    assert list(doubts) == [MASS, THRUST]
    assert [fit.causes for fit in doubts.values()] == [(MASS,), (THRUST,)]
    sure = selected(*sets, posterior={MASS: 0.96, THRUST: 0.2, BIAS: 0.5})
    assert not doubts_of(sure, (MASS,), RULES, at_once)


def test_a_rival_is_ruled_out_by_the_factor_by_which_a_larger_set_would_be_taken():
    sets = [((MASS,), 0.0), ((THRUST,), -0.4), ((), -90.0)]
    for behind, rules_out in ((RULES.alike - 0.1, False), (RULES.alike + 0.1, True)):
        share = 1.0 / (1.0 + np.exp(behind))
        found = selected(*sets, posterior={MASS: 1.0 - share, THRUST: share})
        assert (not doubts_of(found, (MASS,), RULES, at_once)) == rules_out


def test_which_rotor_is_weak_is_no_doubt_between_effects():
    one, other = (Candidate('rotor_fault', f'rotor_fault {j}', (INDEX[f'rotor_fault.loss_{j}'],))
                  for j in (1, 2))
    found = selected(((one,), 0.0), ((other,), -0.1), posterior={one: 0.5, other: 0.5})
    assert not doubts_of(found, (one,), RULES, at_once)


def test_a_set_with_both_speaks_for_neither():
    """One of the two is needed; that both are a little better does not say which one it is."""
    found = selected(((MASS,), 0.0), ((MASS, THRUST), 1.0), ((THRUST,), -0.4), ((), -90.0),
                     posterior={MASS: 0.8, THRUST: 0.3})
    assert list(doubts_of(found, (MASS,), RULES, at_once)) == [MASS, THRUST]


def test_a_rival_that_needs_further_effects_is_none():
    """Of sets that explain flights equally well, that with the fewest effects is the verdict."""
    found = selected(((THRUST,), -6.0), ((MASS, BIAS), 0.0), ((THRUST, BIAS), 0.0),
                     posterior={THRUST: 0.5, MASS: 0.5, BIAS: 0.04})
    assert list(doubts_of(found, (THRUST,), RULES, at_once)) == [THRUST, MASS]
    assert not doubts_of(found, (THRUST,), RULES, lambda *_: False)
