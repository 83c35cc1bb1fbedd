# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""All nodes in continuous mode for a long time: memory, latency, account."""

import json
from pathlib import Path
import tempfile
import time

import numpy as np

from quad_ident_ros.nodes.launched import Launched
from soak.rig import Finding, memory_of, Watch

GROWTH = 0.05       # of memory, from the second quarter of the time to the last
SLOWER = 1.5        # times the latency of the second quarter, or
SLACK = 0.1         # s more than it: a machine has other things to do
EXPERIMENT = """\
name: hours
model: closed_loop
vehicle: paper_quadrotor
period: 0.01
noise: {{position: 0.002, velocity: 0.01, attitude: 0.002, rate: 0.005}}
runs:
  - {{name: vertical, duration: {seconds}, trajectory: vertical, outputs: [z]}}
"""


def run(seconds: float, **_: object) -> list[Finding]:
    """Return Findings on memory, latency and samples of a flight of so many seconds."""
    with tempfile.TemporaryDirectory() as name, Launched(name) as launched:
        path = Path(name) / 'hours.yaml'
        path.write_text(EXPERIMENT.format(seconds=seconds), encoding='utf-8')
        launched.start('recorder', {'output': name, 'window_seconds': 5.0, 'overlap': 0.99,
                                    'windows': ['record_long=20,0.5']})
        launched.start('identifier', {'mode': 'continuous', 'method': 'vp',
                                      'trim': [6.374, 0.0, 0.0, 0.0]})
        launched.start('diagnoser', {'mode': 'continuous', 'vehicle': 'paper_quadrotor'},
                       arguments=['-r', 'record:=record_long'])
        with launched.watcher('soak') as pair:
            watch = Watch(*pair)
            watch.until(lambda: {'identifier', 'diagnoser'} <= watch.heard.keys() and watch.account
                        and watch.node.count_publishers('change'), 'the nodes', 300.0)
            launched.start('simulator', {'experiment': str(path)})
            watch.until(lambda: watch.account['joined'] > 0, 'the flight', 300.0)
            begin, memory = time.monotonic(), []
            while time.monotonic() - begin < seconds - 1.0:
                watch.wait(min(2.0, seconds / 40))
                launched.check()
                memory.append([memory_of(process) for process in launched.processes.values()])
            watch.until(lambda: watch.account['joined'] + watch.account['missing']
                        >= round(100 * seconds) + 1 or watch.account['run'] is None, 'the end')
            watch.wait(2.0)
            account, names = watch.account, list(launched.processes)
            results = watch.results
    done = f'{seconds:g} s at 100 Hz, all nodes, 20 windows per second'
    return [*_memory(done, names, np.array(memory)), _latency(done, results),
            _samples(done, account, round(100 * seconds) + 1)]


def _quarters(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the second and the last quarter of what was measured in the course of time."""
    count = len(values)
    return values[count // 4:count // 2], values[3 * count // 4:]


def _memory(done: str, names: list[str], memory: np.ndarray) -> list[Finding]:
    before, after = (np.median(part, axis=0) for part in _quarters(memory))
    return [Finding('hours: memory', done, f'{name}: {one:.0f} MB, then {two:.0f} MB',
                    two <= (1 + GROWTH) * one)
            for name, one, two in zip(names, before, after, strict=True)]


def _latency(done: str, results: list) -> Finding:
    delays = []
    for came, text in results:
        data = json.loads(text)
        if 'z' in data['samples']:
            delays.append(came - data['records'][0]['start_ns'] * 1e-9
                          - (data['samples']['z'] - 1) * data['period']['z'])
    before, after = (float(np.median(part)) for part in _quarters(np.array(delays)))
    return Finding('hours: latency', done, f'{len(delays)} results; from the newest sample to its '
                   f'result {1e3 * before:.0f} ms, then {1e3 * after:.0f} ms',
                   after <= max(SLOWER * before, before + SLACK))


def _samples(done: str, account: dict, sent: int) -> Finding:
    return Finding('hours: account', done, f'{sent} samples sent, {account["joined"]} joined, '
                   f'{account["missing"]} missing', account['joined'] + account['missing'] == sent)
