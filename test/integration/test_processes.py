# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The nodes as processes: options, refused parameters, signals, starting again."""

import os
import signal
import socket
import subprocess
import sys
import time

from graph import DEADLINE, ENDLESS, flights, Graph, write_experiment
import pytest
from std_msgs.msg import Float64MultiArray, String
import yaml

from quad_ident_ros.nodes import diagnoser, identifier, recorder, simulator
from quad_ident_ros.nodes.domain import claim_domain
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.process import PARENT
from quad_ident_ros.nodes.qos import latched

NODES = {'simulator': simulator, 'recorder': recorder, 'identifier': identifier,
         'diagnoser': diagnoser}

# What is said, by node and parameters; all others are in test_bad_parameters.py, in one process.
REFUSED = {
    'simulator': ({'expriment': 'small_angle'},
                  "'expriment' is not known here; did you mean 'experiment'"),
    'recorder': ({'windows': [f'{"x" * 300}=3']}, 'topic length should not exceed'),
    'identifier': ({'seed': 1.5}, 'parameter seed: expected a whole number from 0 to'),
    'diagnoser': ({'vehicle': 'hummingbrd'}, "'hummingbrd' is not among the vehicles"),
}


def check_refusal(process, node, said):
    assert process.wait() == 2, (said, process.errors())
    [line] = process.errors().splitlines()
    assert line.startswith(f'{node}: error: '), line
    assert said in line
    assert process.output() == ''


def test_bad_parameters_are_refused_in_one_line(processes):
    cases = [(processes.start(node, parameters), node, said)
             for node, (parameters, said) in REFUSED.items()]
    for case in cases:
        check_refusal(*case)


WORDS = [
    (['--method', 'ls'], "'--method' is not an option here: parameters are given as --ros-args"),
    (['--ros-args', '-p', 'method'], 'the ROS arguments cannot be used'),
    (['--ros-args', '--params-file', '/nowhere.yaml'], '/nowhere.yaml: there is no such file'),
    (['--ros-args', '--params-file', '/proc/self/environ'], '/proc/self/environ: the file is '),
]


def test_bad_words_are_refused_in_one_line(processes):
    cases = [(processes.run('identifier', *words), 'identifier', said) for words, said in WORDS]
    for case in cases:
        check_refusal(*case)


def test_a_parameter_file_for_others_is_refused(processes, tmp_path):
    path = tmp_path / 'parameters.yaml'
    path.write_text(yaml.safe_dump({'identifer': {'ros__parameters': {'method': 'ls'}}}))
    process = processes.start('identifier', arguments=['--params-file', str(path)])
    check_refusal(process, 'identifier', f'{path}: nothing in it is for this node, /identifier; '
                                         'it is for /identifer')


def test_a_parameter_file_is_used(graph, processes, tmp_path):
    """By the name of the node in its namespace, and by one with a wildcard."""
    heard, started = [], []
    for space, key in (('quad', '/quad/identifier'), ('other', '/**/identifier')):
        path = tmp_path / f'{space}.yaml'
        path.write_text(yaml.safe_dump({key: {'ros__parameters': {
            'method': 'pso', 'seed': 4, 'pole_bounds': [-1.0, 12.0]}}}))
        heard.append(graph.listen(String, f'/{space}/parameters_json', latched()))
        started.append(processes.start('identifier', arguments=[
            '--params-file', str(path), '-r', f'__ns:=/{space}']))
    for space in ('quad', 'other'):
        publisher = graph.advertise(Float64MultiArray, f'/{space}/record', latched(16))
        for record in flights():
            publisher.publish(record_message(record))
    graph.spin_until(lambda: all(heard), 'the results')
    for json in heard:
        settings = json.data()[0]['settings']
        assert (settings['methods'], settings['seed']) == (['pso'], 4)
        assert settings['bounds']['psi']['poles'] == [-1.0, 12.0]
    assert [process.stop() for process in started] == [0, 0]


def test_help_names_every_parameter(processes):
    options = {'simulator': '--help', 'recorder': '-h', 'identifier': '--help', 'diagnoser': '-h'}
    for process in [processes.run(node, option) for node, option in options.items()]:
        assert process.wait() == 0
        assert process.errors() == ''
        text, node = process.output(), process.node
        assert text.startswith(f'{node}: ') and f'ros2 run quad_ident_ros {node}' in text
        for spec in NODES[node].SPECS:
            assert f'\n  {spec.name} (default ' in text and spec.description in text


def await_nodes(graph, names):
    graph.spin_until(lambda: set(names) <= set(graph.probe.get_node_names()), f'nodes {names}')


def check_end(started, number):
    """Send a signal to all nodes and check that each ends soon, well and without a word."""
    sent = time.monotonic()
    for process in started.values():
        process.send(number)
    for node, process in started.items():
        assert process.wait() == 0, f'{node}: {process.errors()}'
        assert 'Traceback' not in process.errors() and 'RCLError' not in process.errors()
    assert time.monotonic() - sent < 10.0


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_signals_end_the_nodes_soon_and_well(graph, processes, tmp_path, number):
    """While they are at it: a flight, its recording, and a fit that does not end."""
    path = write_experiment(tmp_path / 'yaw.yaml', {'psi': (60.0, {'U4': 0.01})})
    progress = graph.listen(String, 'identifier/progress', 10)
    statistics = graph.listen(String, 'recorder/statistics', latched())
    publisher = graph.advertise(Float64MultiArray, 'fit', latched(16), listeners=0)
    for record in flights():
        publisher.publish(record_message(record))
    started = {
        'identifier': processes.start('identifier', ENDLESS, ['-r', 'record:=fit']),
        'recorder': processes.start('recorder', {'output': str(tmp_path)}),
        'simulator': processes.start('simulator', {'experiment': path})}
    graph.spin_until(lambda: progress and statistics and statistics.data()[-1]['joined'],
                     'flight and fit')
    check_end(started, number)


def test_each_node_says_once_when_it_is_ready(graph, processes):
    """With the parameter file that ships, which fits all of them."""
    said = {'simulator': 'ready: flies small_angle on ~/start',
            'recorder': 'ready: joins attitude, altitude, pose, twist, input; in memory only',
            'identifier': 'ready: fitting what comes on /record, mode once',
            'diagnoser': 'ready: diagnosing what comes on /record, mode once'}
    given = {'simulator': ['-p', 'experiment:=small_angle', '-p', 'autostart:=false']}
    path = os.path.join(os.path.dirname(__file__), '../../config/parameters.yaml')
    started = [processes.start(node, arguments=['--params-file', path, *given.get(node, [])])
               for node in said]
    for process, text in zip(started, said.values(), strict=True):
        graph.spin_until(lambda p=process: 'ready' in p.errors() or not p.running(),
                         f'{process.node} to be ready', 4 * DEADLINE)
        [line] = [line for line in process.errors().splitlines() if 'ready' in line]
        assert text in line
    assert [process.stop() for process in started] == [0] * 4


def test_a_signal_right_after_the_start_ends_the_nodes(graph, processes):
    started = {node: processes.start(node) for node in NODES}
    await_nodes(graph, NODES)
    check_end(started, signal.SIGTERM)


def test_a_killed_identifier_starts_again_and_gets_the_records(graph, processes):
    json = graph.listen(String, 'parameters_json', latched())
    publisher = graph.advertise(Float64MultiArray, 'record', latched(16), listeners=0)
    for record in flights():
        publisher.publish(record_message(record))
    first = processes.start('identifier', {'method': 'ls'})
    graph.spin_until(lambda: len(json) == 1, 'the result')
    first.kill()
    processes.start('identifier', {'method': 'pso'})
    graph.spin_until(lambda: len(json) == 2, 'the result of the second')
    assert [list(data['methods']) for data in json.data()] == [['ls'], ['pso']]


def test_a_killed_simulator_starts_again(graph, processes, tmp_path):
    """The cut flight becomes a record of its own; the experiment that follows is fitted."""
    runs = {'psi': (8.0, {'U4': 0.05}), 'z': (2.0, {'U1': 1.0})}
    path = write_experiment(tmp_path / 'two.yaml', runs)
    # Of any length: it is not over when it is known that it flies.
    endless = write_experiment(tmp_path / 'long.yaml', {**runs, 'psi': (600.0, {'U4': 0.001})})
    json, _, records = graph.results()
    statistics = graph.listen(String, 'recorder/statistics', latched())
    processes.start('recorder')
    processes.start('identifier', {'method': 'ls'})
    first = processes.start('simulator', {'experiment': endless})
    graph.spin_until(lambda: statistics and statistics.data()[-1]['joined'] >= 50, 'a flight')
    first.kill()
    processes.start('simulator', {'experiment': path, 'real_time_factor': 0.0})
    graph.spin_until(lambda: json and len(records) == 3, 'records and result', 2 * DEADLINE)
    cut, *whole = records.records()
    assert 50 <= len(cut) and cut.info['dropped'] == 60001 - len(cut)
    assert [len(record) for record in whole] == [801, 201]
    data = json.data()[0]
    assert len({info['session'] for info in data['records']}) == 1
    assert data['dropped_samples'] == 0
    assert data['methods']['ls']['outputs']['z']['K'] == pytest.approx(1 / 0.65, rel=1e-3)


def test_a_process_without_a_home_runs(graph, processes):
    """No HOME and no ROS_LOG_DIR, as in a container or a service."""
    for name in ('ROS_LOG_DIR', 'ROS_HOME', 'HOME'):
        processes.environment.pop(name, None)
    process = processes.start('recorder')
    await_nodes(graph, ['recorder'])
    assert process.stop() == 0, process.errors()


def test_a_node_ends_with_the_process_that_it_belongs_to(graph, processes):
    """So that none is left where a demo or a test is killed."""
    keeper = subprocess.Popen(['sleep', '60'])
    process = processes.start('recorder', **{PARENT: str(keeper.pid)})
    keeper.kill()
    keeper.wait()
    assert process.wait() == 0


# A middleware that does not let go, and holds the interpreter as rclpy does while it is asked to.
STUCK = """
import ctypes, sys
from quad_ident_ros.nodes.node import PackageNode
from quad_ident_ros.nodes.process import run

class Stuck(PackageNode):
    def __init__(self):
        super().__init__('stuck')

    def ready(self):
        print('up', flush=True)
        return 'stuck'

    def close(self):
        print('closed', flush=True)

    def destroy_node(self):
        ctypes.PyDLL(None).sleep(600)

sys.exit(run(Stuck, '', ['--ros-args']))
"""


def test_a_node_that_the_middleware_holds_ends_all_the_same(processes):
    with subprocess.Popen([sys.executable, '-c', STUCK], stdout=subprocess.PIPE, text=True,
                          env=processes.environment) as process:
        assert process.stdout.readline() == 'up\n'
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == 'closed\n'
        assert process.wait(DEADLINE) == 0


def test_a_node_that_fails_and_is_held_does_not_end_well(processes):
    failing = STUCK.replace("        print('up', flush=True)", '        raise ValueError')
    with subprocess.Popen([sys.executable, '-c', failing], stdout=subprocess.PIPE, text=True,
                          env=processes.environment) as process:
        assert process.wait(DEADLINE) == 1


def test_a_domain_on_which_somebody_else_has_a_node_is_not_free(claim):
    number, holder = claim_domain()
    holder.close()
    graph = Graph(number)   # of whoever knows nothing of our claims
    try:
        other, holder = claim_domain()
        holder.close()
    finally:
        graph.close()
    assert other != number


def test_a_domain_whose_multicast_somebody_hears_is_not_free():
    number, holder = claim_domain()
    holder.close()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as foreign:
        foreign.bind(('', 7400 + 250 * number))
        other, holder = claim_domain()
        holder.close()
    assert other != number


def test_a_domain_is_taken_as_long_as_a_node_lives_on_it():
    """Even where whoever started the node was killed."""
    number, holder = claim_domain()
    child = subprocess.Popen(['sleep', '60'], pass_fds=[holder.fileno()])
    try:
        holder.close()
        other, second = claim_domain()
        second.close()
        assert other != number
        assert 1 <= number <= 100 and 1 <= other <= 100
    finally:
        child.kill()
        child.wait()
