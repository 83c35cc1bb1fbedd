# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the columns of a table are, where their names and values leave no doubt."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
import re
import warnings

import numpy as np

from quad_ident_ros.data import frames
from quad_ident_ros.data.column_names import (
    ANGLE,
    AXES,
    BARE,
    BATTERY,
    CORNER,
    CORNERS,
    CRAZYFLIE,
    FORCES,
    MOTOR,
    NOT,
    PITCH_DOWN,
    plain,
    SPEED,
    TIME,
    TURNED,
    TURNING,
    UNITS,
)
from quad_ident_ros.data.columns import FORCE, from_euler, POSITION, RATE, VELOCITY
from quad_ident_ros.data.mapping import ATTITUDE, Column, factor_of, Mapping
from quad_ident_ros.data.motor_order import about_motors, quad
from quad_ident_ros.data.record import EULER, QUATERNION
from quad_ident_ros.data.signal_kind import kinds_of, TITLES
from quad_ident_ros.data.tabular import Table

RATES = 5.0, 5000.0     # Hz, of logs
G = 9.80665
AROUND = (1, -1), (-1, -1), (-1, 1), (1, 1)     # forward, left: front right to front left
OVER = 0.1              # s over which turns are compared, so that noise of samples counts little
SLOWEST = 20.0          # rad/s or rpm: no rotor that flies turns more slowly


@dataclass
class Guess:
    """
    What the columns of a table are taken for.

    mapping: as a mapping file would say it; said: what was taken for what; doubts: what names and
    values do not tell; roles: what there is, of data.mapping.ROLES; motors: where they are, as
    data.motor_order.about_motors has it.
    """

    mapping: Mapping = None
    said: list = field(default_factory=list)
    doubts: list = field(default_factory=list)
    roles: list = field(default_factory=list)
    candidates: dict = field(default_factory=dict)
    motors: dict = field(default_factory=dict)


def guess(table: Table, given: Mapping | None = None) -> Guess:
    """
    Return the Guess of a table.

    Args: table tabular.Table; given Mapping or None: what it says of frames and quaternions holds.
    """
    given = given or Mapping()
    # What is no number of a flight tells nothing.
    finite = {name: np.where(np.abs(values) < 1e30, values, np.nan)
              for name, values in table.columns.items()}
    made = _Making(replace(table, columns=finite), given)
    with warnings.catch_warnings(), np.errstate(all='ignore'):
        warnings.simplefilter('ignore', RuntimeWarning)     # of rows without any value
        for step in (made.time, made.vectors, made.quaternion, made.angles, made.rates,
                     made.positions, made.forces, made.frames, made.velocities, made.motors,
                     made.battery):
            step()
    made.guess.mapping = Mapping({}, made.world, made.body, {}, given.actuators, made.columns,
                                 made.order, given.separator)
    made.guess.doubts += table.doubts
    if not made.guess.roles:
        made.guess.doubts.append('no column is a position, velocity, attitude, rate or specific '
                                 'force by its name')
    return made.guess


class _Making:
    """A guess that is being made: what each step takes is open to the next."""

    def __init__(self, table: Table, given: Mapping | None) -> None:
        self.table, self.given = table, given
        self.guess = Guess()
        self.columns, self.world, self.body = {}, given.world, given.body
        self.order = given.quaternion
        self.names, self.units = {}, {}
        for name in table.columns:
            self.names[name], self.units[name] = plain(name)
            said = table.units.get(name, '').lower()
            if said:
                self.units[name] = UNITS.get(said, said)
        self.free = [name for name in table.columns if not NOT.search(self.names[name])
                     and np.isfinite(table.columns[name]).sum() >= 2]
        self.t = None

    # --- what each step shares

    def values(self, names: Sequence[str]) -> np.ndarray:
        """Return columns, (N, k), interpolated where rows of other streams lie in between."""
        return np.stack([_filled(self.table.columns[name]) for name in names], axis=-1)

    def logged(self, names: Sequence[str]) -> np.ndarray:
        """Return columns as they are, (N, k)."""
        return np.stack([self.table.columns[name] for name in names], axis=-1)

    def scaled(self, group: Sequence[str]) -> np.ndarray:
        """Return the columns of a group that was taken, (N, k), in its unit."""
        return np.stack([self.values(self.columns[name].names)[:, 0]
                         * factor_of(name, self.columns[name].unit) for name in group], axis=-1)

    def turning(self, attitude: np.ndarray, gyro: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the rates (n, 3) of attitudes and of the gyro, over the same steps in time."""
        width = max(1, round(OVER / max(float(np.nanmedian(self.dt())), 1e-6)))
        if len(attitude) < 4 * width:
            width = 1
        sums = np.vstack([np.zeros(3), np.cumsum(0.5 * (gyro[1:] + gyro[:-1])
                                                 * self.dt()[:, None], axis=0)])
        span = (self.t[width:] - self.t[:-width])[:, None]
        return _turned(attitude[:-width], attitude[width:]) / span, (
            sums[width:] - sums[:-width]) / span

    def take(self, names: Sequence[str], columns: Sequence[str], unit: str = '',
             frame: str = 'world', role: str = '', said: str = '') -> None:
        for name, column in zip(names, columns, strict=True):
            self.columns[name] = Column((column,), unit, frame)
        self._taken(columns, role)
        self.guess.said.append(f'{_together(columns)}: {said}')

    def _taken(self, columns: Sequence[str], role: str) -> None:
        self.free = [name for name in self.free if name not in columns]
        if role and role not in self.guess.roles:
            self.guess.roles.append(role)

    def one(self, pattern: str) -> str | None:
        """Return the column of a pattern; the one of the shortest name where that is clear."""
        found = [name for name in self.free if re.search(pattern, self.names[name])]
        found.sort(key=lambda name: len(self.names[name]))
        if len(found) > 1 and len(self.names[found[0]]) == len(self.names[found[1]]):
            return None
        return found[0] if found else None

    def trio(self, group: Sequence[str], entries: str) -> list[str] | None:
        """Return the columns of a group of axes, of one prefix, or None."""
        found = {}
        for name in self.free:
            for axis in entries:
                match = re.search(AXES[group].format(axis), self.names[name])
                if match and not (group in (FORCE, VELOCITY) and TURNED.search(
                        self.names[name])):
                    prefix = self.names[name][:match.start(2)]
                    found.setdefault((prefix, match.group(2)), {}).setdefault(axis, name)
        whole = sorted((axes for axes in found.values() if len(axes) == len(entries)),
                       key=lambda axes: sum(len(self.names[name]) for name in axes.values()))
        self.guess.candidates.setdefault(group, []).extend(
            [axes[axis] for axis in entries] for axes in whole)
        if whole:
            names = [[axes[axis] for axis in entries] for axes in whole]
            if len(names) > 1 and not self._same(group, names[0], names[1]):
                self.guess.doubts.append(f'{group[0]}: {_together(names[0])} or '
                                         f'{_together(names[1])}')
            return names[0]
        by_name = {self.names[name]: name for name in self.free}
        for bare in BARE.get(group, ()) if len(entries) == 3 else ():
            if all(letter in by_name for letter in bare):
                return [by_name[letter] for letter in bare]
        return None

    def _same(self, group: Sequence[str], one: list[str], other: list[str]) -> bool:
        """Return whether the first of two trios is the plain one, or both tell the same."""
        whole = re.compile(AXES[group].format('[wxyz0-4]'))
        if whole.fullmatch(self.names[one[-1]]) and not whole.fullmatch(self.names[other[-1]]):
            return True
        return _alike(self.values(one), self.values(other)) > 0.98

    def dt(self) -> np.ndarray:
        return np.diff(self.t)

    # --- steps

    def time(self) -> None:
        found = [name for name in self.free if TIME.search(self.names[name])]
        rising = [name for name in found if _rises(self.table.columns[name])]
        first = next(iter(self.table.columns))
        if not found and _is_clock(self.table.columns[first]):
            rising = [first]        # in whatever language
        if not rising:
            self.guess.doubts.append(
                f't: no column of a time that rises{_but(found)}; add one in s to the file')
            self.guess.candidates['t'] = found
            return
        name = min(rising, key=lambda name: len(self.names[name]))
        values, unit = self.table.columns[name], self.units[name]
        if unit not in ('s', 'ms', 'us', 'ns'):
            unit = time_unit(values)
        if not unit:
            self.guess.doubts.append(f't: the unit of {name!r}')
            unit = 's'
        self.columns['t'] = Column((name,), unit)
        self.t = values * factor_of('t', unit)
        self._taken([name], '')
        self.guess.said.append(f'{name}: time in {unit}')

    def vectors(self) -> None:
        """Find the trios first: one that is found is not taken for another."""
        self.found = {group: self.trio(group, 'xyz')
                      for group in (POSITION, VELOCITY, RATE, FORCE)}
        if self.found[RATE] is None:
            turning = [self.one(rf'(^|_){axis}_?(rate|speed|vel)$') for axis in TURNING]
            if None not in turning:
                self.found[RATE] = turning

    def quaternion(self) -> None:
        self.attitude = None
        letters = self.trio(QUATERNION, 'wxyz')
        if letters:
            q = self.values(letters)
            if not _is_unit(q):
                self.guess.doubts.append(f'q: {_together(letters)} are no unit quaternion')
                return
            self.take(QUATERNION, letters, role='pose', said='attitude')
            self.attitude = _unit(q)
            return
        for entries in ('0123', '1234'):
            numbers = self.trio(QUATERNION, entries)
            if numbers and _is_unit(self.values(numbers)):
                break
        else:
            return
        order = self._order(self.values(numbers))
        if order is None:
            self.guess.doubts.append(f'quaternion: the order of {_together(numbers)} (wxyz, xyzw)')
            order = 'wxyz'
        self.order = order
        self.columns[ATTITUDE] = Column(tuple(numbers))
        self._taken(numbers, 'pose')
        self.guess.said.append(f'{_together(numbers)}: attitude, {order}')
        q = _unit(self.values(numbers))
        self.attitude = q if order == 'wxyz' else q[:, [3, 0, 1, 2]]

    def _order(self, q: np.ndarray) -> str | None:
        """Return wxyz or xyzw by the tilt of what flies, and by the gyro, or None."""
        q = _unit(q)
        readings = {'wxyz': q, 'xyzw': q[:, [3, 0, 1, 2]]}
        tilt = {name: float(np.nanmedian(np.degrees(np.arccos(np.clip(
            1 - 2 * (one[:, 1] ** 2 + one[:, 2] ** 2), -1, 1))))) for name, one in
            readings.items()}
        level = [name for name, angle in tilt.items() if angle < 40]
        if len(level) == 1 and max(tilt.values()) > 60:
            return level[0]
        if self.found[RATE] and self.t is not None:
            gyro = self.values(self.found[RATE])
            alike = {name: _alike(*self.turning(one, gyro)) for name, one in readings.items()}
            best = max(alike, key=alike.get)
            if alike[best] > 0.7 and alike[best] > min(alike.values()) + 0.3:
                return best
        return None

    def angles(self) -> None:
        if self.attitude is not None:
            return
        names = [self.one(pattern) for pattern in ANGLE.values()]
        if None in names:
            return
        values = self.values(names)
        units = {self.units[name] for name in names}
        unit = 'deg' if 'deg' in units else 'rad' if 'rad' in units else angle_unit(values)
        down = self._pitch_down(names, values * factor_of('phi', unit))
        self.take(EULER, names, unit, role='pose', said=f'roll, pitch, yaw in {unit}'
                  + (', pitch with the other sign' if down else ''))
        signs = np.array([1.0, 1.0, 1.0])
        if down:
            self.columns['theta'] = replace(self.columns['theta'], unit=f'-{unit}')
            signs[1] = -1.0
        self.attitude = from_euler(*(values * factor_of('phi', unit) * signs).T)

    def _pitch_down(self, names: Sequence[str], angles: np.ndarray) -> bool:
        """Return whether the pitch of angles (N, 3) rad has the other sign, by gyro or name."""
        named = bool(PITCH_DOWN.search(self.names[names[1]]))
        if not self.found[RATE] or self.t is None:
            return named
        gyro = self.values(self.found[RATE])
        alike = [_alike(*self.turning(from_euler(*(angles * [1.0, sign, 1.0]).T), gyro))
                 for sign in (1.0, -1.0)]
        if max(alike) < 0.7 or abs(alike[1] - alike[0]) < 0.2:
            return named
        return alike[1] > alike[0]

    def rates(self) -> None:
        names = self.found[RATE]
        if names is None or any(name not in self.free for name in names):
            return
        values, unit = self.values(names), self._unit(names, ('rad/s', 'deg/s'))
        if not unit and self.attitude is not None and self.t is not None:
            turned, measured = self.turning(self.attitude, values)
            ratio = _ratio(measured, turned)
            if ratio is not None:
                unit = 'rad/s' if 0.3 < ratio < 4 else 'deg/s' if 15 < ratio < 230 else 'none'
        if unit == 'none':
            self.guess.doubts.append(f'wx: {_together(names)} are {ratio:.3g} times the rates of '
                                     'the attitude, which is no unit')
            unit = 'rad/s'
        if not unit and self._is_weight(values):
            return
        if not unit:
            # What turns by over 35 rad/s is past its gyro; below 12 deg/s nothing manoeuvres.
            fast = float(np.nanquantile(np.abs(values), 0.99))
            unit = 'deg/s' if fast > 35 else 'rad/s' if fast < 12 else ''
        if not unit:
            self.guess.doubts.append(f'wx: the unit of {_together(names)} (rad/s, deg/s)')
            unit = 'rad/s'
        self.take(RATE, names, unit, role='rate', said=f'body rate in {unit}')

    def _is_weight(self, values: np.ndarray) -> bool:
        """Return whether values (N, 3) have one length, as gravity in body axes has."""
        length = np.linalg.norm(values, axis=1)
        usual = float(np.nanmedian(length))
        return usual > 0.5 and float(np.nanstd(length)) < 0.01 * usual

    def positions(self) -> None:
        names = self.found[POSITION]
        if names is None or any(name not in self.free for name in names):
            return
        unit = self._unit(names, ('m', 'mm', 'cm'))
        if not unit and self.t is not None:
            with np.errstate(all='ignore'):
                speed = np.linalg.norm(np.diff(self.values(names), axis=0), axis=1) / self.dt()
            speed = speed[np.isfinite(speed) & (speed > 0)]
            # Multirotors do under 60 m/s.
            unit = 'mm' if len(speed) and np.quantile(speed, 0.9) > 100 else 'm'
            unit = self._by_velocity(names) or unit
        self.take(POSITION, names, unit or 'm', role='pose', said=f'position in {unit or "m"}')

    def _by_velocity(self, names: Sequence[str]) -> str:
        """Return the unit of positions of which the velocity is the change, '' if not told."""
        given = self.found[VELOCITY]
        if given is None:
            return ''
        said = self._unit(given, ('m/s', 'mm/s', 'cm/s')) or 'm/s'
        place, speed = self.values(names), self.values(given) * factor_of('vx', said)
        # Over half a second, where noise of single samples counts for little.
        width = max(1, round(0.5 / max(float(np.nanmedian(self.dt())), 1e-6)))
        if len(place) < 4 * width:
            return ''
        moved = place[width:] - place[:-width]
        sums = np.vstack([np.zeros(3), np.cumsum(np.nan_to_num(
            0.5 * (speed[1:] + speed[:-1]) * self.dt()[:, None]), axis=0)])
        ratio = _ratio(moved, sums[width:] - sums[:-width])
        if ratio is None:
            return ''       # a velocity in body axes of a vehicle that turns, or sparse samples
        for unit, factor in (('m', 1.0), ('cm', 100.0), ('mm', 1000.0)):
            if factor / 2 < ratio < 2 * factor:
                return unit
        self.guess.doubts.append(f'px: {_together(names)} change {ratio:.3g} times as fast as '
                                 f'{_together(given)} says, which is no unit')
        return 'm'

    def forces(self) -> None:
        names = self.found[FORCE]
        if names is None or any(name not in self.free for name in names):
            return
        usual = float(np.nanmedian(np.linalg.norm(self.values(names), axis=1)))
        for unit, one in (('m/s^2', G), ('g', 1.0), ('mg', 1000.0)):
            if 0.6 * one < usual < 1.6 * one:
                self.take(FORCE, names, unit, role='specific_force',
                          said=f'specific force in {unit}')
                return
        if usual < 0.6:
            self.guess.said.append(f'{_together(names)}: not taken, an acceleration without '
                                   'gravity is no specific force')
            self._taken(names, '')
            return
        self.guess.doubts.append(f'ax: the unit of {_together(names)}, {usual:.3g} as a rule')

    def frames(self) -> None:
        """Tell FLU or FRD, and ENU or NED, by where up is."""
        if (self.given.world, self.given.body) != ('ENU', 'FLU'):
            return
        down = None
        why = ''
        if 'az' in self.columns:
            down = bool(np.nanmedian(self.table.columns[self.columns['az'].names[0]]) < 0)
            why = 'the accelerometer'
        elif 'pz' in self.columns:
            height = self.table.columns[self.columns['pz'].names[0]]
            low, high = np.nanquantile(height, [0.05, 0.95])
            if high < 0.3 * abs(low):
                down, why = True, 'the height'
            elif low > -0.3 * abs(high):
                down, why = False, 'the height'
        text = ' '.join(self.names.values())
        if down is None and re.search(r'(^|_| )(ned|frd)(_| |$)', text):
            down, why = True, 'the names'
        if down:
            self.body = 'FRD'
            level = self.attitude is None or _up(self.attitude) > 0
            self.world = 'NED' if level else 'ENU'
        elif down is not None and self.attitude is not None and _up(self.attitude) < 0:
            self.guess.doubts.append('world, body: by the attitude the vehicle flies upside down')
        said = f'by {why}' if why else 'taken, as nothing tells'
        self.guess.said.append(f'frames {self.world} and {self.body}, {said}')

    def velocities(self) -> None:
        names = self.found[VELOCITY]
        if names is None or any(name not in self.free for name in names):
            return
        values = self.values(names)
        unit = self._unit(names, ('m/s', 'mm/s', 'cm/s'))
        if not unit:
            fast = float(np.nanquantile(np.abs(values), 0.9))
            unit = 'mm/s' if fast > 100 else 'm/s'
        frame, said = 'world', 'as no stream tells otherwise'
        if any('body' in self.names[name] for name in names):
            frame, said = 'body', 'by its name'
        off = self._off(values * factor_of('vx', unit))
        if off is not None and max(off) > 1.5 * min(off):
            frame = 'world' if off[0] < off[1] else 'body'
            said = 'by the position' if 'px' in self.columns else 'by the accelerometer'
        self.take(VELOCITY, names, unit, frame, role='velocity',
                  said=f'velocity in {unit}, {frame} axes, {said}')

    def _off(self, speed: np.ndarray) -> list[float] | None:
        """Return how far off a velocity (N, 3) is, read in world and in body axes, or None."""
        if self.attitude is None or self.t is None:
            return None
        q = _unit(self.attitude)
        readings = speed, frames.rotate(q, speed)
        with np.errstate(all='ignore'):
            dt = np.diff(self.t)[:, None]
            if 'px' in self.columns:
                moved = np.diff(self.scaled(POSITION), axis=0)
                rest = [moved - 0.5 * (one[1:] + one[:-1]) * dt for one in readings]
            elif 'ax' in self.columns:
                weight = np.array([0.0, 0.0, G if self.world == 'NED' else -G])
                force = frames.rotate(q, self.scaled(FORCE)) + weight
                rest = [np.diff(one, axis=0) - 0.5 * (force[1:] + force[:-1]) * dt
                        for one in readings]
            else:
                return None
            # Over half a second, where noise of single samples counts for little.
            width = max(1, round(0.5 / max(float(np.nanmedian(dt)), 1e-6)))
            if len(speed) < 4 * width:
                return None
            sums = [np.cumsum(np.nan_to_num(one), axis=0) for one in rest]
            off = [float(np.median(np.linalg.norm(one[width:] - one[:-width], axis=1)))
                   for one in sums]
        return off if np.isfinite(off).all() else None

    def motors(self) -> None:
        measured = self._numbered(SPEED)
        if measured:
            values = self.logged(measured)
            unit = self._unit(measured, ('rad/s', 'rpm')) or (
                'rpm' if any('rpm' in self.names[name] for name in measured) else 'rad/s')
            if np.nanmin(values) >= 0 and np.nanmedian(values) > SLOWEST:
                self.take([f'rotor{k}' for k in range(1, len(measured) + 1)], measured, unit,
                          role='rotors', said=f'measured rotor speeds in {unit}')
        names = self._numbered(MOTOR) or self._corners()
        if not names:
            return
        values = self.logged(names)
        kinds = kinds_of(values)
        if FORCES.search(self.names[names[0]]) and list(kinds) != ['normalised']:
            return
        unit = self._unit(names, ('rad/s', 'rpm'))
        if unit:
            self.take([f'cmd{k}' for k in range(1, len(names) + 1)], names, unit,
                      role='commands', said=f'rotor speed commands in {unit}')
            return
        if CRAZYFLIE.fullmatch(self.names[names[0]]) and list(kinds) == ['duty16']:
            self.guess.motors = about_motors(quad(*AROUND), 'the order of the Crazyflie', 'duty16')
        what = ' or '.join(TITLES[kind] for kind in kinds)
        self.take([f'output{k}' for k in range(1, len(names) + 1)], names, role='commands',
                  said='outputs, ' + (f'{what} by their size' if what else 'of an unknown kind'))

    def _corners(self) -> list[str] | None:
        """Return the columns of four motors by their places, from front right to front left."""
        found = [self.one(CORNER.format(pattern)) for pattern in CORNERS.values()]
        if None in found or len(set(found)) < 4:
            return None
        self.guess.motors = about_motors(quad(*AROUND), 'the names of the columns')
        return found

    def battery(self) -> None:
        name = self.one(BATTERY.pattern)
        if name is None:
            return
        usual = float(np.nanmedian(self.table.columns[name]))
        unit = 'mV' if usual > 1000 else 'V'
        if 2 < usual * factor_of('vbat', unit) < 100:
            self.take(('vbat',), (name,), unit, role='battery', said=f'battery in {unit}')

    def _unit(self, names: Sequence[str], known: Sequence[str]) -> str:
        units = {self.units[name] for name in names}
        units = {{'deg': 'deg/s', 'rad': 'rad/s'}.get(one, one) if 'deg/s' in known else one
                 for one in units}
        return units.pop() if len(units) == 1 and units <= set(known) else ''

    def _numbered(self, pattern: re.Pattern) -> list[str] | None:
        """Return the columns of 3 to 12 numbers from 0 or 1 on, of one name, or None."""
        groups = {}
        for name in self.free:
            match = pattern.search(self.names[name])
            if match:
                groups.setdefault(self.names[name][:match.start(3)], {})[
                    int(match.group(3))] = name
        whole = []
        for prefix, group in groups.items():
            first = min(group)
            count = next(k for k in range(len(group) + 1) if first + k not in group)
            names = [group[first + k] for k in range(count)]
            moving = [np.nanstd(self.table.columns[name]) > 0 for name in names]
            while len(names) > 3 and any(moving) and not moving[len(names) - 1]:
                names.pop()     # channels that nothing is on
            if first in (0, 1) and 3 <= len(names) <= 12:
                whole.append((len(prefix), names))
        return min(whole)[1] if whole else None


def time_unit(values: np.ndarray) -> str:
    """Return the unit of times by their size and steps: s, ms, us, ns, or ''."""
    finite = values[np.isfinite(values)]
    steps = np.diff(finite)
    steps = steps[steps > 0]
    if not len(steps):
        return ''
    start, step = abs(float(finite[0])), float(np.median(steps))
    # Since 1970, in whatever unit: 2001 to 2100.
    for unit, factor in (('s', 1.0), ('ms', 1e3), ('us', 1e6), ('ns', 1e9)):
        if 1e9 * factor <= start <= 4.1e9 * factor:
            rate = factor / step
            return unit if RATES[0] / 5 <= rate <= 2 * RATES[1] else ''
    fits = [unit for unit, factor in (('s', 1.0), ('ms', 1e3), ('us', 1e6), ('ns', 1e9))
            if 10.0 <= factor / step <= 4000.0]
    if len(fits) > 1:       # steps of 0.25 to 0.4 of one, 250 to 400 of the other
        fits = [unit for unit in fits if unit != 's']
    return fits[0] if fits else ('s' if RATES[0] / 5 <= 1 / step else '')


def angle_unit(values: np.ndarray) -> str:
    """Return rad or deg of roll, pitch and yaw (N, 3): nobody flies tilted by a radian."""
    tilt = float(np.nanquantile(np.abs(values[:, :2]), 0.9))
    return 'deg' if tilt > 1.0 or np.nanmax(np.abs(values)) > 6.5 else 'rad'


def _rises(values: np.ndarray) -> bool:
    finite = values[np.isfinite(values)]
    steps = np.diff(finite)
    return len(steps) > 0 and (steps >= 0).mean() > 0.9 and finite[-1] > finite[0]


def _is_clock(values: np.ndarray) -> bool:
    """Return whether values rise in steps of one size as a time does, and are no counts."""
    steps = np.diff(values[np.isfinite(values)])
    if len(steps) < 10 or (steps <= 0).any() or (steps == 1).all():
        return False
    usual = float(np.median(steps))
    return bool(np.mean(np.abs(steps - usual) < 0.5 * usual) > 0.9) and bool(time_unit(values))


def _but(found: Sequence[str]) -> str:
    """Return which columns have the name of a time, and do not rise."""
    return f' ({_together(found)} does not)' if found else ''


def _together(names: Sequence[str]) -> str:
    names = [name[:30] for name in names]
    return f'{names[0]} to {names[-1]}' if len(names) > 4 else ', '.join(names)


def _is_unit(q: np.ndarray) -> bool:
    norm = np.linalg.norm(q, axis=-1)
    norm = norm[np.isfinite(norm)]
    return len(norm) > 1 and np.mean(np.abs(norm - 1.0) < 0.02) > 0.95


def _unit(q: np.ndarray) -> np.ndarray:
    with np.errstate(all='ignore'):
        return q / np.linalg.norm(q, axis=-1, keepdims=True)


def _up(q: np.ndarray) -> float:
    """Return the median share of up along the body's own z axis."""
    return float(np.nanmedian(1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2)))


def _turned(q: np.ndarray, later: np.ndarray) -> np.ndarray:
    """Return the turns (N, 3) rad in the body from attitudes to later ones."""
    turn = frames.multiply(frames.conjugate(q), later)
    turn = turn * np.where(turn[:, :1] < 0, -1.0, 1.0)
    return 2.0 * turn[:, 1:]


def _filled(values: np.ndarray) -> np.ndarray:
    """Return values (N,) without gaps, those before the first and after the last left out."""
    known = np.isfinite(values)
    if known.all() or known.sum() < 2:
        return values
    rows = np.arange(len(values))
    return np.interp(rows, rows[known], values[known], left=np.nan, right=np.nan)


def _alike(one: np.ndarray, other: np.ndarray) -> float:
    """Return the correlation of two streams (N, 3), all axes together."""
    use = np.isfinite(one).all(axis=1) & np.isfinite(other).all(axis=1)
    if use.sum() < 10:
        return 0.0
    a, b = one[use] - one[use].mean(axis=0), other[use] - other[use].mean(axis=0)
    norm = np.linalg.norm(a) * np.linalg.norm(b)
    return float(np.sum(a * b) / norm) if norm > 0 else 0.0


def _ratio(one: np.ndarray, other: np.ndarray) -> float | None:
    """Return how much larger one stream (N, 3) is than another, or None where they differ."""
    use = np.isfinite(one).all(axis=1) & np.isfinite(other).all(axis=1)
    if use.sum() < 10 or abs(_alike(one, other)) < 0.5:
        return None
    return float(np.std(one[use]) / max(np.std(other[use]), 1e-12))
