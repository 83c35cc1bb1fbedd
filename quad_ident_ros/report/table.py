# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The table of an identification that a person reads."""

import math

from rich import box
from rich.table import Table

from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.result import Identification, OutputFit
from quad_ident_ros.identify.signals import GAIN_UNITS


def identification_table(identification: Identification) -> Table:
    """Return a rich Table: K, a, b with standard errors and the errors of each fit."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    table.add_column('output', no_wrap=True)
    table.add_column('method', no_wrap=True)
    for name in ('K', 'a, 1/s', 'b, 1/s', 'IAE', 'ISE', 'ITAE', 'ITSE', 'fit %'):
        table.add_column(name, justify='right', no_wrap=True)
    for output in identification.signals:
        fits = {name: method.outputs[output] for name, method in identification.methods.items()}
        best = identification.best_of(output)
        for number, (name, fit) in enumerate(fits.items()):
            is_best = name == best
            table.add_row(output if number == 0 else '',
                          METHODS[name].label + (' *' if is_best else ''), *_cells(fit),
                          style='bold' if is_best else None,
                          end_section=number == len(fits) - 1)
    return table


def legend(identification: Identification) -> str:
    """Return the units of the table in a line."""
    units = [f'{output} {GAIN_UNITS[output]}' for output in identification.signals]
    return (f'K in: {", ".join(units)}. ± is one standard error. '
            '*: the smallest error of its output.')


def notes(identification: Identification) -> list[str]:
    """
    Return the remarks on data and fits as lines of text.

    How each method found its model; what is to be known of a model, of the best one only.
    """
    who: dict[tuple[str, str], list[str]] = {}     # outputs, by label and text
    for name, method in identification.methods.items():
        for output, fit in method.outputs.items():
            for remark in fit.remarks:
                who.setdefault((METHODS[name].label, remark), []).append(output)
    for output in identification.signals:
        name = identification.best_of(output)
        for finding in identification.methods[name].outputs[output].findings:
            who.setdefault((METHODS[name].label, finding), []).append(output)
    return [*identification.remarks, *(f'{label}, {", ".join(outputs)}: {text}'
                                       for (label, text), outputs in who.items())]


def with_error(value: float, error: float | None) -> str:
    """Return a value with the decimals that its standard error gives a meaning to, at least 3."""
    if error is None or not error > 0:
        return f'{value:.5g}'
    decimals = min(max(1 - _exponent(error), 2 - _exponent(value), 0), 5)
    return f'{value:.{decimals}f} ± {error:.2g}'


def _cells(fit: OutputFit) -> list[str]:
    if fit.model is None:
        return ['none'] * 3 + ['-'] * 5
    model, error = fit.model, fit.standard_errors
    if model.form == 'complex':
        poles = [f'{model.a.real:.4g}', f'±{abs(model.a.imag):.4g}j']
    else:
        poles = [with_error(model.a.real, error['a']), with_error(model.b.real, error['b'])]
    found = {key: value for key, value in fit.errors.items() if value is not None}
    values = [found[key] for key in ('iae', 'ise', 'itae', 'itse')]
    return [with_error(model.gain, error['K']), *poles,
            *[f'{value:.2e}' if value < 1e-3 else f'{value:.3g}' for value in values],
            f'{found["fit_percent"]:.3f}']


def _exponent(number: float) -> int:
    return math.floor(math.log10(abs(number))) if number else 0
