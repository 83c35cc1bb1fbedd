# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Least squares by the paper's eqs. (35)-(37) as printed, beside the same put right."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.identify.ls import printed_estimate
from quad_ident_ros.identify.metrics import errors
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.identify.transfer import (
    printed_coefficients,
    printed_parameters,
    response,
    SecondOrder,
    to_continuous,
    to_discrete,
)
from quad_ident_ros.paper.printed import TABLE_2
from quad_ident_ros.paper.table3 import PERIOD

# What the printed formulas do with logarithms and quotients of what is no root of a model.
FAILURES = (ValueError, ZeroDivisionError, OverflowError)
RESTORED = 0.01     # relative error of K, a and b up to which a model counts as come back


@dataclass(frozen=True)
class PrintedFit:
    """
    The printed estimate of one output: K, a, b (complex in general), or None where it fails.

    nrmse_percent is that of the model of their real parts; None where its response is not finite.
    """

    output: str
    parameters: tuple | None
    nrmse_percent: float | None


@dataclass(frozen=True)
class RoundTrip:
    """A model of Table 2 through eqs. (36) and (37): as printed and put right; None: no result."""

    output: str
    method: str
    model: tuple
    printed: tuple | None
    right: tuple | None

    @property
    def printed_restores(self):
        """Whether the printed formulas give the model back."""
        return _same(self.printed, self.model)

    @property
    def right_restores(self):
        """Whether the formulas put right do."""
        return _same(self.right, self.model)


def printed_fit(signal):
    """Return the PrintedFit of a Signal."""
    try:
        found = printed_estimate(signal.u, signal.y, signal.period)
    except FAILURES:
        return PrintedFit(signal.output, None, None)
    if not np.isfinite(found).all():
        return PrintedFit(signal.output, None, None)
    gain, a, b = (complex(value).real for value in found)
    fitted = response(SecondOrder.from_poles(gain, a, b), signal.u, signal.period)
    with np.errstate(over='ignore', invalid='ignore'):
        nrmse = errors(signal.t, signal.y, fitted)['nrmse_percent']
    return PrintedFit(signal.output, tuple(map(complex, found)),
                      float(nrmse) if np.isfinite(nrmse) else None)


def round_trips():
    """Return the RoundTrip of each model of Table 2, sampled every 5 s."""
    found = []
    for output in OUTPUTS:
        for method, model in TABLE_2[output].items():
            try:
                printed = tuple(map(complex, printed_parameters(
                    *printed_coefficients(*model, PERIOD), PERIOD)))
            except FAILURES:
                printed = None
            right = to_continuous(to_discrete(SecondOrder.from_poles(*model), PERIOD))
            found.append(RoundTrip(output, method, model, printed,
                                   right and (right.gain, right.a, right.b)))
    return found


def _same(found, model):
    """Tell whether K, a, b are those of a model, a and b in any order."""
    if found is None or not np.isfinite(found).all():
        return False
    gain, *poles = found
    pairs = zip([gain, *sorted(poles, key=lambda p: complex(p).real)],
                [model[0], *sorted(model[1:])], strict=True)
    return all(abs(got - want) <= RESTORED * abs(want) for got, want in pairs)
