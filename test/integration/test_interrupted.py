# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Processes that are interrupted while they still load their modules."""

import os
from pathlib import Path
import signal
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
NODES = ('simulator', 'recorder', 'identifier', 'diagnoser')
# Interrupts the process in the middle of its imports: just when it asks for a module.
CUSTOM = """
import os
import signal
import sys

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupt())
"""


def interrupted(folder, module, *words):
    """Return what becomes of a process that is interrupted where it imports a module."""
    (folder / 'sitecustomize.py').write_text(CUSTOM.format(module=module))
    return subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, check=False, cwd=folder,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        env={**os.environ, 'PYTHONPATH': os.pathsep.join(map(str, (folder, ROOT))),
             'ROS_LOG_DIR': str(folder)})


@pytest.mark.parametrize('node', NODES)
def test_a_node_that_is_interrupted_while_it_loads_ends_without_a_word(tmp_path, node):
    for words in (['-m', f'quad_ident_ros.nodes.{node}'], [ROOT / 'scripts' / node],
                  ['-m', 'quad_ident_ros', 'node', node]):
        done = interrupted(tmp_path, 'rclpy', *map(str, words))
        assert 'Traceback' not in done.stderr
        assert done.returncode == (130 if 'quad_ident_ros' in words else 0), done.stderr
