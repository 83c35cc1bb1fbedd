# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a person reads of an export: numbers, what is carried, and what it costs."""

from pathlib import Path
import re

from quad_ident_ros.diagnose.carried import Carried, NOMINAL, WHOLE
from quad_ident_ros.effects.registry import titled
from quad_ident_ros.report.screen import console, say, table_of
from quad_ident_ros.vehicle_files.export import Export

FILE, CODE = 'file', 'file_and_code'
ROWS = {NOMINAL: 'the base', WHOLE: 'the vehicle file', FILE: 'the written file',
        CODE: 'the written file with its code'}
"""What the rows of a Carried are called."""
_CLASSES = {'carried': 'carried', 'by_code': 'carried', 'nearest': 'by the nearest',
            'not_carried': 'not carried'}


def show(found: Export, path: str, new: bool, beside: Path) -> None:
    """
    Print what changes, and what becomes of each effect.

    Args: path: of the file; new: whether it has no base of the user; beside: path of its code.
    """
    screen = console()
    if found.changes:
        screen.print(table_of(
            ('place', 'old', 'new', 'std', 'unit', 'from'),
            [(change.place, _shown(change.old), _shown(change.new), _shown(change.std),
              change.unit, source_of(change.source)) for change in found.changes],
            ('old', 'new', 'std')))
    for text in found.remarks:
        say(screen, f'note: {text}')
    show_fates(found)
    count = len(found.changes)
    say(screen, f'{path}: {"new, " if new else ""}{count or "no"} number{"s" * (count != 1)} '
                'changed' + (' by the effects' if new else ''))
    if found.code is not None:
        say(screen, f'{beside}: code for what the file has no number for; its first lines say how '
                    'to use it')


def show_fates(found: Export) -> None:
    """Print what becomes of each effect."""
    screen = console()
    for key, said in _CLASSES.items():
        for fate in getattr(found.fates, key):
            form = f', form {fate.form}' if fate.form else ''
            say(screen, f'{said}: {titled(fate.name)}{form}: {fate.reason}')


def show_cost(cost: Carried) -> None:
    """Print the gaps on the flights, and what of them the file closes."""
    screen = console()
    title, units = f'gap {cost.horizon:g} s ahead', cost.units.items()
    titles = [f'{group}, {unit}' for group, unit in units]
    screen.print(table_of([title, *titles], [
        [ROWS[name], *(f'{values[group]:.3g}' for group in cost.units)]
        for name, values in cost.gaps.items()], titles))
    for name, share in cost.shares.items():
        say(screen, f'{ROWS[name]} closes {100 * share:.3g} % of what the vehicle file closes of '
                    'the velocity gap')
    if not cost.shares:
        say(screen, 'the vehicle file closes nothing of the velocity gap on these flights')


def source_of(names: str) -> str:
    """Return what a number comes from, such as "mass, mass_offset", with the effects' titles."""
    return re.sub(r'\w+', lambda one: titled(one[0]), names)


def _shown(value: float | None) -> str:
    return '' if value is None else f'{value:.6g}'
