# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is said of an effect whose law is none of its forms."""

from dataclasses import replace

from published import diagnosis
import pytest

from quad_ident_ros.report.verdict import next_step, verdict_line

FOUND = diagnosis(form_unknown=('rotor_drag',))
ROW = replace(FOUND.ranking[0], explained=0.413)


@pytest.mark.parametrize('shown', [(), ('force',)])
def test_a_residual_function_is_proposed_only_where_it_is_shown_to_help(shown):
    found = replace(FOUND, ceiling=replace(FOUND.ceiling, shown=shown))
    assert ('--residual' in next_step(found)) == bool(shown)
    assert '"unexplained"' in next_step(found) and next_step(found).endswith('.')


@pytest.mark.parametrize('probability', [0.3, 0.9])
def test_an_effect_of_unknown_form_is_said_to_be_one_however_probable_it_is(probability):
    found = replace(FOUND, ranking=(replace(ROW, probability=probability),))
    assert ('uncertain' in verdict_line(found)) == (probability < 0.5)
    assert ('drag of the rotors (rotor_drag), form unknown: 41 % of it explained by by_speed, '
            'coefficient 0.2') in verdict_line(found)
