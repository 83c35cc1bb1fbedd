# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the script `run` does before Python starts."""

import os
from pathlib import Path
import re
import subprocess

import pytest

RUN = Path(__file__).parents[2] / 'run'


def scratch(tmp_path):
    """Return the folder that `run` takes among the temporary files, and what it says."""
    text = RUN.read_text(encoding='utf-8')
    parts = [re.search(rf'^{name}\(\) {{.*?^}}$', text, re.MULTILINE | re.DOTALL)[0]
             for name in ('fail', 'own_scratch')]
    said = re.search(r'^say\(\) .*$', text, re.MULTILINE)[0]
    done = subprocess.run(['bash', '-euc', '\n'.join([said, *parts, 'own_scratch',
                                                      'echo "$scratch"'])],
                          capture_output=True, text=True, check=True,
                          env={**os.environ, 'TMPDIR': str(tmp_path)})
    return Path(done.stdout.strip()), done.stderr


@pytest.fixture
def usual(tmp_path):
    return tmp_path / f'quad_ident_ros-{os.getuid()}'


def test_the_folder_among_the_temporary_files_is_the_user_s_alone_and_stays(tmp_path, usual):
    for _ in range(2):
        assert scratch(tmp_path) == (usual, '')
        assert usual.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize('kind', ['open', 'link', 'file', 'another'])
def test_one_that_others_made_or_write_to_is_not_taken(tmp_path, usual, kind):
    # It was taken, whoever had made it, and numba's pickles in it were executed.
    if kind == 'open':
        usual.mkdir()
        usual.chmod(0o777)
    elif kind == 'link':
        (tmp_path / 'theirs').mkdir(mode=0o700)
        usual.symlink_to(tmp_path / 'theirs')
    elif kind == 'file':
        usual.touch()
    else:
        if os.geteuid() != 0:
            pytest.skip('only root can give a folder to another user')
        usual.mkdir(mode=0o700)
        os.chown(usual, 65534, 65534)
    for _ in range(2):      # one folder, not a new one with nothing in it at each start
        folder, said = scratch(tmp_path)
        assert folder == usual.with_name(f'{usual.name}-alone') and not said
        assert folder.stat().st_mode & 0o777 == 0o700 and folder.stat().st_uid == os.getuid()


def test_where_both_are_taken_a_new_one_is_made_and_that_is_said(tmp_path, usual):
    for name in (usual.name, f'{usual.name}-alone'):
        (tmp_path / name).touch()
    folder, said = scratch(tmp_path)
    assert folder.is_dir() and folder.parent == tmp_path and 'not for you alone' in said


def mode_on(system, tmp_path):
    """Return the mode of `run` on a machine of which uname says this."""
    (tmp_path / 'uname').write_text(f'#!/bin/sh\necho "{system}"\n')
    (tmp_path / 'uname').chmod(0o755)
    text = RUN.read_text(encoding='utf-8')
    look = re.search(r'^look_around\(\) {.*?^}$', text, re.MULTILINE | re.DOTALL)[0]
    code = ['ros_is_sourced() { false; }', f'root={RUN.parent}', look, 'look_around',
            'echo "$mode"']
    return subprocess.run(['bash', '-euc', '\n'.join(code)], capture_output=True, text=True,
                          check=True, env={'PATH': f'{tmp_path}:{os.environ["PATH"]}'}
                          ).stdout.strip()


@pytest.mark.parametrize('system, mode', [('Linux x86_64', 'wheels'), ('Linux aarch64', 'plain'),
                                          ('Darwin arm64', 'plain'),
                                          ('Darwin x86_64', 'plain')])
def test_ros_comes_along_only_where_pip_has_it(tmp_path, system, mode):
    assert mode_on(system, tmp_path) == mode


def installed_on(system, tmp_path):
    """Return what `run` has pip install on a machine of which uname says this, without ROS 2."""
    (tmp_path / 'uname').write_text(f'#!/bin/sh\necho "{system}"\n')
    (tmp_path / 'uname').chmod(0o755)
    text = RUN.read_text(encoding='utf-8')
    additions = re.search(r'^additions=\(.*?^\)$', text, re.MULTILINE | re.DOTALL)[0]
    choice = re.search(r'^  if \[ "\$mode" = ros \]; then\n    # The message.*?^  fi$', text,
                       re.MULTILINE | re.DOTALL)[0]
    code = ['install_packages() { printf "%s\\n" "$@"; }', f'root={RUN.parent}', 'mode=plain',
            f'venv={tmp_path}', additions, choice]
    return subprocess.run(['bash', '-euc', '\n'.join(code)], capture_output=True, text=True,
                          check=True, env={'PATH': f'{tmp_path}:{os.environ["PATH"]}'}
                          ).stdout.splitlines()


@pytest.mark.parametrize('system', ['Linux aarch64', 'Darwin arm64'])
def test_without_ros_the_pinned_versions_are_installed(tmp_path, system):
    assert installed_on(system, tmp_path) == ['--requirement', f'{tmp_path}/requirements.txt']


def test_macs_of_intel_get_the_last_numba_that_has_wheels_for_them(tmp_path):
    words = installed_on('Darwin x86_64', tmp_path)
    assert {'--prefer-binary', 'numba<0.63', 'pyarrow>=17'} < set(words)
    [limit] = re.findall(r"^ +'(numba<[^']*)',$", (RUN.parent / 'setup.py').read_text('utf-8'),
                         re.MULTILINE)
    assert limit == 'numba<0.63; sys_platform == "darwin" and platform_machine == "x86_64"'


def test_without_ros_its_packages_are_left_out_and_all_others_stay():
    text = RUN.read_text(encoding='utf-8')
    program = re.search(r"awk '(.*?)' \"\$root/requirements.txt\"", text)[1]
    every = (RUN.parent / 'requirements.txt').read_text(encoding='utf-8')
    kept = subprocess.run(['awk', program, RUN.parent / 'requirements.txt'], capture_output=True,
                          text=True, check=True).stdout

    def names(lines):
        return set(re.findall(r'^([a-z][\w-]*)==', lines, re.MULTILINE))
    assert names(kept) == {name for name in names(every) if not name.startswith('ros-')}
    assert {'numpy', 'rosbags'} <= names(kept) < names(every)
    assert len(re.findall('--hash', kept)) > len(names(kept))
