# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The evidence of sets of causes by the linear model, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.evidence import beam, linear_evidence, occam, Quadratic

CAUSES = tuple(Candidate(name, name, (k,)) for k, name in enumerate(('a', 'b', 'c')))
ROWS = {cause: [k] for k, cause in enumerate(CAUSES)}
WIDE = np.array([1.0, 2.0, 3.0])
FREE = np.full(3, np.inf)


def quadratic(information, best, rest=10.0, lower=-FREE, upper=FREE):
    """Return the Quadratic, from no effect on, of a cost that is `rest` at its best point."""
    information, best = np.asarray(information, float), np.asarray(best, float)
    return Quadratic(information, information @ best, rest + best @ information @ best,
                     np.zeros(3), WIDE, lower, upper, 1.0)


def expected(cost, chosen):
    """Return the evidence of causes by the Gaussian integral over their parameters."""
    free = [k for cause in chosen for k in ROWS[cause]]
    block = cost.information[np.ix_(free, free)]
    prior = np.diag(WIDE[free] ** -2.0)
    left = cost.cost - cost.gradient[free] @ np.linalg.solve(block + prior, cost.gradient[free])
    return -0.5 * left + occam(block, WIDE[free], 1.0, chosen)


SETS = [(), CAUSES[:1], CAUSES[1:2], CAUSES[:2], (CAUSES[0], CAUSES[2]), CAUSES]
TIED = [[50.0, 30.0, 0.0], [30.0, 40.0, 5.0], [0.0, 5.0, 20.0]]


def test_the_evidence_is_the_integral_over_the_parameters():
    cost = quadratic(TIED, [0.5, -1.0, 0.2])
    values = linear_evidence(cost, SETS, ROWS)[0]
    assert values == pytest.approx([expected(cost, chosen) for chosen in SETS], rel=1e-12)


def test_it_does_not_depend_on_where_the_cost_was_linearised():
    here, at = quadratic(TIED, [0.5, -1.0, 0.2]), np.array([0.3, 0.1, -0.4])
    there = replace(here, now=at, gradient=here.gradient - here.information @ at,
                    cost=here.cost - 2.0 * here.gradient @ at + at @ here.information @ at)
    for one, other in zip(linear_evidence(here, SETS, ROWS), linear_evidence(there, SETS, ROWS),
                          strict=True):
        assert one == pytest.approx(other, rel=1e-10, abs=1e-12)


def test_a_cause_that_could_only_help_beyond_its_bound_is_none():
    cost = quadratic(TIED, [0.5, -1.0, 0.2], lower=np.zeros(3))
    values, found = linear_evidence(cost, [CAUSES[1:2], CAUSES[:2]], ROWS)
    assert np.isneginf(values).all() and (found >= 0.0).all()


def test_a_parameter_ends_at_its_bound():
    cost = quadratic(np.diag([50.0, 40.0, 20.0]), [0.5, -1.0, 0.2], upper=np.full(3, 0.25))
    _, found = linear_evidence(cost, [CAUSES[:1]], ROWS)
    assert found[0, 0] == 0.25


def test_the_beam_ranks_the_causes_that_are_there_first():
    cost = quadratic(TIED, [2.0, 0.0, -1.5])
    ranked = beam(cost, ROWS)
    assert ranked[0][1] == (CAUSES[0], CAUSES[2])
    values = [value for value, _, _ in ranked]
    assert values == sorted(values, reverse=True)
    assert {chosen for _, chosen, _ in ranked} >= {(), CAUSES}
