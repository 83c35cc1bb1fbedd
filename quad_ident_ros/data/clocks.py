# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Clocks of states and commands of flights, from what the commands answer."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.data.aligned import aligned, lateness
from quad_ident_ros.data.quality.answer import Answer, answer_of, CLEAR
from quad_ident_ros.data.record import FlightRecord

ALIKE = 0.001, 0.1      # s, or samples if that is more, within which the lags of flights are one
LEAST = 0.0005          # s of an offset that is worth moving commands for
PROMPT = 0.005          # s, the longest lag that controllers usually have of their own
SURE = 2.0              # standard errors between two lags that differ


@dataclass(frozen=True)
class Clock:
    """
    How much later than the commands the states of a flight are stamped, as the commands show.

    late s in the middle of the flight, and the drift s/s by which it grows; period s of the
    record.
    """

    late: float
    drift: float
    period: float


def on_one_clock(records: Sequence[FlightRecord], held_out: Sequence[FlightRecord] = ()
                 ) -> list[tuple[FlightRecord, dict[str, float], Answer | None]]:
    """
    Return for each record itself with its streams aligned, {stream: s} moved, and its Answer.

    No Answer is looked for in a record that shows by itself that streams are apart: which of them
    commands answer is not known.
    """
    found = []
    for record, late in zip((*records, *held_out), lateness(records, held_out), strict=True):
        [own] = lateness([record])
        found.append((*aligned(record, late), None if own else answer_of(record)))
    return found


def clocks_of(answers: Sequence[Answer | None], held_out: Sequence[Answer | None] = ()
              ) -> list[Clock | None]:
    """
    Return the Clock, or None where it is not shown, of flights by their Answers or None.

    Those of the flights held out come last; they have no part in those of the others. Lags that
    are all alike are the controller's own, and so are those that most of the flights share where
    they are short; beside others, or before what is answered, they are the clocks'.
    """
    told, every = [one for one in answers if one is not None], [*answers, *held_out]
    if max((one.share for one in told), default=0.0) < CLEAR:
        return [None] * len(every)
    usual = _usual_lag(told)
    return [None if one is None else Clock(_worth(usual - one.lag), -one.drift, one.period)
            for one in every]


def _usual_lag(told: Sequence[Answer]) -> float:
    lags, period = np.array([one.lag for one in told]), max(one.period for one in told)
    near = [lags[np.abs(lags - lag) <= _alike(period)] for lag in lags]
    most = max(near, key=len)
    usual = float(np.mean(most))
    shared = len(most) == len(told) or (
        2 * len(most) > len(told) and controllers_own(usual, max(one.std for one in told), period))
    return max(0.0, usual) if shared else 0.0


def controllers_own(lag: float, error: float, period: float) -> bool:
    """
    Return whether a lag and its standard error (s) may be those of a controller.

    They are short, or of one sample: then a row of the record has a command and what it answers
    in the row before.
    """
    return (lag - SURE * error <= PROMPT
            or abs(lag - period) <= SURE * error + _alike(period))


def _worth(late: float) -> float:
    return late if abs(late) > LEAST else 0.0


def _alike(period: float) -> float:
    seconds, samples = ALIKE
    return max(seconds, samples * period)
