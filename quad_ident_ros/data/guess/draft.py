# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A guess of what the columns of a table are, while it is made."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
import re

import numpy as np

from quad_ident_ros.data.columns import FORCE, POSITION, VELOCITY
from quad_ident_ros.data.guess.names import (
    AXES,
    BARE,
    BEHIND,
    NO_UNITS,
    NOT,
    OF_BODY,
    plain,
    TURNED,
    WANTED,
)
from quad_ident_ros.data.guess.series import alike, filled, turned
from quad_ident_ros.data.mapping import Column, factor_of, Mapping
from quad_ident_ros.data.motive import is_marker
from quad_ident_ros.data.tabular import Table
from quad_ident_ros.data.unit_names import unit_by

OVER = 0.1              # s over which turns are compared, so that noise of samples counts little
BURST = 16              # rows over which those of a burst and the time between bursts even out
SHORTEST = 3            # letters of a name that is counted
SAME = 0.98             # correlation of two streams of one quantity, as raw and filtered
FORMATION = 0.2         # of the extent of a flight that two positions in it are apart


@dataclass
class Guess:
    """
    What the columns of a table are taken for.

    mapping: as a mapping file would say it; said: what was taken for what; doubts: what names and
    values do not tell; roles: what there is, of data.mapping.ROLES; motors: where they are, as
    data.motor_order.about_motors has it.
    """

    mapping: Mapping = field(default_factory=Mapping)
    said: list[str] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)
    roles: list[str] = field(default_factory=list)
    motors: dict = field(default_factory=dict)


class Draft:
    """A guess that is being made: what each step takes is open to the next."""

    def __init__(self, table: Table, given: Mapping, blind: bool = False) -> None:
        """Begin; blind: the time is not used, so that what the others say of it is their own."""
        self.table, self.given, self.blind = table, given, blind
        self.guess = Guess()
        self.columns: dict[str, Column] = {}
        self.world, self.body, self.order = given.world, given.body, given.quaternion
        self.names: dict[str, str] = {}
        self.units: dict[str, str] = {}
        for name in table.columns:
            self.names[name], self.units[name] = plain(name.removeprefix(table.before))
            said = table.units.get(name, '').lower()
            if said:
                self.units[name] = unit_by(said)
        self.free = [name for name in table.columns if not NOT.search(self.names[name])
                     and np.isfinite(table.columns[name]).sum() >= 2
                     and not is_marker(name, table.bodies)]
        self.t: np.ndarray | None = None            # (N,) s
        self.stamps: np.ndarray | None = None       # (N,) s, also where it is blind
        # Whether nothing says the unit of the time, and whether it may count the rows.
        self.unsure = self.counted = False
        self.attitude: np.ndarray | None = None     # (N, 4), scalar first
        # Columns of a group, or None, by the group.
        self.found: dict[tuple[str, ...], list[str] | None] = {}

    def values(self, names: Sequence[str]) -> np.ndarray:
        """Return columns, (N, k), interpolated where rows of other streams lie in between."""
        return np.stack([filled(self.table.columns[name], self.stamps) for name in names],
                        axis=-1)

    def logged(self, names: Sequence[str]) -> np.ndarray:
        """Return columns as they are, (N, k)."""
        return np.stack([self.table.columns[name] for name in names], axis=-1)

    def scaled(self, group: Sequence[str]) -> np.ndarray:
        """Return the columns of a group that was taken, (N, k), in its unit."""
        return np.stack([self.values(self.columns[name].names)[:, 0]
                         * factor_of(name, self.columns[name].unit) for name in group], axis=-1)

    def dt(self) -> np.ndarray:
        """Return the steps of the time, (N - 1,) s."""
        assert self.t is not None
        return np.diff(self.t)

    def period(self) -> float:
        """Return the usual time from row to row, s, also where rows come in bursts."""
        assert self.t is not None
        usual = float(np.nanmedian(self.dt()))
        if len(self.t) > 2 * BURST:
            spans = self.t[BURST:] - self.t[:-BURST]
            usual = max(usual, float(np.nanmedian(spans)) / BURST)
        return max(usual, 1e-6)

    def turning(self, attitude: np.ndarray, gyro: np.ndarray, over: float = OVER
                ) -> tuple[np.ndarray, np.ndarray]:
        """Return the rates (n, 3) of attitudes and of the gyro, over the same steps (s)."""
        assert self.t is not None
        width = max(1, round(over / self.period()))
        if len(attitude) < 4 * width:
            width = 1
        sums = np.vstack([np.zeros(3), np.cumsum(0.5 * (gyro[1:] + gyro[:-1])
                                                 * self.dt()[:, None], axis=0)])
        span = (self.t[width:] - self.t[:-width])[:, None]
        return turned(attitude[:-width], attitude[width:]) / span, (
            sums[width:] - sums[:-width]) / span

    def take(self, names: Sequence[str], columns: Sequence[str], unit: str = '',
             frame: str = 'world', role: str = '', said: str = '') -> None:
        """Take columns for those of a flight record, in a unit and frame; said: as what."""
        for name, column in zip(names, columns, strict=True):
            self.columns[name] = Column((column,), unit, frame)
        self.taken(columns, role)
        self.guess.said.append(f'{together(columns)}: {said}')

    def taken(self, columns: Sequence[str], role: str) -> None:
        """Leave columns to no later step; role: of data.mapping.ROLES, or ''."""
        self.free = [name for name in self.free if name not in columns]
        if role and role not in self.guess.roles:
            self.guess.roles.append(role)

    def unit_of(self, names: Sequence[str], known: Iterable[str]) -> str:
        """Return the one unit that the names of columns say, '' for none or one not known."""
        units = {self.units[name] for name in names}
        short = {'deg': 'deg/s', 'rad': 'rad/s'} if 'deg/s' in known else (
            {'ms': 'm/s'} if 'm/s' in known else {})
        units = {short.get(one, one) for one in units}
        unit = units.pop() if len(units) == 1 else ''
        return unit if unit in known else ''

    def said_unit(self, role: str, names: Sequence[str], known: Iterable[str]) -> str:
        """Return the unit that the names of columns say, '' for none; doubt one not known."""
        telling = [name for name in names if self.units[name].lower() not in NO_UNITS]
        unit = self.unit_of(telling, known) if telling else ''
        if telling and not unit:
            said = ', '.join(dict.fromkeys(self.units[name][:20] for name in telling))
            self.guess.doubts.append(f'{role}: the unit of {together(names)}, which say {said}; '
                                     f'known are {", ".join(known)}, one for all')
        return unit

    @property
    def states(self) -> list[str]:
        """Return the columns that are free and not named as states that are asked for."""
        return [name for name in self.free if not WANTED.search(self.names[name])]

    def one(self, pattern: str, names: Sequence[str] | None = None) -> str | None:
        """Return the free column, or that of names, whose name has a pattern and is shortest."""
        found = [name for name in (self.free if names is None else names)
                 if re.search(pattern, self.names[name])]
        found.sort(key=lambda name: len(self.names[name]))
        if len(found) > 1 and len(self.names[found[0]]) == len(self.names[found[1]]):
            return None
        return found[0] if found else None

    def trio(self, group: tuple[str, ...], entries: str) -> list[str] | None:
        """Return the columns of a group of axes, of one prefix, or None."""
        whole = sorted((axes for axes in self._by_prefix(group, entries).values()
                        if len(axes) == len(entries)),
                       key=lambda axes: (group == VELOCITY and self.of_body(axes.values()), sum(
                           len(self.names[name]) for name in axes.values())))
        if whole:
            names = [[axes[axis] for axis in entries] for axes in whole]
            if len(names) > 1 and not self._same(group, names[0], names[1]):
                self.guess.doubts.append(f'{group[0]}: {together(names[0])} or '
                                         f'{together(names[1])}')
            return names[0]
        by_name = {self.names[name]: name for name in self.free}
        for bare in BARE.get(group, ()) if len(entries) == 3 else ():
            for behind in BEHIND:
                if all(f'{letter}{behind}' in by_name for letter in bare):
                    return [by_name[f'{letter}{behind}'] for letter in bare]
        return None

    def of_body(self, names: Iterable[str]) -> bool:
        """Return whether the names of columns say the axes of the body."""
        return any(OF_BODY.search(self.names[name]) for name in names)

    def numbered(self, group: tuple[str, ...]) -> list[str] | None:
        """
        Return the three columns of a group that are counted from 0 or 1, or None.

        A fourth column of that name is not an axis, and numbered letters may be anything.
        """
        for (_, stem, _), axes in self._by_prefix(group, '01234').items():
            counted = ''.join(sorted(axes))
            if len(stem) >= SHORTEST and counted in ('012', '123'):
                return [axes[axis] for axis in counted]
        return None

    def _by_prefix(self, group: tuple[str, ...], entries: str
                   ) -> dict[tuple[str, str, str], dict[str, str]]:
        """Return the columns whose names are of a group: what is around the axis, axis -> name."""
        found: dict[tuple[str, str, str], dict[str, str]] = {}
        for name in self.states:
            for axis in entries:
                match = re.search(AXES[group].format(axis), self.names[name])
                if match and not (group in (FORCE, VELOCITY) and TURNED.search(
                        self.names[name])):
                    around = self.names[name][:match.start(2)], match.group(2), match.group(3)
                    found.setdefault(around, {}).setdefault(axis, name)
        return found

    def _same(self, group: tuple[str, ...], one: list[str], other: list[str]) -> bool:
        """Return whether the first of two trios is the plain one, or both say the same."""
        whole = re.compile(AXES[group].format('[wxyz0-4]'))
        bare, second = ((match := whole.fullmatch(self.names[names[-1]])) and not match.group(3)
                        for names in (one, other))
        if bare and not second or group == VELOCITY and self.of_body(other) > self.of_body(one):
            return True
        a, b = self.values(one), self.values(other)
        if group == POSITION:   # of two vehicles in formation, which move alike
            apart = np.linalg.norm(np.nanmean(a - b, axis=0))
            if apart > FORMATION * np.linalg.norm(np.nanstd(a, axis=0)):
                return False
        return alike(a, b) > SAME


def together(names: Sequence[str]) -> str:
    """Return the names of columns for a message: many of them by the first and last."""
    names = [name[:30] for name in names]
    return f'{names[0]} to {names[-1]}' if len(names) > 4 else ', '.join(names)
