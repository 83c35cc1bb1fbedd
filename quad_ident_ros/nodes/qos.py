# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Qualities of service, one for each kind of topic."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

# Nothing may be lost between our own nodes: the reader takes all it can hold, and a writer that
# runs as fast as its readers waits for them.
LOSSLESS = QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0,
                      reliability=ReliabilityPolicy.RELIABLE)

# A stream in real time keeps a thousand samples for a reader that stumbles, and never waits for
# one that hangs.
STREAM = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=1000,
                    reliability=ReliabilityPolicy.RELIABLE)

BEST_EFFORT = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=1000,
                         reliability=ReliabilityPolicy.BEST_EFFORT)

# All that publishers keep for late subscribers; a topic may have several publishers.
KEPT = QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0,
                  reliability=ReliabilityPolicy.RELIABLE,
                  durability=DurabilityPolicy.TRANSIENT_LOCAL)


def latched(depth=1):
    """Return the quality for results: reliable, and kept for those who come late."""
    return QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=depth,
                      reliability=ReliabilityPolicy.RELIABLE,
                      durability=DurabilityPolicy.TRANSIENT_LOCAL)
