# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The commands of docs/simulators, run as they stand on each page: from flights to the model."""

from contextlib import redirect_stdout, suppress
import importlib.util
import os
from pathlib import Path
import re
import signal
import subprocess
import sys

import pytest

from quad_ident_ros.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
PAGES = sorted((ROOT / 'docs' / 'simulators').glob('*.md'))
NEEDS = {'rotorpy': 'rotorpy', 'mujoco': 'mujoco', 'crazyflow': 'drone_models'}
SHARE = r'closes ([\d.]+) % of what the vehicle file closes'
NEAR = 3.0      # points by which the share on a page may differ: other processors round otherwise


def commands(page):
    """Return the indented lines of a page, without their comments."""
    lines = re.findall(r'^    (.*)$', page.read_text(encoding='utf-8'), flags=re.M)
    return '\n'.join(re.sub(r'\s+# .*', '', line) for line in lines)


PYTHON = f'#!/bin/sh\nexec "{sys.executable}"{{}} "$@"\n'
# It calls the command in the process of the tests, which has loaded and compiled everything.
RUN = """#!/bin/sh
printf '%s\\0' "$@" >"{desk}/call"
read -r code <"{desk}/code"
cat "{desk}/said"
exit "$code"
"""


def outcome_of(text, desk, run):
    """Return the exit code of a shell that runs a text here, and what it prints."""
    for name, script in (('run', run), ('python', PYTHON.format(''))):
        Path(name).write_text(script)
        Path(name).chmod(0o755)
    for name in ('call', 'code'):
        os.mkfifo(desk / name)
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get('PYTHONPATH')])])
    with open(desk / 'printed', 'w', encoding='utf-8') as printed:
        shell = subprocess.Popen(
            ['bash', '-euo', 'pipefail', '-c', f'trap \'printf end >"{desk}/call"\' EXIT\n{text}'],
            stdout=printed, env=os.environ | {
                'PATH': f'{Path.cwd()}{os.pathsep}{os.environ["PATH"]}', 'PYTHONPATH': path},
            start_new_session=True)
    try:
        while (words := (desk / 'call').read_text(encoding='utf-8')) != 'end':
            with open(desk / 'said', 'w', encoding='utf-8') as said, redirect_stdout(said):
                code = main(words.split('\0')[:-1])
            (desk / 'code').write_text(f'{code}\n')
        return shell.wait(60), (desk / 'printed').read_text(encoding='utf-8')
    finally:
        with suppress(ProcessLookupError):      # what it started may wait for an answer
            os.killpg(shell.pid, signal.SIGKILL)
        shell.wait()


def test_each_simulator_has_its_page_and_the_overview_leads_to_it():
    text = (ROOT / 'docs' / 'simulators.md').read_text(encoding='utf-8')
    assert {page.stem for page in PAGES} == {
        'gazebo', 'mujoco', 'rotorpy', 'crazyflow', 'gym_pybullet_drones', 'px4_sih', 'isaac'}
    assert all(f'(simulators/{page.name})' in text for page in PAGES)


@pytest.mark.slow
@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.stem)
def test_the_commands_lead_to_the_corrected_model(page, tmp_path, tmp_path_factory, monkeypatch,
                                                  capfd):
    if importlib.util.find_spec(NEEDS.get(page.stem, 'quad_ident_ros')) is None:
        pytest.skip(f'{NEEDS[page.stem]} is not installed')
    if page.stem == 'crazyflow' and sys.version_info < (3, 11):
        pytest.skip('TOML is read from Python 3.11 on')
    (tmp_path / 'docs').symlink_to(ROOT / 'docs')
    monkeypatch.chdir(tmp_path)
    desk = tmp_path_factory.mktemp('desk')
    # What other libraries do to a process, or what variables they need, stays in one of its own.
    run = PYTHON.format(' -m quad_ident_ros') if page.stem in NEEDS else RUN.format(desk=desk)
    code, said = outcome_of(commands(page), desk, run)
    assert code == 0, capfd.readouterr().err[-2000:]
    shares = re.findall(SHARE, said.replace('\n', ' '))
    [stated] = re.findall(r'closes (\d+) %', page.read_text(encoding='utf-8'))
    assert float(shares[-1]) == pytest.approx(float(stated), abs=NEAR)
    written = re.findall(r' -o (\S+)', commands(page))
    assert [name for name in written if '$' not in name and not (tmp_path / name).exists()] == []
