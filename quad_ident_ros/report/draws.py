# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a person reads of drawn vehicles, and the same as data."""

from typing import Any

import numpy as np

from quad_ident_ros.effects.registry import titled
from quad_ident_ros.report.screen import console, say, table_of
from quad_ident_ros.vehicle_files.draws import Draws

TITLES = ('number', 'vehicle file', 'std', 'std drawn', 'from', 'to', 'unit')


def show_draws(draws: Draws) -> None:
    """Print the numbers that were drawn, and what of the distribution was cut off."""
    screen = console()
    screen.print(table_of(TITLES, [
        (titled(row['name']),
         *(f'{row[key]:.4g}' for key in ('value', 'std', 'std_drawn', 'least', 'most')),
         row['unit'])
        for row in rows_of(draws)], TITLES[1:-1]))
    if draws.cut:
        say(screen, f'note: {draws.cut} of {draws.cut + len(draws.vehicles)} draws cannot be '
                    f'vehicles and were drawn again; the first of them: {draws.why}')


def rows_of(draws: Draws) -> list[dict[str, Any]]:
    """Return the numbers that were drawn, with what was asked for and what came of it."""
    return [{'name': name, 'unit': unit, 'value': float(mean), 'std': float(std),
             'std_drawn': float(np.std(column)), 'least': float(column.min()),
             'most': float(column.max())}
            for name, unit, mean, std, column in zip(draws.names, draws.units, draws.means,
                                                     draws.stds, draws.values.T, strict=True)]
