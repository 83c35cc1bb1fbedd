# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The demo: the whole chain as a user starts it."""

import json
from pathlib import Path
import re
import signal
import subprocess
import sys
import time

from geometry_msgs.msg import PoseStamped
from graph import Graph
import numpy as np
import pytest

from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.replay import read_bag
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.identify import identify
from quad_ident_ros.identify.result import parameter_table
from quad_ident_ros.nodes.demo import NOISE
from quad_ident_ros.nodes.recorder import Recorder


@pytest.fixture(scope='module')
def demo(tmp_path_factory):
    """Return the folder of a finished demo and the data that it wrote."""
    folder = tmp_path_factory.mktemp('demo')
    done = subprocess.run([sys.executable, '-m', 'quad_ident_ros', 'demo', '-o', str(folder),
                           '--json', str(folder / 'out.json')],
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert 'PSO-CS' in done.stdout
    return folder / 'run_1', json.loads((folder / 'out.json').read_text())


def test_what_came_over_ros_is_what_the_library_computes(demo):
    _, data = demo
    experiment = load_experiment('hover_single_axis')
    direct = identify([fly(experiment, run, noise=NOISE).record for run in experiment.runs])
    assert data['dropped_samples'] == 0
    assert data['best'] == direct.best
    for name, fit in direct.methods.items():
        outputs = data['methods'][name]['outputs']
        received = np.array([[outputs[output][key] for key in ('K', 'a', 'b')]
                             for output in ('phi', 'theta', 'psi', 'z')], float)
        # Stamps in whole nanoseconds move the sample period by rounding only.
        np.testing.assert_allclose(received, parameter_table(fit), rtol=1e-6, atol=1e-6)


def test_the_recording_holds_the_flights(demo):
    folder, data = demo
    experiment = load_experiment('hover_single_axis')
    from_bag = read_bag(folder / 'recording_1' / 'bag')
    assert len(from_bag) == len(experiment.runs)
    for number, (run, record) in enumerate(zip(experiment.runs, from_bag, strict=True), 1):
        flown = fly(experiment, run, noise=NOISE).record
        from_csv = read_csv(folder / 'recording_1' / f'flight_{number}.csv')
        for name in ('phi', 'theta', 'psi', 'pz', 'u1', 'u2', 'u3', 'u4', 'wx', 'qw'):
            np.testing.assert_array_equal(record.columns[name], flown.columns[name])
            np.testing.assert_array_equal(from_csv.columns[name], flown.columns[name])
        for name in ('vx', 'vy', 'vz'):   # turned into the body and back
            np.testing.assert_allclose(record.columns[name], flown.columns[name], atol=1e-9)
        assert record.info['starts_at_rest']


def test_the_picture_is_there(demo):
    folder, _ = demo
    assert (folder / 'responses.png').read_bytes().startswith(b'\x89PNG')


def _processes_with(text):
    found = []
    for command in Path('/proc').glob('[0-9]*/cmdline'):
        try:
            if text.encode() in command.read_bytes():
                found.append(command)
        except OSError:
            pass    # it ended meanwhile
    return found


def _await(predicate, what, deadline=30.0):
    end = time.monotonic() + deadline
    while not predicate():
        assert time.monotonic() < end, f'after {deadline:g} s still waiting for {what}'
        time.sleep(0.05)


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_no_node_outlives_the_demo(tmp_path, number):
    folder = str(tmp_path / 'here')
    demo = subprocess.Popen([sys.executable, '-m', 'quad_ident_ros', 'demo', '-o', folder,
                             '--real-time-factor', '0.1'], stderr=subprocess.DEVNULL)
    try:
        _await(lambda: (Path(folder) / 'run_1/recording_1/flight_1.csv').exists(), 'the flight')
        demo.send_signal(number)
        assert demo.wait(20) != 0
        _await(lambda: not _processes_with(folder), 'the nodes to end')
    finally:
        demo.kill()
        demo.wait()


def _domain_of(pid):
    """Return the ROS domain of the nodes that a process has started, or None."""
    for place in Path('/proc').glob('[0-9]*'):
        try:
            if f'PPid:\t{pid}\n' not in (place / 'status').read_text():
                continue
            words = dict(entry.split('=', 1) for entry in
                         (place / 'environ').read_text().split('\0') if '=' in entry)
        except OSError:
            continue    # it ended meanwhile
        if words.get('ROS_DOMAIN_ID'):
            return int(words['ROS_DOMAIN_ID'])
    return None


@pytest.mark.parametrize('others', ['recorder', 'vehicle'])
def test_what_others_publish_on_its_domain_ends_the_demo_at_once(tmp_path, others):
    """
    A foreign recorder made it hang for ten minutes: its news were taken for the run's.

    The recorder of the demo took the poses of a foreign vehicle, dropped its own, and said OK.
    """
    demo = subprocess.Popen([sys.executable, '-m', 'quad_ident_ros', 'demo', '-o', str(tmp_path),
                             '--real-time-factor', '0.01'], stderr=subprocess.PIPE, text=True)
    try:
        _await(lambda: (tmp_path / 'run_1/recording_1/flight_1.csv').exists(), 'the flight')
        graph = Graph(_domain_of(demo.pid))
        try:
            if others == 'recorder':
                graph.start(Recorder)
            else:
                # Nobody is waited for: the demo may end before this side sees who listens.
                graph.probe.create_publisher(PoseStamped, 'pose', 10)
            _, errors = demo.communicate(timeout=30)
        finally:
            graph.close()
        assert demo.returncode == 2
        assert re.search(r'^quad_ident demo: error: other nodes publish /\S+, too, on ROS domain '
                         r'\d+', errors.splitlines()[-1])
    finally:
        demo.kill()
        demo.wait()
