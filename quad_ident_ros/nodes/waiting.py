# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages that wait in the middleware when a node is told to end."""

import time

FULL = 5000         # messages of a topic that the middleware keeps for a reader that is behind
SENT_AGAIN = 3.5    # s within which it sends again what it had no room for, or tells that it is
                    # lost


def take_waiting(subscriptions, seconds):
    """
    Hand the messages that wait to the callbacks of their subscriptions, and return how many not.

    Where as many wait as the middleware keeps, what it refused comes within SENT_AGAIN, and is
    waited for. What cannot be handed out within so many seconds is taken and counted, of each
    subscription up to FULL: a publisher may go on all the while.
    """
    begin = time.monotonic()
    end, settled = begin + seconds, begin
    taken = dict.fromkeys(subscriptions, 0)
    while time.monotonic() < end:
        news = False
        for subscription in subscriptions:
            message = _take(subscription)
            if message is not None:
                news = True
                taken[subscription] += 1
                if taken[subscription] == FULL:
                    settled = time.monotonic() + SENT_AGAIN
                subscription.callback(message)
        if not news:
            if time.monotonic() >= settled:
                return 0
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
