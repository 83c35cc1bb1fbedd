# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled functions are kept between starts until something changes that they are made of."""

import os
from pathlib import Path
import shutil
import subprocess
import sys

import numba
import pytest

from quad_ident_ros import compiled

INNER = """
from quad_ident_ros.compiled import compiled

@compiled
def inner(x):
    return x * {factor}
"""
OUTER = """
from quad_ident_ros.compiled import compiled
from quad_ident_ros.model.inner import inner

@compiled
def outer(x):
    return inner(x) + 1.0

print(outer(2.0), sum(outer.stats.cache_hits.values()))
"""


@pytest.fixture
def package(tmp_path):
    """Return the folder of a package of the same name with two functions in it."""
    folder = tmp_path / 'quad_ident_ros'
    folder.mkdir()
    (folder / 'model').mkdir()
    for part in (folder, folder / 'model'):
        (part / '__init__.py').write_text('')
    shutil.copy(compiled.__file__, folder)
    (folder / 'model' / 'inner.py').write_text(INNER.format(factor=3.0))
    (folder / 'model' / 'outer.py').write_text(OUTER)
    return folder


def start(package):
    """Return what a start of the package prints: the result, and how often it was kept."""
    variables = {key: value for key, value in os.environ.items() if key != 'NUMBA_CACHE_DIR'}
    command = [sys.executable, '-m', 'quad_ident_ros.model.outer']
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=package.parent,
                          env={**variables, 'PYTHONPATH': str(package.parent)})
    return [float(word) for word in done.stdout.split()]


def test_a_function_is_kept_until_one_that_it_calls_has_changed(package):
    assert start(package) == [7.0, 0]
    assert start(package) == [7.0, 1]
    (package / 'model' / 'inner.py').write_text(INNER.format(factor=50.0))
    assert start(package) == [101.0, 0]
    assert start(package) == [101.0, 1]


def test_a_numba_that_keeps_in_another_way_compiles_at_each_start(monkeypatch):
    class Other:
        def __init__(self, function):
            self.function = function

    def njit(**options):
        return Other if options.get('cache') else lambda function: function

    monkeypatch.setattr(numba, 'njit', njit)
    assert compiled.compiled(abs) is abs


def test_all_compiled_functions_are_in_the_folders_that_count():
    package = Path(compiled.__file__).parent
    users = {path.relative_to(package).parts[0] for path in package.rglob('*.py')
             if 'import compiled' in path.read_text(encoding='utf-8')}
    assert users == set(compiled.FOLDERS)
