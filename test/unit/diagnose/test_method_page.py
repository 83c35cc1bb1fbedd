# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The page that explains the method names every threshold, and has the weights in use."""

from dataclasses import fields
from pathlib import Path

import pytest

from quad_ident_ros.diagnose.rules import RULES

PAGE = (Path(__file__).parents[3] / 'docs' / 'method.md').read_text()


@pytest.mark.parametrize('name', [field.name for field in fields(RULES)])
def test_every_threshold_stands_in_the_table(name):
    assert f'`{name}`' in PAGE


def test_the_weights_of_the_probability_are_those_of_the_formula():
    base, form, far, lesser, beside = RULES.calibration
    assert (f'ln(p / (1 - p)) = {base:g} + {form:g} E '
            f'+ ({far:g} - {-lesser:g} (1 - q)) ln(1 + D) + {beside:g} K') in PAGE
    weights = ', '.join(f'{weight:g}' for weight in RULES.calibration)
    assert f'| `calibration` | {weights} |' in PAGE
