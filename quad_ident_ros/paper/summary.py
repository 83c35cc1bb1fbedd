# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What of a reproduction fits on a screen."""

from rich import box
from rich.table import Table

from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.paper.study import middle, SWARMS


def errors_table(reproduction):
    """Return a rich Table: the error of each method on each preset, median and worst seed."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold',
                  title='NRMSE of the four outputs, %, at the budget of the paper: '
                        'median (worst) of the seeds', title_justify='left', title_style='')
    table.add_column('experiment', no_wrap=True)
    for method in METHODS.values():
        table.add_column(method.label, justify='right', no_wrap=True)
    for name, study in reproduction.studies.items():
        cells = []
        for method in METHODS:
            values = sorted(study.nrmse('per_output', method))
            text = f'{middle(values):.3g}'
            cells.append(f'{text} ({values[-1]:.3g})' if method in SWARMS else text)
        table.add_row(name, *cells)
    return table


def conclusions_table(claims):
    """Return a rich Table: what the paper claims, and what of it holds."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    table.add_column('claim', no_wrap=True)
    table.add_column('verdict', no_wrap=True)
    table.add_column('score', no_wrap=True)
    for claim in claims:
        table.add_row(claim.text, claim.verdict, claim.score)
    return table
