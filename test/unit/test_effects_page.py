# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/effects.md says what the registry says."""

import pytest

from benchmarks.tables import DOCUMENTS, replaced
from docs.effects import effects_table, parameters_table
from quad_ident_ros.effects.registry import EFFECTS

PAGE = (DOCUMENTS / 'effects.md').read_text(encoding='utf-8')


@pytest.mark.parametrize(('name', 'table'), [('effects', effects_table),
                                             ('parameters', parameters_table)])
def test_the_page_has_the_tables_of_the_registry(name, table):
    # If this fails: .venv/bin/python -m docs.effects
    assert replaced(PAGE, name, table()) == PAGE


@pytest.mark.parametrize('name', EFFECTS)
def test_an_effect_has_its_formula_parameters_units_source_and_likeness(name):
    effect = EFFECTS[name]
    rows = [line.split(' | ') for line in PAGE.splitlines() if line.startswith(f'| `{name}` |')]
    assert [len(row) for row in rows] == [4, 7]
    assert effect.excitation == rows[0][2]
    for other in effect.confused_with:
        assert f'`{other}`' in rows[0][3]
    assert rows[1][2] == effect.parameters[0].unit
    for parameter in effect.parameters if not effect.per_rotor else effect.parameters[:1]:
        assert f'| `{parameter.name}`' in PAGE and parameter.description[:12] in PAGE
