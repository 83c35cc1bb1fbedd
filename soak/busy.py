# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""1 kHz while all cores are busy with something else."""

import contextlib
import os
from pathlib import Path
import subprocess
import sys
import tempfile

from benchmarks import load
from quad_ident_ros.nodes.launched import Launched
from soak.rig import Finding, memory_of, Watch

BOUND = 400.0       # MB that a recorder may take: 5 topics of at most 5,000 waiting messages
BACKLOG = 8.0       # s behind the wire: those are 5 s at 1 kHz, and it works on them meanwhile


def run(seconds: float, **_: object) -> list[Finding]:
    """Return a Finding on the account of a flight of at most a minute."""
    seconds = min(seconds, 60.0)
    with tempfile.TemporaryDirectory() as name, Launched(name) as launched, _others():
        launched.start('recorder', {'output': name})
        launched.start('simulator', load.simulator(Path(name), 0.001, seconds)
                       | {'autostart': True})
        most = behind = 0.0
        with launched.watcher('soak') as pair:
            watch = Watch(*pair)
            watch.until(lambda: watch.account.get('joined', 0) > 0, 'the flight', 300.0)
            while watch.account['records'] == 0:
                watch.until(lambda: True, '')
                watch.wait(0.5)
                launched.check()
                most = max(most, memory_of(launched.processes['recorder']))
                if watch.joined:
                    behind = max(behind, (watch.newest - watch.joined) * 1e-9)
            watch.wait(4.0)     # in which the middleware says what it lost
            account = watch.account
    sent = round(1000 * seconds) + 1
    return [Finding('busy', f'{sent} samples at 1 kHz, each core busy with something else',
                    f'{account["joined"]} joined, {account["missing"]} missing in the record, '
                    f'{account["lost"]} messages lost; recorder at most {behind:.1f} s behind the '
                    f'wire and {most:.0f} MB',
                    account['joined'] + account['missing'] == sent and most < BOUND
                    and behind < BACKLOG)]


@contextlib.contextmanager
def _others():
    """Keep each core busy with a process of the same priority."""
    processes = [subprocess.Popen([sys.executable, '-c', 'while True: pass'])
                 for _ in range(os.cpu_count() or 1)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()
