# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Values with standard errors as a person reads them: in a handy unit, with the digits known."""

from collections.abc import Iterable
import math

PER_CENT = '%'
"""The unit of a share of one, which is shown times a hundred."""

HANDY = {'m': 'mm', 's': 'ms', 'kg': 'g', 'kg/s': 'g/s', 'kg/m': 'g/m', 'rad': 'mrad',
         'N': 'mN', 'N m': 'mN m'}
SMALL = 0.1         # of a unit, below which its thousandth is handier
DIGITS = 2          # of a standard error
MOST = 6            # decimals: more say nothing


def handy(unit: str, values: Iterable[float]) -> tuple[str, float]:
    """Return the unit that values (SI) are best shown in, and by what to multiply them."""
    if unit == PER_CENT:
        return unit, 100.0
    largest = max((abs(value) for value in values), default=0.0)
    return (HANDY[unit], 1e3) if unit in HANDY and 0.0 < largest < SMALL else (unit, 1.0)


def sized(value: float, std: float, unit: str) -> str:
    """Return a value with its standard error and unit: 3.98 ± 0.03 mm."""
    shown, factor = handy(unit, (value,))
    text = with_error(factor * value, factor * std)
    return text if shown in ('1', '') else f'{text} {shown}'


def with_error(value: float, std: float) -> str:
    """Return a value with its standard error, with the digits that the error leaves."""
    if not (std > 0.0 and math.isfinite(std)):
        return f'{value:.3g}'
    decimals = DIGITS - 1 - math.floor(math.log10(std))
    if decimals > MOST or decimals < -MOST:
        return f'{value:.3g} ± {std:.2g}'
    error = f'{std:.{max(decimals, 0)}f}'
    return f'{value:.{max(decimals, 0)}f} ± {error}'
