# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compiled functions are kept between starts until something changes that they are made of."""

import os
from pathlib import Path
import shutil
import subprocess
import sys
import time

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


def surroundings(package, **more):
    """Return in which folder and environment Python takes the package in place of the real one."""
    variables = {key: value for key, value in os.environ.items() if key != 'NUMBA_CACHE_DIR'}
    return {'cwd': package.parent,
            'env': {**variables, 'PYTHONPATH': str(package.parent), **more}}


def start(package, **more):
    """Return what a start of the package prints: the result, and how often it was kept."""
    command = [sys.executable, '-m', 'quad_ident_ros.model.outer']
    done = subprocess.run(command, capture_output=True, text=True, check=True,
                          **surroundings(package, **more))
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


IN_BETWEEN = """
import sys
from numba.core.caching import IndexDataCacheFile
from quad_ident_ros.model.inner import inner

save = IndexDataCacheFile._save_index


def save_when_told(self, overloads):
    print('it knows what there is', flush=True)
    sys.stdin.readline()
    save(self, overloads)


if '--when-told' in sys.argv:
    IndexDataCacheFile._save_index = save_when_told
for number in (2, 2.0) if '--both' in sys.argv else (2,) if '--when-told' in sys.argv else (2.0,):
    inner(number)
print(sum(inner.stats.cache_hits.values()))
"""


LOCKS, LONGEST = Path('/proc/locks'), 300.0     # s, on a machine that does something else, too


def waits_for_a_lock(process):
    """Return whether a process waits for a lock on a file, as Linux tells."""
    lines = [line.split() for line in LOCKS.read_text().splitlines()]
    return any('->' in words and str(process.pid) in words for words in lines)


@pytest.fixture
def begin(package):
    """Return a function that starts IN_BETWEEN with arguments; what is left is killed."""
    every = []

    def begin(*words):
        every.append(subprocess.Popen(
            [sys.executable, '-c', IN_BETWEEN, *words], text=True, stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, **surroundings(package)))
        return every[-1]

    yield begin
    for one in every:
        one.kill()
        one.communicate()


@pytest.mark.slow
@pytest.mark.skipif(not LOCKS.exists(), reason='nothing tells here who waits for a lock')
def test_processes_that_compile_at_once_keep_what_each_of_them_compiled(begin):
    """Nodes that start together took the same number for different code, and lost some."""
    first = begin('--when-told')
    assert first.stdout.readline() == 'it knows what there is\n'
    second, until = begin(), time.monotonic() + LONGEST
    while second.poll() is None and not waits_for_a_lock(second):
        assert time.monotonic() < until
        time.sleep(0.02)
    assert [one.communicate('\n')[0] for one in (first, second)] == ['0\n', '0\n']
    assert begin('--both').communicate()[0] == '2\n'


@pytest.mark.slow
def test_code_of_before_goes_also_where_a_number_is_missing(package, begin):
    """As after a kill between index and code: what came after it stayed, under its number."""
    assert begin('--both').communicate()[0] == '0\n'
    first, _ = sorted((package / 'model').rglob('*inner*.nbc'))
    first.unlink()
    (package / 'model' / 'inner.py').write_text(INNER.format(factor=50.0))
    assert begin().communicate()[0] == '0\n'
    assert len([*(package / 'model').rglob('*inner*.nbc')]) == 1


KILLED = """
import os, runpy
from numba.core.caching import IndexDataCacheFile

save = IndexDataCacheFile._save_data
IndexDataCacheFile._save_data = lambda self, name, data: (
    os._exit(1) if 'outer' in name else save(self, name, data))
runpy.run_module('quad_ident_ros.model.outer')
"""


@pytest.mark.slow
def test_a_kill_while_code_is_written_brings_none_of_before_back(package):
    """The index was new and the code that it names old: it was run after that for good."""
    assert start(package) == [7.0, 0]
    (package / 'model' / 'outer.py').write_text(OUTER.replace('+ 1.0', '+ 5.0'))
    killed = subprocess.run([sys.executable, '-c', KILLED], check=False, **surroundings(package))
    assert killed.returncode == 1
    assert start(package) == [11.0, 0]
    assert start(package) == [11.0, 1]


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['nbi', 'nbc'])
def test_what_a_power_cut_leaves_is_compiled_again(package, kind):
    """Every later start ended with a traceback, until someone deleted the files."""
    assert start(package) == [7.0, 0]
    for size in (0, 100):
        cut, = (package / 'model').rglob(f'*outer*.{kind}')
        cut.write_bytes(cut.read_bytes()[:size])
        assert start(package) == [7.0, 0]
        assert start(package) == [7.0, 1]


@pytest.mark.slow
def test_no_code_is_taken_from_a_folder_into_which_others_write(package, tmp_path):
    # Numba keeps code as pickles, which can do anything when they are loaded.
    folder, link = tmp_path / 'kept', tmp_path / 'link'
    folder.mkdir(mode=0o700)
    assert start(package, NUMBA_CACHE_DIR=str(folder)) == [7.0, 0]
    assert start(package, NUMBA_CACHE_DIR=str(folder)) == [7.0, 1]
    inside = [folder, *(path for path in folder.rglob('*') if path.is_dir())]
    for place in inside:
        place.chmod(0o777)
    assert start(package, NUMBA_CACHE_DIR=str(folder)) == [7.0, 0]
    for place in inside:
        place.chmod(0o700)
    assert start(package, NUMBA_CACHE_DIR=str(folder)) == [7.0, 1]
    if os.geteuid() == 0:       # only root can give a folder to another user
        for place in inside:
            os.chown(place, 65534, 65534)
        link.symlink_to(folder)
        for given in (folder, link):
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
