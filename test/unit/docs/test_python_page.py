# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The public Python API: its page, its annotations and the notebook."""

import doctest
import inspect
import json
import re

import pytest

from docs.notebook import NOTEBOOK, page_of, run
from quad_ident_ros import api

PAGE = NOTEBOOK.parents[1] / 'python.md'


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
    assert [name for name in api.__all__ if not re.search(rf'\b{name}\b', text)] == []


@pytest.mark.parametrize('name', [name for name in api.__all__
                                  if inspect.isfunction(getattr(api, name))])
def test_every_public_function_is_typed_and_documented(name):
    signature = inspect.signature(getattr(api, name))
    assert signature.return_annotation is not inspect.Signature.empty
    assert all(one.annotation is not one.empty for one in signature.parameters.values())
    assert inspect.getdoc(getattr(api, name))


@pytest.mark.slow
def test_the_notebook_runs_and_says_what_is_saved_in_it():
    def texts(notebook):
        return [re.sub(r'\d+(\.\d+)?', '#', ''.join(output.get('text', 'picture')))
                for cell in notebook['cells'] for output in cell.get('outputs', ())]
    saved = json.loads(NOTEBOOK.read_text(encoding='utf-8'))
    assert texts(run(saved)) == texts(saved)
    said = page_of(saved)
    outputs = '\n'.join(re.findall(r'^```text\n(.*?)^```', said, re.M | re.S))
    for name, title in ('rotor_drag', 'drag of the rotors'), ('mass_offset', 'error in mass'):
        assert outputs.count(name) == outputs.count(f'{title} ({name})') == 3
    assert said.count('data:image/png') == 2
