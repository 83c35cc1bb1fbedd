# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""When a flight is over, and when it is time to ask for another; times in s of one clock."""

LANDED = 5.0    # s without a sample after which a flight is over
BEGINS = 60.0   # s that a simulator has to compute a flight; asked again, it starts again


def is_over(now: float, flown: float) -> bool:
    """Return whether a flight is over whose last sample came at the time flown."""
    return now - flown > LANDED


def is_time_to_ask(now: float, flown: float, asked: float) -> bool:
    """Return whether the simulator does not fly, and had time to since it was asked to."""
    return is_over(now, flown) and now - asked > BEGINS
