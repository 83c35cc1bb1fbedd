# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the benchmark of the graph counts: it must see what is lost."""

import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from rclpy.serialization import serialize_message

from benchmarks import load
from quad_ident_ros.data.bag import BagWriter
from quad_ident_ros.data.topics import FLIGHT_TOPICS, RunNotice
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.nodes.samples import SampleMessages

RUN = RunNotice(10 ** 9, 10 ** 9 + 99 * 10 ** 7, 100, {})
STAMPS = 10 ** 9 + 10 ** 7 * np.arange(100)


def test_the_stamps_of_a_run_are_even():
    np.testing.assert_array_equal(load.even_stamps(RUN), STAMPS)


def test_samples_that_are_in_no_record_are_counted():
    windows = [STAMPS[:60], STAMPS[40:]]
    assert load.Vehicle(RUN, windows).lacking == 0
    assert load.Vehicle(RUN, [STAMPS[:60], STAMPS[62:]]).lacking == 2
    assert load.Vehicle(RUN, [STAMPS + 1]).lacking == 100


def test_messages_that_were_not_received_are_counted():
    received = dict.fromkeys(FLIGHT_TOPICS, 100)
    assert load.Vehicle(RUN, account={'received': received}).lost == 0
    assert load.Vehicle(RUN, account={'received': {**received, 'pose': 97}}).lost == 3


@pytest.mark.slow
@pytest.mark.parametrize(('missing', 'whole'), [(None, True), (('pose', 50), False),
                                                (('input', 99), False)])
def test_a_bag_is_whole_with_each_message_only(tmp_path, missing, whole):
    messages = SampleMessages()
    names = {name: f'/{name}' for name in FLIGHT_TOPICS}
    with BagWriter(tmp_path / 'bag', [(names[name], topic.type)
                                      for name, topic in FLIGHT_TOPICS.items()]) as bag:
        for k, stamp in enumerate(STAMPS.tolist()):
            messages.fill(stamp, [0.0] * 20)
            for name in FLIGHT_TOPICS:
                if (name, k) != missing:
                    bag.write(names[name], stamp, serialize_message(getattr(messages, name)))
    assert load.is_whole(tmp_path / 'bag', RUN) == whole


@pytest.mark.slow
def test_the_flight_stays_near_hover(tmp_path):
    experiment = load_experiment(load.simulator(tmp_path, 0.01, 60.0)['experiment'])
    record = fly(experiment, experiment.runs[0]).record
    assert np.abs(record.euler()[:, :2]).max() < 0.05 and np.ptp(record.columns['pz']) < 5.0


@pytest.mark.slow
def test_the_time_of_a_process_is_its_cpu_time():
    process = subprocess.Popen(
        [sys.executable, '-c', 'import time\nwhile time.process_time() < 0.3: pass\n'
         'print(flush=True)\ninput()'], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    with process:
        process.stdout.readline()
        found = load.cpu_seconds(SimpleNamespace(processes={'busy': process}))
        process.communicate(b'\n')
    assert 0.3 - 2 / os.sysconf('SC_CLK_TCK') < found['busy'] < 1.0
