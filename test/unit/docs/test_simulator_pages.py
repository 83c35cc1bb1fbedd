# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The commands of docs/simulators, run as they stand on each page: from flights to the model."""

import importlib.util
import os
from pathlib import Path
import re
import stat
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[3]
PAGES = sorted((ROOT / 'docs' / 'simulators').glob('*.md'))
NEEDS = {'rotorpy': 'rotorpy', 'mujoco': 'mujoco', 'crazyflow': 'drone_models'}
SHARE = r'closes ([\d.]+) % of what the vehicle file closes'
NEAR = 3.0      # points by which the share on a page may differ: other processors round otherwise


def commands(page):
    """Return the indented lines of a page, without their comments."""
    lines = re.findall(r'^    (.*)$', page.read_text(encoding='utf-8'), flags=re.M)
    return '\n'.join(re.sub(r'\s+# .*', '', line) for line in lines)


def test_each_simulator_has_its_page_and_the_overview_leads_to_it():
    text = (ROOT / 'docs' / 'simulators.md').read_text(encoding='utf-8')
    assert {page.stem for page in PAGES} == {
        'gazebo', 'mujoco', 'rotorpy', 'crazyflow', 'gym_pybullet_drones', 'px4_sih', 'isaac'}
    assert all(f'(simulators/{page.name})' in text for page in PAGES)


@pytest.mark.slow
@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.stem)
def test_the_commands_lead_to_the_corrected_model(page, tmp_path):
    if importlib.util.find_spec(NEEDS.get(page.stem, 'quad_ident_ros')) is None:
        pytest.skip(f'{NEEDS[page.stem]} is not installed')
    if page.stem == 'crazyflow' and sys.version_info < (3, 11):
        pytest.skip('TOML is read from Python 3.11 on')
    (tmp_path / 'docs').symlink_to(ROOT / 'docs')
    for name, call in (('run', ' -m quad_ident_ros'), ('python', '')):
        script = tmp_path / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}"{call} "$@"\n')
        script.chmod(script.stat().st_mode | stat.S_IXUSR)
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get('PYTHONPATH')])])
    done = subprocess.run(['bash', '-euo', 'pipefail', '-c', commands(page)], cwd=tmp_path,
                          capture_output=True, text=True, timeout=1200, env=os.environ | {
                              'PATH': f'{tmp_path}{os.pathsep}{os.environ["PATH"]}',
                              'PYTHONPATH': path})
    assert done.returncode == 0, done.stderr[-2000:]
    shares = re.findall(SHARE, done.stdout.replace('\n', ' '))
    [stated] = re.findall(r'closes (\d+) %', page.read_text(encoding='utf-8'))
    assert float(shares[-1]) == pytest.approx(float(stated), abs=NEAR)
    written = re.findall(r' -o (\S+)', commands(page))
    assert [name for name in written if '$' not in name and not (tmp_path / name).exists()] == []
