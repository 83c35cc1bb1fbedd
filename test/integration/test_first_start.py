# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The first start of a node compiles for a minute or two: it answers all the while."""

import re
import time

from diagnostic_msgs.msg import DiagnosticArray
from graph import DEADLINE, write_experiment
import numpy as np
import pytest
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.qos import latched

SOON = 10.0     # s, of a compilation that takes several times that


def climb(count=300):
    """Return the record of a climb."""
    t = np.arange(count) * 0.01
    zero = np.zeros(count)
    columns = {'pz': 0.5 * t ** 2, 'vz': t, 'u1': 6.4 + zero, 'phi': zero, 'theta': zero,
               'psi': zero, 'u2': zero, 'u3': zero, 'u4': zero}
    return FlightRecord(t, columns, {'start_ns': 10 ** 9, 'trim': [6.3, 0.0, 0.0, 0.0],
                                     'session': 1, 'run_index': 0, 'run_count': 1})


@pytest.mark.parametrize('node', ['identifier', 'diagnoser'])
def test_a_node_is_there_at_once_while_it_compiles(graph, processes, tmp_path, node):
    """It reports its progress, answers, keeps the records that come, and ends when asked."""
    statuses = graph.listen(DiagnosticArray, '/diagnostics', 10)
    service = {'identifier': 'identify', 'diagnoser': 'diagnose'}[node]
    begin = time.monotonic()
    process = processes.start(node, NUMBA_CACHE_DIR=str(tmp_path / 'empty'))
    assert graph.trigger(f'{node}/{service}').message.startswith('there is no record yet')
    assert time.monotonic() - begin < DEADLINE
    publisher = graph.advertise(Float64MultiArray, 'record', latched(16))
    publisher.publish(record_message(climb()))

    def requested():
        asked = time.monotonic()
        response = graph.trigger(f'{node}/{service}')
        assert time.monotonic() - asked < SOON
        return response.success and response.message

    assert 'getting ready' in graph.spin_until(requested, 'the record to be kept')
    graph.spin_until(lambda: 'compiling: ' in process.errors(), 'news of it')
    ready, most = re.search(r'compiling: (\d+) of at most (\d+) functions',
                            process.errors()).groups()
    assert 0 < int(ready) < int(most)
    assert any('getting ready' in status.message for message in statuses
               for status in message.status)
    assert 'ready: ' not in process.errors()
    assert graph.trigger(f'{node}/cancel').success   # the work that waits
    begin = time.monotonic()
    assert process.stop() == 0
    assert time.monotonic() - begin < SOON
    assert 'Traceback' not in process.errors()
    assert not process.output()


def test_a_simulator_says_that_it_compiles_and_stops_when_told(graph, processes, tmp_path):
    path = write_experiment(tmp_path / 'short.yaml', {'psi': (1.0, {'U4': 0.01})})
    process = processes.start('simulator', {'experiment': path, 'wait_for_subscribers': False},
                              NUMBA_CACHE_DIR=str(tmp_path / 'empty'))
    graph.spin_until(lambda: 'compiling: ' in process.errors(), 'news of it')
    assert 'ready: ' in process.errors() and 'flying' not in process.errors()
    begin = time.monotonic()
    assert graph.trigger('simulator/stop').success
    assert process.stop() == 0
    assert time.monotonic() - begin < SOON
    assert 'Traceback' not in process.errors()


def test_what_came_while_a_node_got_ready_is_worked_on_then(graph, processes):
    """With what is kept from earlier starts, this takes some seconds."""
    publisher = graph.advertise(Float64MultiArray, 'record', latched(16), listeners=0)
    publisher.publish(record_message(climb()))
    results = graph.listen(String, 'parameters_json', latched())
    process = processes.start('identifier', {'method': 'vp'})
    graph.spin_until(lambda: results, 'the result', 12 * DEADLINE)
    graph.spin_until(lambda: 'best method' in process.errors(), 'the line of it')
    assert process.errors().index('ready: ') < process.errors().index('best method')
    assert process.stop() == 0
