# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/effects.md says what the registry says."""

import pytest

from benchmarks.tables import DOCUMENTS, replaced
from docs.effects import effects_table, forms_table, parameters_table
from quad_ident_ros.effects.registry import EFFECTS

PAGE = (DOCUMENTS / 'effects.md').read_text(encoding='utf-8')


@pytest.mark.parametrize(('name', 'table'), [('effects', effects_table), ('forms', forms_table),
                                             ('parameters', parameters_table)])
def test_the_page_has_the_tables_of_the_registry(name, table):
    # If this fails: .venv/bin/python -m docs.effects
    assert replaced(PAGE, name, table()) == PAGE


@pytest.mark.parametrize('name', EFFECTS)
def test_an_effect_has_its_forms_parameters_units_and_likeness(name):
    effect = EFFECTS[name]
    rows = [line.split(' | ') for line in PAGE.splitlines() if line.startswith(f'| `{name}` |')]
    assert [len(row) for row in rows] == [5, 3, 8]
    assert effect.excitation == rows[0][3]
    for other in effect.confused_with:
        assert f'`{other}`' in rows[0][4]
    assert rows[2][3] == effect.parameters[0].unit
    for form in effect.forms:
        assert f'`{form.name}`' in rows[0][2] and f'| `{form.name}` | **{form.title}**' in PAGE
        for parameter in form.parameters if not effect.per_rotor else form.parameters[:1]:
            assert f'| `{parameter.name}`' in PAGE and parameter.description[:12] in PAGE
