# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The verdicts on the golden flights are those that were recorded; see test/golden."""

from flights import Case, CASES
import pytest
from verdicts import recorded, same_verdict, summary_of

KEPT = recorded()


def test_every_case_is_recorded():
    assert list(KEPT) == [case.name for case in CASES]


@pytest.mark.slow
@pytest.mark.parametrize('case', CASES, ids=lambda case: case.name)
def test_the_verdict_is_the_recorded_one(case: Case):
    # If it changes on purpose: .venv/bin/python test/golden record
    found = summary_of(case)
    assert same_verdict(KEPT[case.name], found), found
