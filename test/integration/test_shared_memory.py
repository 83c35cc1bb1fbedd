# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Shared memory of nodes that were killed is freed by the next start, and no other."""

import fcntl
import json
import os
from pathlib import Path
import time

from geometry_msgs.msg import PointStamped
from graph import flights
import pytest
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.nodes import process, shared_memory
from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.shared_memory import (
    EARLY,
    FOLDER,
    free_abandoned,
    HearingWatch,
    lost_ports,
    PORT,
    SEGMENT,
)
from quad_ident_ros.nodes.simulator import Simulator

LONG_AGO = time.time() - 3600.0


def segments(folder=FOLDER):
    return {path.name for path in folder.iterdir() if SEGMENT.fullmatch(path.name)}


def test_only_what_nobody_holds_is_removed(tmp_path):
    names = [f'fastrtps_{k:016x}' for k in range(3)] + ['fastrtps_port7400', 'other']
    for name in names:
        (tmp_path / name).write_bytes(b'x')
        (tmp_path / f'{name}_el').touch()
        os.utime(tmp_path / f'{name}_el', (LONG_AGO, LONG_AGO))
    os.utime(tmp_path / f'{names[2]}_el')       # just begun
    with open(tmp_path / f'{names[1]}_el') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert free_abandoned(tmp_path) == 1
    assert {path.name for path in tmp_path.iterdir()} == {
        entry for name in names[1:] for entry in (name, f'{name}_el')}
    assert free_abandoned(tmp_path / 'none') == 0


def test_a_node_that_starts_frees_what_a_killed_one_left(graph, processes):
    before = segments()
    process = processes.start('recorder')
    statistics = graph.listen(String, 'recorder/statistics', latched())
    graph.spin_until(lambda: statistics, 'the recorder')
    mine = segments()
    process.kill()
    left = {name for name in segments() - before if name in mine and _is_free(name)}
    assert left
    for name in left:
        os.utime(FOLDER / f'{name}_el', (LONG_AGO, LONG_AGO))
    again = processes.start('recorder')
    count = len(statistics)
    graph.spin_until(lambda: len(statistics) > count, 'the next one')
    assert not left & segments()
    assert again.stop() == 0


def test_a_node_that_begins_deaf_starts_once_more_and_hears(graph, processes):
    """Another process deletes what it listens on by its name, as FastDDS does after a kill -9."""
    process = processes.start('recorder', {'topics': ['altitude'], 'window_samples': 2})
    statistics = graph.listen(String, 'recorder/statistics', latched())
    graph.spin_until(lambda: statistics, 'the recorder')
    proc = Path('/proc', str(process.pid))
    assert lost_ports(proc) == lost_ports() == []
    ports = ports_of(proc)
    assert ports
    ports[0].unlink()
    assert lost_ports(proc) == [str(ports[0])]
    ports[0].write_bytes(b'of another process')
    assert lost_ports(proc) == [str(ports[0])]
    graph.spin_until(lambda: process.errors().count('ready: ') == 2, 'the next start')
    assert process.errors().count('deleted by another process') == 1
    assert str(ports[0]) in process.errors() and 'this node starts again' in process.errors()
    assert Path('/proc', str(process.pid)).exists() and lost_ports(proc) == []
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    altitude = graph.advertise(PointStamped, 'altitude')
    send_altitudes(altitude, (1, 2))
    graph.spin_until(lambda: records, 'a record of what it hears')
    assert process.stop() == 0
    ports[0].unlink(missing_ok=True)


def test_a_node_that_starts_once_more_keeps_parameters_that_were_set(graph, processes):
    process = processes.start('simulator', {'autostart': False, 'seed': 1, 'noise.rate': 0.5,
                                            'effects': ['wind:x=3.0']})
    graph.spin_until(lambda: 'ready: ' in process.errors(), 'the simulator')
    wanted = {'seed': 7, 'vehicle': 'crazyflie', 'effects': []}
    for name, value in wanted.items():
        assert graph.set_parameter('simulator', name, value).successful
    ports = ports_of(Path('/proc', str(process.pid)))
    ports[0].unlink()
    graph.spin_until(lambda: process.errors().count('ready: ') == 2, 'the next start')
    values = graph.call(GetParameters, 'simulator/get_parameters',
                        GetParameters.Request(names=[*wanted, 'noise.rate'])).values
    assert [*map(parameter_value_to_python, values)] == [*wanted.values(), 0.5]
    assert process.stop() == 0
    ports[0].unlink(missing_ok=True)


@pytest.mark.parametrize('node_class', [Identifier, Diagnoser])
def test_a_node_that_has_a_record_is_busy(graph, node_class):
    """It does not start once more by itself, or the record were lost, whatever became of it."""
    node = graph.start(node_class)
    publisher = graph.advertise(Float64MultiArray, 'record', latched(16))
    assert not node.busy
    publisher.publish(record_message(flights()[0]))     # of several: it is not worked on yet
    graph.spin_until(lambda: node.busy, 'the record')


def test_a_simulator_that_waits_to_fly_by_itself_is_not_busy_and_one_that_flies_is(graph):
    """A new start flies what autostart flies, but not what somebody asked for."""
    node = graph.start(Simulator, {'autostart': True})
    assert not node.busy
    graph.stop(node)
    node = graph.start(Simulator, {'autostart': False})
    assert not node.busy
    assert graph.trigger('simulator/start').success
    assert node.busy


def test_a_node_that_becomes_deaf_at_work_keeps_what_it_has(graph, processes):
    """It still hears those who began before: a new start would lose their flight."""
    process = processes.start('recorder', {'topics': ['altitude'], 'window_samples': 4})
    records = graph.listen(Float64MultiArray, 'record', latched(16))
    statistics = graph.listen(String, 'recorder/statistics', latched())
    altitude = graph.advertise(PointStamped, 'altitude')
    graph.spin_until(lambda: statistics, 'the recorder')
    send_altitudes(altitude, (1, 2))
    graph.spin_until(lambda: json.loads(statistics[-1].data)['joined'] == 2, 'two rows')
    ports = ports_of(Path('/proc', str(process.pid)))
    ports[0].unlink()
    graph.spin_until(lambda: 'deleted by another process' in process.errors(), 'what it says')
    assert 'start this node again' in process.errors()
    send_altitudes(altitude, (3, 4))
    graph.spin_until(lambda: records, 'a record of all four')
    assert process.errors().count('ready: ') == 1
    assert process.stop() == 0


def send_altitudes(publisher, hundredths):
    """Publish altitudes at hundredths of a second."""
    for count in hundredths:
        message = PointStamped()
        message.header.stamp.nanosec = count * 10 ** 7
        publisher.publish(message)


@pytest.mark.parametrize('said', ['x', '[1]', '{"seed": {}}', '{"seed": -1}', '{"none": 1}'])
def test_parameters_of_somebody_else_change_nothing(graph, monkeypatch, said):
    node = graph.start(Simulator, {'autostart': False, 'seed': 5})
    before = node.values()
    monkeypatch.setenv(process.CHANGED, said)
    process._change(node)
    assert node.values() == before and process.CHANGED not in os.environ


@pytest.mark.parametrize(('said', 'starts'), [('x', 0), ('', 0), ('2', 2)])
def test_a_count_of_starts_that_is_none_is_zero(monkeypatch, said, starts):
    monkeypatch.setenv(process.STARTS, said)
    assert process._starts() == starts


def ports_of(proc):
    """Return the files that a process (its folder in /proc) listens on."""
    held = {Path(os.readlink(fd)).name.removesuffix('_el') for fd in (proc / 'fd').iterdir()
            if os.path.islink(fd)}
    return sorted(FOLDER / name for name in held if PORT.fullmatch(name))


@pytest.mark.parametrize(('seconds', 'may', 'anew', 'words'), [
    (2.0, True, True, '; this node starts again'),
    (2.0, False, False, '; start this node again'),     # it has, or works
    (EARLY + 10.0, True, False, '; start this node again')])
def test_a_node_that_has_become_deaf_says_so_once(monkeypatch, seconds, may, anew, words):
    now, lost, said = [100.0], [], []
    monkeypatch.setattr(shared_memory.time, 'monotonic', lambda: now[0])
    monkeypatch.setattr(shared_memory, 'lost_ports', lambda: list(lost))
    watch = HearingWatch(said.append, lambda: may)
    for _ in range(round(seconds)):
        now[0] += 1.0
        assert not watch.look() and not said
    lost.append('/dev/shm/fastrtps_port7411')
    results = []
    for _ in range(20):
        now[0] += 1.0
        results.append(watch.look())
    assert results.count(True) == anew
    [line] = said
    assert line.endswith(words) and 'fastrtps_port7411, on which this node listens' in line


def _is_free(name):
    """Return whether the process of a segment is gone."""
    with open(FOLDER / f'{name}_el') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
    return True
