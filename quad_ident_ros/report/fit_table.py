# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The table of a fit that a person reads."""

import math
from typing import TYPE_CHECKING

from rich import box
from rich.console import JustifyMethod
from rich.table import Table

from quad_ident_ros.effects.registry import titled

if TYPE_CHECKING:
    from quad_ident_ros.greybox.fit import Fit, Parameter

FEWEST, MOST = 1e-3, 1e5    # values that are shown without an exponent
COLUMNS: tuple[tuple[str, JustifyMethod], ...] = (
    ('parameter', 'left'), ('value', 'right'), ('unit', 'left'), ('vehicle file', 'right'),
    ('', 'left'))


def fit_table(fit: 'Fit') -> Table:
    """Return a rich Table of a fit: name, value with standard error, unit, nominal value."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    for name, side in COLUMNS:
        # Names with titles are long: they are wrapped, and no number is cut off.
        table.add_column(name, justify=side, overflow='fold', no_wrap=side == 'right')
    for parameter in fit.parameters:
        value = '-' if parameter.value is None else shown(parameter.value, parameter.std)
        table.add_row(titled(parameter.name), value, parameter.unit, f'{parameter.nominal:.5g}',
                      _remark(parameter))
    return table


def _remark(parameter: 'Parameter') -> str:
    if parameter.status == 'bound':
        return 'at its bound'
    if parameter.status == 'determined':
        return ''
    # By the names alone: each of them has a row of its own, with its title.
    given = ', '.join(f'{name} is {value:g}' for name, value in parameter.given.items())
    return f'undetermined; this if {given}' if given else 'undetermined'


def shown(value: float, error: float | None) -> str:
    """Return a value with its standard error, to two digits of the error."""
    if not error:
        return f'{value:.5g}'
    size = math.floor(math.log10(max(abs(value), error)))
    power = 0 if FEWEST <= max(abs(value), error) < MOST else size
    digits = max(0, 1 + power - math.floor(math.log10(error)))
    value, error = value / 10.0 ** power, error / 10.0 ** power
    text = f'{value:.{digits}f} ± {error:.{digits}f}'
    return f'({text})e{power}' if power else text
