# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident watch` where it cannot show anything: one line and exit code 2."""

import re
import subprocess
import sys
from types import SimpleNamespace

import pytest

from quad_ident_ros.cli import watch
from quad_ident_ros.cli.main import main


@pytest.fixture
def terminal(monkeypatch):
    """Let the streams that the command looks at be those of a terminal."""
    stream = SimpleNamespace(isatty=lambda: True)
    monkeypatch.setattr(watch, 'sys', SimpleNamespace(stdin=stream, stdout=stream, stderr=stream))


def refusal(capsys, *words):
    """Return the one line that a command is refused with."""
    assert main(['watch', *words]) == 2
    printed = capsys.readouterr()
    assert not printed.out and printed.err.count('\n') == 1
    return printed.err


def test_without_a_terminal(capsys):
    assert re.match('quad_ident watch: error: this is not a terminal: start it in one, ',
                    refusal(capsys))


@pytest.fixture
def without_textual(monkeypatch):
    """Let Textual be missing."""
    for name in [name for name in sys.modules if name.partition('.')[0] == 'textual']:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, 'quad_ident_ros.watch.view', raising=False)
    monkeypatch.setitem(sys.modules, 'textual', None)


@pytest.fixture
def without_ros(monkeypatch):
    """Let ROS 2 be missing."""
    for name in [name for name in sys.modules if name.startswith('quad_ident_ros.nodes')]:
        monkeypatch.delitem(sys.modules, name)
    for name in ('rclpy', 'diagnostic_msgs', 'diagnostic_msgs.msg'):
        monkeypatch.setitem(sys.modules, name, None)


def test_without_textual_it_names_the_extra(capsys, terminal, without_textual):
    assert refusal(capsys).endswith("not installed: pip install 'quad_ident_ros[watch]'\n")


def test_without_ros_it_says_where_to_get_it(capsys, terminal, without_ros):
    pytest.importorskip('textual', reason="Textual is not installed: pip install '.[watch]'")
    assert re.search('error: ROS 2 is not installed .*source ROS 2', refusal(capsys))


def test_without_both_it_names_both_in_one_line(capsys, terminal, without_ros, without_textual):
    said = refusal(capsys)
    assert 'error: ROS 2 is not installed' in said and '[watch]' in said


@pytest.mark.slow
def test_a_hang_up_ends_it_whatever_becomes_of_the_graph():
    """As where it is being left already, after q."""
    code = """
import os, signal, threading
from types import SimpleNamespace
from quad_ident_ros.cli import watch
signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
source = SimpleNamespace(close=lambda: 1 / 0)
threading.Thread(target=watch._end_at_hang_up, args=(source,), daemon=True).start()
os.kill(os.getpid(), signal.SIGHUP)
threading.Event().wait(30.0)
os._exit(3)
"""
    assert subprocess.run([sys.executable, '-c', code], capture_output=True,
                          timeout=120).returncode == 0
