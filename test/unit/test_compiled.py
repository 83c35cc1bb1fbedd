# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled functions are kept between starts until something changes that they are made of."""

import os
from pathlib import Path
import shutil
import subprocess
import sys

from full_disk import file_size_limit
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


def start(package, **more):
    """Return what a start of the package prints: the result, and how often it was kept."""
    variables = {key: value for key, value in os.environ.items() if key != 'NUMBA_CACHE_DIR'}
    command = [sys.executable, '-m', 'quad_ident_ros.model.outer']
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=package.parent,
                          env={**variables, 'PYTHONPATH': str(package.parent), **more})
    return [float(word) for word in done.stdout.split()]


@pytest.mark.slow
def test_a_function_is_kept_until_one_that_it_calls_has_changed(package):
    assert start(package) == [7.0, 0]
    assert start(package) == [7.0, 1]
    (package / 'model' / 'inner.py').write_text(INNER.format(factor=50.0))
    assert start(package) == [101.0, 0]
    assert start(package) == [101.0, 1]


@pytest.mark.slow
def test_a_full_disk_keeps_nothing_and_ends_nothing(package, tmp_path):
    """A diagnosis ended with "output: No space left on device", which named no file."""
    for _ in range(2):
        with file_size_limit(64):
            assert start(package) == [7.0, 0]
    assert start(package) == [7.0, 0]
    assert start(package) == [7.0, 1]


@pytest.mark.slow
@pytest.mark.parametrize('whose', ['everybody', 'another', 'link'])
def test_no_code_is_taken_from_a_folder_into_which_others_write(package, tmp_path, whose):
    # Numba keeps code as pickles, which can do anything when they are loaded.
    folder, given = tmp_path / 'kept', tmp_path / 'kept'
    folder.mkdir(mode=0o700)
    assert start(package, NUMBA_CACHE_DIR=str(given)) == [7.0, 0]
    assert start(package, NUMBA_CACHE_DIR=str(given)) == [7.0, 1]
    inside = [folder, *(path for path in folder.rglob('*') if path.is_dir())]
    if whose == 'everybody':
        for place in inside:
            place.chmod(0o777)
    elif os.geteuid() != 0:
        pytest.skip('only root can give a folder to another user')
    else:
        for place in inside:
            os.chown(place, 65534, 65534)
        if whose == 'link':
            given = tmp_path / 'link'
            given.symlink_to(folder)
    assert start(package, NUMBA_CACHE_DIR=str(given)) == [7.0, 0]


def test_a_folder_of_ones_own_is_trusted_and_one_that_is_not_there_is_not(tmp_path):
    (tmp_path / 'own').mkdir(mode=0o700)
    assert compiled.is_trusted(tmp_path / 'own')
    assert not compiled.is_trusted(tmp_path / 'none')


@pytest.mark.skipif(os.geteuid() != 0, reason='only root can give a folder to another group')
def test_a_folder_for_a_group_to_write_to_is_trusted_where_the_group_is_the_users(tmp_path):
    for name, gid, trusted in (('own', os.getegid(), True), ('nobody', 65534, False)):
        (tmp_path / name / 'inside').mkdir(parents=True)
        for path in (tmp_path / name, tmp_path / name / 'inside'):
            os.chown(path, -1, gid)
            path.chmod(0o770)
            compiled.is_trusted.cache_clear()
            assert compiled.is_trusted(tmp_path / name / 'inside') is trusted
            path.chmod(0o750)
        compiled.is_trusted.cache_clear()
        assert compiled.is_trusted(path)


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
