# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Clocks of states and commands, told by what the commands answer."""

import numpy as np

ALIKE = 0.001       # s within which the lags of flights are one
LEAST = 0.0005      # s of an offset that is worth moving commands for
PROMPT = 0.01       # s, a lag that a controller may well have


def usual_lag(answers):
    """
    Return the lag (s) behind the states at which a controller answers, of Answers or None.

    The one that all flights share, or more than half of them where it is short: their clocks are
    alike, so that it is the controller's own. Without such a one, and where commands come before
    what they answer, 0.
    """
    lags = np.array([one.lag for one in answers if one is not None])
    near = [lags[np.abs(lags - lag) <= ALIKE] for lag in lags]
    most = max(near, key=len, default=lags)
    usual = float(np.mean(most)) if 2 * len(most) > len(answers) else 0.0
    return max(0.0, usual) if len(most) == len(answers) or usual <= PROMPT else 0.0


def late_states(answer, usual):
    """
    Return how much later than the commands a flight's states are stamped, (s, s/s), or None.

    In the middle of the flight, and by how much it grows; None where the commands do not show it.
    """
    if answer is None:
        return None
    late = usual - answer.lag
    return late if abs(late) > LEAST else 0.0, -answer.drift
