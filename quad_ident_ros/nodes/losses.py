# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the middleware lost on the way to a subscription."""

from rclpy.event_handler import QoSSubscriptionEventType, UnsupportedEventTypeError
from rclpy.impl.implementation_singleton import rclpy_implementation


class Losses:
    """
    The message_lost event of a subscription, to be asked for while its topic is quiet.

    A callback for the event would do the same, but the executor may then take the event just
    when another message is lost, and that deadlocks rmw_fastrtps (ros2/rmw_fastrtps#890): with
    the events executor one time in 20 where a fast publisher overruns the subscription.
    """

    def __init__(self, subscription):
        self._seen = 0
        try:
            with subscription.handle:
                self._event = rclpy_implementation.EventHandle(
                    subscription.handle, QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST)
        except UnsupportedEventTypeError:
            self._event = None   # another middleware

    def count_new(self):
        """Return how many messages were lost since the last call."""
        if self._event is None:
            return 0
        with self._event:
            status = self._event.take_event()
        if status is None:
            return 0
        new, self._seen = status.total_count - self._seen, status.total_count
        return new

    def close(self):
        """Let go of the subscription."""
        if self._event is not None:
            self._event.destroy_when_not_in_use()
            self._event = None
