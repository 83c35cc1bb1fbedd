# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The public Python API: its page, its annotations and the notebook."""

import doctest
import inspect
import json
from pathlib import Path
import re

import pytest

from quad_ident_ros import api

DOCS = Path(__file__).resolve().parents[2] / 'docs'
PAGE = DOCS / 'python.md'


@pytest.mark.slow
def test_the_examples_of_the_page_do_what_they_print(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r'^```pycon\n(.*?)^```', PAGE.read_text(encoding='utf-8'), re.M | re.S)
    examples = doctest.DocTestParser().get_doctest('\n'.join(blocks), {}, PAGE.name, str(PAGE), 0)
    said = []
    result = doctest.DocTestRunner().run(examples, out=said.append)
    assert result.attempted > 20 and not result.failed, ''.join(said)


def test_the_page_names_everything_that_is_public():
    text = PAGE.read_text(encoding='utf-8')
    assert sorted(api.__all__, key=str.lower) == api.__all__
    assert [name for name in api.__all__ if not re.search(rf'\b{name}\b', text)] == []


@pytest.mark.parametrize('name', [name for name in api.__all__
                                  if inspect.isfunction(getattr(api, name))])
def test_every_public_function_is_typed_and_documented(name):
    signature = inspect.signature(getattr(api, name))
    assert signature.return_annotation is not inspect.Signature.empty
    assert all(one.annotation is not one.empty for one in signature.parameters.values())
    assert inspect.getdoc(getattr(api, name))
