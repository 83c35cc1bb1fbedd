# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a result says in words about what its model cannot say."""

from collections.abc import Iterator

import numpy as np

from quad_ident_ros.identify.order import Alternative
from quad_ident_ros.identify.residuals import ResidualTests
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.space import at_bounds, Space
from quad_ident_ros.identify.transfer import SecondOrder
from quad_ident_ros.identify.uncertainty import level_spread, Uncertainty

UNDETERMINED = 'these data do not determine K, a and b: the information matrix is singular'
LEVEL = ('the input never changes and the start is free: K cannot be distinguished from the level '
         'from which the output is measured; its error allows for a level off by the range of the '
         'output')
SAME = 1e-9        # of an input's range: changes below are rounding
TRACELESS = 10.0   # pole x period beyond which e^-10 of its response is left at the next sample


def findings_of(signal: Signal, model: SecondOrder, sure: Uncertainty, tests: ResidualTests,
                bounds: Space | None = None) -> Iterator[str]:
    """
    Yield what a reader must know about how certain a model is.

    Args: the Signal, its SecondOrder, Uncertainty and ResidualTests; bounds: the Space in which a
    search found the model, or None.
    """
    if sure.errors['K'] is None:
        yield UNDETERMINED
    # Of two poles that are closer than their errors only the sum and the product are known.
    apart = model.form == 'real' and sure.errors['a']
    mixed = model.form == 'equal' or apart and apart > (model.a - model.b).real
    if mixed and sure.errors['c1'] is not None:
        yield ('a and b are closer than their errors: the data determine only '
               f'a + b = {model.c1:.4g} ± {sure.errors["c1"]:.1g} and '
               f'a b = {model.c0:.4g} ± {sure.errors["c0"]:.1g}')
    unsure = [name for name in sure.unidentifiable if sure.errors[name] is not None
              and not (mixed and name in 'ab')]
    if unsure:
        yield (f'not identifiable from this record: {", ".join(unsure)}; the standard error is '
               'above half of the number, or of the smallest number that the record can '
               'distinguish from zero')
    if tests.depends_on_input:
        yield ('the residuals still depend on the input: the model omits dynamics, and the '
               'standard errors cover the noise only')
    elif tests.is_coloured:
        yield ('the residuals are not white, because of coloured noise or omitted dynamics: the '
               'standard errors are too small')
    gaps, changed = _gaps(signal)
    if changed:
        yield (f'the input differs between the two sides of {changed} of {gaps} gaps in the '
               'record: when it changed within them is not known, and the standard errors, which '
               'cover the noise only, are too small')
    # The level enters beside the noise: it is reported where it is not small.
    if sure.errors['K'] and sure.errors['K'] < 2 * level_spread(signal, model):
        yield LEVEL
    for name in at_bounds(bounds, model) if bounds else ():
        low, high = getattr(bounds, name)
        yield (f'the search ended on the bounds of the {name}, {low:.4g} to {high:.4g}: a better '
               'model may lie beyond')
    if model.form != 'complex' and model.a.real * signal.period > TRACELESS:
        yield (f'a = {model.a:.4g} 1/s dies out within a sample: of K and a, the record '
               f'determines only K/a = {model.gain / model.a:.4g}')


def _gaps(signal: Signal) -> tuple[int, int]:
    """Return how many gaps the samples of a Signal have, and across how many the input differs."""
    ends = signal.measured[1:] & ~signal.measured[:-1]
    if not ends.any():
        return 0, 0
    # In a gap the input stands as it was before.
    changes = np.abs(np.diff(signal.u)[ends]) > SAME * np.ptp(signal.u)
    return int(np.count_nonzero(ends)), int(np.count_nonzero(changes))


def order_finding(other: Alternative) -> str | None:
    """Return the finding on an order.Alternative, or None."""
    if not other.is_better:
        return None
    if other.name == 'first order':
        return (f'K/(s+a) with a = {other.denominator[0]:.4g} describes the record equally well, '
                'with one number less')
    if other.name == 'double integrator':
        return ('K/s^2 describes the record equally well: its poles cannot be distinguished from '
                'zero')
    return ('a third pole fits significantly better: the rms error falls to '
            f'{other.nrmse_percent:.3g} % of the range')
