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
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String, UInt64
from std_srvs.srv import Trigger

from quad_ident_ros.data.topics import FLIGHT_TOPICS, JOINED_TOPIC
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.qos import latched

PATIENCE = 120.0    # s after which something is wrong, on a machine that does nothing else
SLOWEST = 10.0      # times longer, at most, on one that does
SAMPLE = 0.05       # s of computing that show how much slower it is
# The newest sample alone: a watcher is not to keep anybody waiting, nor busy itself.
NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


@dataclass(frozen=True)
class Finding:
    """One line of the table: what was done, what came of it, and whether it held."""

    case: str
    done: str
    result: str
    held: bool


class Watch:
    """
    Hears the account of the recorder, how far it is, the newest stamp on the wire and who lives.

    newest, joined: stamps (ns) of the newest sample, and of the last that the recorder joined;
    flown, asked: when the last sample came, and when the simulator was asked to fly, s of the
    monotonic clock; start: its client.
    """

    def __init__(self, node: Any, executor: Any) -> None:
        self.node, self._executor = node, executor
        self.account: dict = {}
        self.newest = self.joined = 0
        self.flown = self.asked = time.monotonic()
        self.start = node.create_client(Trigger, 'simulator/start')
        self.heard: dict[str, float] = {}
        self.results: list = []
        node.create_subscription(String, 'recorder/statistics', self._on_account, latched())
        node.create_subscription(PointStamped, 'altitude', self._on_sample, NEWEST, raw=True)
        node.create_subscription(UInt64, JOINED_TOPIC, self._on_joined, 10)
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_status, 10)
        node.create_subscription(String, 'parameters_json', self._on_result, latched())

    def _on_account(self, message: String) -> None:
        self.account = json.loads(message.data)

    def _on_sample(self, raw: bytes) -> None:
        self.newest = FLIGHT_TOPICS['altitude'].read(raw)[0]
        self.heard['simulator'] = self.flown = time.monotonic()

    def _on_joined(self, message: UInt64) -> None:
        self.joined = message.data

    def _on_status(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.heard[status.name] = time.monotonic()

    def _on_result(self, message: String) -> None:
        self.results.append((time.time(), message.data))

    def until(self, done: Callable[[], Any], what: str, patience: float = PATIENCE) -> float:
        """
        Spin until something holds and return how long that took, s.

        Raises InputError after the patience (s), which is longer where others keep the machine
        busy.
        """
        begin, slower = time.monotonic(), 1.0
        while not done():
            self._executor.spin_once(timeout_sec=0.02)
            if time.monotonic() - begin > slower * patience:
                now = slowness()
                if now <= slower:
                    raise InputError(f'after {slower * patience:.0f} s still waiting for {what}; '
                                     f'the account of the recorder: {self.account}')
                slower = now
        return time.monotonic() - begin

    def wait(self, seconds: float) -> None:
        """Spin for a while."""
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() > end, 'time to pass', seconds + PATIENCE)


def slowness() -> float:
    """Return how many times longer computing takes than on a core that is free, at least 1."""
    begin, used = time.monotonic(), time.process_time()
    while time.process_time() - used < SAMPLE:
        pass
    return min(max((time.monotonic() - begin) / SAMPLE, 1.0), SLOWEST)


def memory_of(process: Any) -> float:
    """Return the memory that a process has, MB."""
    for line in Path(f'/proc/{process.pid}/status').read_text().splitlines():
        if line.startswith('VmRSS:'):
            return int(line.split()[1]) / 1e3
    return 0.0
