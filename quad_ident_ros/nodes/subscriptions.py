# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Subscriptions that take what publishers offer, reliable first, and count what was lost."""

from rclpy.event_handler import SubscriptionEventCallbacks

from quad_ident_ros.nodes.losses import Losses
from quad_ident_ros.nodes.qos import BEST_EFFORT, LOSSLESS
from quad_ident_ros.nodes.waiting import take_waiting


class Subscriptions:
    """
    The subscriptions of a node to topics of others, by name, their messages in bytes.

    Each asks for a reliable publisher, and for best effort once one offers no more than that.
    """

    def __init__(self, node):
        self._node = node
        self._all = {}
        self._losses = {}
        self._refused = []      # what add was given, of topics with less on offer
        self._counted = 0       # publishers that were refused since the last call of adapt

    @property
    def topics(self):
        """Return {name: topic as the node resolves it}."""
        return {name: subscription.topic_name for name, subscription in self._all.items()}

    def add(self, name, kind, on_message, quality=LOSSLESS):
        """Subscribe to a topic of messages of a kind; raises TwoTypes as PackageNode does."""
        refused = 0

        def on_incompatible(event):
            # total_count_change does not count what was before the executor knew the subscription.
            nonlocal refused
            self._counted += event.total_count - refused
            refused = event.total_count
            self._refused.append((name, kind, on_message))

        self._all[name] = self._node.create_subscription(
            kind, name, on_message, quality, raw=True,
            event_callbacks=SubscriptionEventCallbacks(incompatible_qos=on_incompatible))
        self._losses[name] = Losses(self._all[name])

    def adapt(self):
        """Take best effort where no more is offered; return how many publishers were refused."""
        while self._refused:
            name, kind, on_message = self._refused.pop()
            self._losses[name].close()
            self._node.destroy_subscription(self._all[name])
            self.add(name, kind, on_message, BEST_EFFORT)
            self._node.get_logger().warning(f'{name} is offered as best effort: messages may be '
                                            'lost, and are counted')
        count, self._counted = self._counted, 0
        return count

    def count_lost(self):
        """Return how many messages the middleware lost since the last call, see Losses."""
        return sum(losses.count_new() for losses in self._losses.values())

    def take_waiting(self, seconds):
        """Hand out the messages that wait; return how many were not within so many seconds."""
        return take_waiting(self._all.values(), seconds)

    def close(self):
        """Stop counting what was lost."""
        for losses in self._losses.values():
            losses.close()
