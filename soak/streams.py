# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Clocks that jump, equal stamps, publishers that restart, that are two, or of another quality."""

from collections.abc import Callable
import tempfile
from typing import Any

from geometry_msgs.msg import PointStamped
from rclpy.qos import QoSProfile, ReliabilityPolicy

from quad_ident_ros.nodes.launched import Launched
from quad_ident_ros.nodes.qos import BEST_EFFORT, latched, STREAM
from soak.rig import Finding, Watch

COUNT = 500             # messages of a part
PERIOD = 10 ** 7        # ns
SECOND = 10 ** 9
PLACES = ('joined', 'dropped', 'late', 'duplicated', 'out_of_order', 'nan')


def run(short: bool = False, **_: object) -> list[Finding]:
    """Return a Finding for each kind of trouble; short: of the first two."""
    return [_one(name, trouble) for name, trouble in list(TROUBLES.items())[:2 if short else None]]


class Source:
    """Publishes altitudes with given stamps, not faster than they are heard."""

    def __init__(self, watch: Watch, quality: QoSProfile = STREAM) -> None:
        self._watch = watch
        self._publisher = watch.node.create_publisher(PointStamped, 'height', quality)
        self.sent = 0
        watch.until(lambda: self._publisher.get_subscription_count() > 0, 'the recorder')

    def send(self, stamps: Any) -> None:
        """Publish a message with each of the stamps, ns."""
        for stamp in stamps:
            message = PointStamped()
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(int(stamp), SECOND)
            message.point.z = 1.0
            self._publisher.publish(message)
            self.sent += 1
            if self.sent % 50 == 0:
                self._watch.wait(0.02)

    def close(self) -> None:
        """End the publisher."""
        self._watch.node.destroy_publisher(self._publisher)


def _stamps(first: float, count: int = COUNT) -> range:
    return range(round(first * SECOND), round(first * SECOND) + count * PERIOD, PERIOD)


def _jumps(watch: Watch) -> list[Source]:
    source = Source(watch)
    for first in (100.0, 50.0, 500.0, 500.0 - 10.0, 0.0):
        source.send(_stamps(first))
    return [source]


def _equal(watch: Watch) -> list[Source]:
    source = Source(watch)
    source.send(_stamps(1.0))
    source.send([COUNT * PERIOD] * COUNT)
    source.send(_stamps(10.0))
    return [source]


def _restarts(watch: Watch) -> list[Source]:
    sources = []
    for number in range(10):
        source = Source(watch)
        source.send(_stamps(10.0 * number, 50))
        watch.wait(0.3)     # what is on its way arrives
        source.close()
        sources.append(source)
    return sources


def _two(watch: Watch) -> list[Source]:
    pair = [Source(watch), Source(watch)]
    for part in range(10):
        for source in pair:
            source.send(_stamps(1.0 + 0.5 * part, 50))
    return pair


def _two_clocks(watch: Watch) -> list[Source]:
    pair = [Source(watch), Source(watch)]
    for part in range(10):
        for number, source in enumerate(pair):
            source.send(_stamps(1.0 + 0.5 * part + 1000.0 * number, 50))
    return pair


def _quality(quality: QoSProfile) -> Callable[[Watch], list[Source]]:
    def send(watch: Watch) -> list[Source]:
        source = Source(watch, BEST_EFFORT if quality is BEST_EFFORT else quality)
        watch.wait(1.5)     # the recorder takes what is offered
        source.send(_stamps(1.0))
        return [source]
    return send


SHALLOW = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
TROUBLES = {
    'the clock jumps back and forth': _jumps, 'one stamp again and again': _equal,
    'a publisher that restarts ten times': _restarts, 'two publishers, one clock': _two,
    'two publishers, clocks 1,000 s apart': _two_clocks,
    'a publisher of best effort': _quality(BEST_EFFORT),
    'a publisher that keeps 100': _quality(SHALLOW),
    'a latched publisher': _quality(latched(100))}


def _one(name: str, trouble: Callable[[Watch], list[Source]]) -> Finding:
    with tempfile.TemporaryDirectory() as folder, Launched(folder) as launched:
        launched.start('recorder', {'topics': ['altitude'], 'output': folder},
                       arguments=['-r', 'altitude:=height'])
        with launched.watcher('soak') as pair:
            watch = Watch(*pair)
            watch.until(lambda: watch.account, 'the recorder')
            sources = list(trouble(watch))
            sent = sum(source.sent for source in sources)
            # Rows that wait for others are given up 2 s after the publishers are gone.
            for source in sources:
                if 'restarts' not in name:
                    source.close()
            watch.wait(4.5)
            launched.check()
            account = watch.account
    received, lost = account['received']['altitude'], account['lost']
    placed = sum(account[key] for key in PLACES)
    text = ', '.join(f'{account[key]} {key}' for key in (*PLACES, 'restarts') if account[key])
    return Finding('streams', name, f'{sent} sent, {received} received, {lost} lost: {text}',
                   received + lost == sent and placed >= received and account['joined'] > 0)
