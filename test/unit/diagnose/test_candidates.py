# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What may be named as a cause: forms of effects, and rotors of those of single rotors."""

from dataclasses import replace

import pytest

from quad_ident_ros.diagnose.candidates import candidates, usual_forms
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.parameters import NAMES
from quad_ident_ros.model.vehicle import load_vehicle

QUAD = load_vehicle('hummingbird')
FAULT = EFFECTS['rotor_fault']


def faults(vehicle):
    return candidates([], vehicle, RULES, ['rotor_fault'])


@pytest.mark.parametrize(('times', 'most'), [(1, 4), (2, 8), (3, 8)])
def test_each_rotor_is_a_candidate_in_each_form(times, most):
    """Of more rotors than the effect has parameters for, those that it has them for."""
    found = faults(replace(QUAD, rotors=times * QUAD.rotors))
    assert [tuple(NAMES[column] for column in one.columns) for one in found] == [
        (f'rotor_fault.{name}_{j}',) for name in ('loss', 'loss_both')
        for j in range(1, most + 1)]
    assert [one.rotor for one in found] == 2 * list(range(1, most + 1))
    assert len({one.label for one in found}) == len(set(found)) == 2 * most
    assert all(one.plain for one in found)


def test_forms_share_what_their_effect_has_and_rotors_what_their_form_has():
    found = faults(QUAD)
    assert {one.form: one.share for one in found} == {
        form.name: pytest.approx(0.25 * 0.5) for form in FAULT.forms}
    assert sum(one.share for one in found) == pytest.approx(1.0)


@pytest.mark.parametrize(('known', 'form'), [({}, 'thrust'), ({'loss_both_2': 0.1},
                                                              'thrust_and_torque')])
def test_the_usual_form_of_each_rotor_is_that_of_the_vehicle_file(known, form):
    usual = usual_forms(faults(replace(QUAD, effects={'rotor_fault': known})))
    assert list(usual) == [('rotor_fault', j) for j in range(1, 5)]
    assert {one.form for one in usual.values()} == {form}
