# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages that wait in the middleware when a node is asked to end."""

import time

FULL = 5000         # messages of a topic that the middleware keeps for a reader that is behind
BEHIND = 100        # messages without a pause: then a reader is behind, 0.1 s at 1 kHz
SENT_AGAIN = 3.5    # s within which the middleware sends again what it had no room for, or reports
                    # that it is lost: writers announce what they have every 3 s


def take_waiting(subscriptions, seconds):
    """
    Hand the messages that wait to the callbacks of their subscriptions, and return how many not.

    Where the node was behind, what the middleware refused meanwhile comes within SENT_AGAIN, and
    is waited for. What cannot be handed out within so many seconds is taken and counted, of each
    subscription up to FULL: a publisher may go on all the while.
    """
    settled = time.monotonic()
    end, waited = settled + seconds, 0
    while time.monotonic() < end:
        messages = [(subscription, message) for subscription in subscriptions
                    if (message := _take(subscription)) is not None]
        for subscription, message in messages:
            subscription.callback(message)
        waited += len(messages)
        if waited >= BEHIND:
            settled = time.monotonic() + SENT_AGAIN
        if not messages:
            if time.monotonic() >= settled:
                return 0
            waited = 0
            time.sleep(0.005)
    return sum(_count(subscription) for subscription in subscriptions)


def _count(subscription):
    count = 0
    while count < FULL and _take(subscription) is not None:
        count += 1
    return count


def _take(subscription):
    with subscription.handle:
        taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    return None if taken is None else taken[0]
