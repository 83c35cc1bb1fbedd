# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The live view with the real nodes, and as a program in a terminal."""

import contextlib
import json
import os
import pty
import re
import select
import signal
import sys
import time

from diagnostic_msgs.msg import DiagnosticArray
from graph import DEADLINE, flights
from published import diagnosis, published
import pytest
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.change import Change
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.outlets import RECORD
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.stamped import change_message
from quad_ident_ros.nodes.watching import Watching
from quad_ident_ros.report.verdict import verdict_line

COLOUR = re.compile(rb'\x1b\[[0-9;]*\b(3[0-7]|4[0-7]|38|48|9[0-7])[;m]')


@contextlib.contextmanager
def watched(graph, domain, namespace=''):
    """Give a Watching and a function that spins the graph until its state is as wanted."""
    with Watching(namespace, domain) as watching:
        yield watching, lambda wanted, what: graph.spin_until(lambda: wanted(watching.state), what)


def test_what_the_nodes_publish_is_in_the_state(graph, domain):
    with watched(graph, domain, 'uav1') as (watching, until):
        assert watching.namespace == '/uav1'
        graph.start(Recorder, namespace='/uav1')
        graph.start(Identifier, {'method': 'ls'}, namespace='/uav1')
        until(lambda state: set(state.health) == {'recorder', 'identifier'} and state.recording,
              'both nodes')
        assert {stream.received for stream in watching.state.recording.streams} == {0}
        record = graph.advertise(Float64MultiArray, f'/uav1/{RECORD}', latched(16))
        for flight in flights():
            record.publish(record_message(flight))
        fit = until(lambda state: state.fit, 'the fit')
        assert fit.method == 'ls'
        (z,) = (model for model in fit.models if model.output == 'z')
        assert z.values[0] == pytest.approx(1 / 0.65, rel=1e-3)    # 1 / mass


def test_a_key_shows_what_the_service_said(graph, domain):
    with watched(graph, domain) as (watching, until):
        watching.request('flush')
        (event,) = until(lambda state: state.history, 'the refusal')
        assert event.about == 'flush'
        assert 'there is no recorder to ask; start it: quad_ident node recorder' in event.text
        graph.start(Recorder)
        graph.spin_until(watching._clients['flush'].service_is_ready, 'the service')

        def answered():
            watching.request('flush')
            return any('fewer than two samples' in event.text for event in watching.state.history)

        graph.spin_until(answered, 'an answer')


def test_verdicts_and_changes_that_came_before_are_shown_too(graph, domain):
    node = graph.probe
    found = diagnosis()
    latched_json = node.create_publisher(String, 'diagnosis', latched())
    latched_json.publish(String(data=json.dumps(published(found))))
    changes = node.create_publisher(DiagnosticArray, 'change', latched(10))
    changes.publish(change_message(Change('phi', 3.2, 90.0, {'K': (4.35, 3.3)}, 63_200_000_000),
                                   node))
    with watched(graph, domain) as (watching, until):
        until(lambda state: len(state.history) == 2, 'both')
        assert {(event.time, event.about, event.text) for event in watching.state.history} == {
            ('12.34 s', 'verdict', verdict_line(found)),
            ('63.20 s', 'change', 'phi changed: K 4.35 -> 3.3')}


def test_a_namespace_that_is_none_is_refused():
    with pytest.raises(InputError, match="--namespace '1 2': expected letters"):
        Watching('1 2')


class Terminal:
    """The program in a pseudo-terminal of 80 x 24."""

    def __init__(self, environment, *words):
        self.pid, self._fd = pty.fork()
        if self.pid == 0:
            os.execve(sys.executable, [sys.executable, '-m', 'quad_ident_ros', 'watch', *words],
                      {**environment, 'TERM': 'xterm-256color', 'COLUMNS': '80', 'LINES': '24'})
        self.output = b''

    def read_until(self, text):
        end = time.monotonic() + DEADLINE
        while text not in self.output:
            assert time.monotonic() < end, self.output
            self._read()

    def write(self, keys):
        os.write(self._fd, keys)

    def hang_up(self):
        """Close the terminal, as a connection that drops does, and return the exit code."""
        os.close(self._fd)
        end = os.pidfd_open(self.pid)
        ended, *_ = select.select([end], [], [], DEADLINE)
        os.close(end)
        if not ended:
            os.kill(self.pid, signal.SIGKILL)
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])

    def wait(self):
        """Return the exit code."""
        end = time.monotonic() + DEADLINE
        while time.monotonic() < end:
            self._read()
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                return os.waitstatus_to_exitcode(status)
        os.kill(self.pid, signal.SIGKILL)
        os.waitpid(self.pid, 0)
        pytest.fail(f'it did not end: {self.output!r}')

    def _read(self):
        if select.select([self._fd], [], [], 0.1)[0]:
            with contextlib.suppress(OSError):   # the other side is closed
                self.output += os.read(self._fd, 65536)


@pytest.mark.parametrize('end', ['q', 'ctrl-c', 'SIGTERM'])
def test_it_leaves_the_terminal_as_it_was(processes, end):
    pytest.importorskip('textual', reason="Textual is not installed: pip install '.[watch]'")
    terminal = Terminal({**processes.environment, 'NO_COLOR': '1'})
    terminal.read_until(b'quad_ident node recorder')
    if end == 'SIGTERM':
        os.kill(terminal.pid, signal.SIGTERM)
    else:
        terminal.write(b'q' if end == 'q' else b'\x03')
    assert terminal.wait() == 0
    assert b'\x1b[?1049l' in terminal.output and b'\x1b[?25h' in terminal.output
    assert b'Traceback' not in terminal.output
    assert not COLOUR.search(terminal.output)   # NO_COLOR


def test_it_ends_with_the_connection(processes):
    pytest.importorskip('textual', reason="Textual is not installed: pip install '.[watch]'")
    terminal = Terminal(processes.environment)
    terminal.read_until(b'quad_ident node recorder')
    assert terminal.hang_up() == 0
