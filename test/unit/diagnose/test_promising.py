# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which sets next to the best one are worth fitting."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.evidence import key_of, Quadratic
from quad_ident_ros.diagnose.promising import neighbours, REFITS
from quad_ident_ros.diagnose.rules import RULES

CAUSES = tuple(Candidate(name, name, (k,)) for k, name in enumerate(
    ('motor_lag', 'rotor_drag', 'wind', 'inflow', 'ground_effect', 'battery_sag')))
ROWS = {cause: [k] for k, cause in enumerate(CAUSES)}
FREE = np.full(len(CAUSES), np.inf)


def around(best, truth, stiffness=200.0):
    """Return the Quadratic around the best fit of a set of causes that are not tied."""
    truth = np.asarray(truth, float)
    now = np.array([value if cause in best else 0.0
                    for cause, value in zip(CAUSES, truth, strict=True)])
    away = truth - now
    return Quadratic(stiffness * np.eye(len(CAUSES)), stiffness * away,
                     stiffness * away @ away, now, np.eye(len(CAUSES)), -FREE, FREE, 1.0)


def sets_near(best, truth, tried=()):
    """Return the neighbours of a set without their distances."""
    return [chosen for chosen, _ in neighbours(best, CAUSES, around(best, truth), ROWS, RULES,
                                               tried)]


def test_what_the_best_set_lacks_is_added_to_it():
    best = CAUSES[:2]
    chosen, distances = neighbours(best, CAUSES, around(best, [1, 1, 1, 0, 0, 0]), ROWS, RULES,
                                   ())[0]
    assert chosen == CAUSES[:3]
    assert distances[:3] == pytest.approx(np.ones(3), rel=0.02)     # the prior draws to none


def test_another_takes_the_place_of_one_that_does_little():
    assert key_of((CAUSES[0], CAUSES[2])) in sets_near(CAUSES[:2], [1, 0, 1, 0, 0, 0])


def test_nothing_is_near_a_set_that_explains_all():
    assert sets_near(CAUSES[:2], [1, 1, 0, 0, 0, 0]) == []


def test_the_best_of_many_come_first_and_only_a_few():
    found = sets_near(CAUSES[:2], [1, 1, 0.5, 0.8, 0.6, 0.7])
    assert found == [key_of((*CAUSES[:2], CAUSES[k])) for k in (3, 5, 4)]
    assert len(found) == REFITS


def test_sets_that_were_fitted_or_exclude_one_another_do_not_come_again():
    truth = [1, 1, 1, 0, 0, 0]
    assert CAUSES[:3] not in sets_near(CAUSES[:2], truth, tried={CAUSES[:3]})
    twin = replace(CAUSES[1], columns=(2,), form='other')
    rows = {**ROWS, twin: [2]}
    found = neighbours(CAUSES[:2], (*CAUSES, twin), around(CAUSES[:2], truth), rows, RULES, ())
    assert not [chosen for chosen, _ in found if {twin, CAUSES[1]} <= set(chosen)]


def test_any_one_is_next_to_the_empty_set():
    assert sets_near((), [0, 0, 1, 0, 0, 0]) == [CAUSES[2:3]]
