# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The nodes as processes, and a node that watches what they say."""

from collections.abc import Callable
from dataclasses import dataclass
import json
from pathlib import Path
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped
from std_msgs.msg import String

from quad_ident_ros.data.topics import stamp_ns
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.qos import latched, STREAM

PATIENCE = 120.0    # s after which something is wrong


@dataclass(frozen=True)
class Finding:
    """One line of the table: what was done, what came of it, and whether it held."""

    case: str
    done: str
    result: str
    held: bool


class Watch:
    """Hears the account of the recorder, the newest stamp on the wire and who lives."""

    def __init__(self, node: Any, executor: Any) -> None:
        self.node, self._executor = node, executor
        self.account: dict = {}
        self.newest = 0
        self.heard: dict[str, float] = {}
        self.results: list = []
        node.create_subscription(String, 'recorder/statistics', self._on_account, latched())
        node.create_subscription(PointStamped, 'altitude', self._on_sample, STREAM)
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_status, 10)
        node.create_subscription(String, 'parameters_json', self._on_result, latched())

    def _on_account(self, message: String) -> None:
        self.account = json.loads(message.data)

    def _on_sample(self, message: PointStamped) -> None:
        self.newest = stamp_ns(message)
        self.heard['simulator'] = time.monotonic()

    def _on_status(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.heard[status.name] = time.monotonic()

    def _on_result(self, message: String) -> None:
        self.results.append((time.time(), message.data))

    def until(self, done: Callable[[], Any], what: str, patience: float = PATIENCE) -> float:
        """Spin until something holds and return how long that took, s; raises InputError."""
        begin = time.monotonic()
        while not done():
            self._executor.spin_once(timeout_sec=0.02)
            if time.monotonic() - begin > patience:
                raise InputError(f'after {patience:g} s still waiting for {what}; the account of '
                                 f'the recorder: {self.account}')
        return time.monotonic() - begin

    def wait(self, seconds: float) -> None:
        """Spin for a while."""
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() > end, 'time to pass', seconds + PATIENCE)


def memory_of(process: Any) -> float:
    """Return the memory that a process has, MB."""
    for line in Path(f'/proc/{process.pid}/status').read_text().splitlines():
        if line.startswith('VmRSS:'):
            return int(line.split()[1]) / 1e3
    return 0.0
