# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The flight record: the samples of one flight, by column name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import re
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.cutting import without
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import euler_from_quaternion, unwrap_euler

KNOWN = {
    't': 's',
    'px': 'm', 'py': 'm', 'pz': 'm',
    'vx': 'm/s', 'vy': 'm/s', 'vz': 'm/s',
    'qw': '1', 'qx': '1', 'qy': '1', 'qz': '1',
    'wx': 'rad/s', 'wy': 'rad/s', 'wz': 'rad/s',
    'ax': 'm/s^2', 'ay': 'm/s^2', 'az': 'm/s^2',
    'vbat': 'V',
    'u1': 'N', 'u2': 'N', 'u3': 'N', 'u4': 'N m',
    'moment_x': 'N m', 'moment_y': 'N m',
    'phi': 'rad', 'theta': 'rad', 'psi': 'rad',
}
"""Unit of each column that the flight record format names, but cmd1..N and rotor1..N."""

INPUTS = ('u1', 'u2', 'u3', 'u4')
MOMENTS = ('moment_x', 'moment_y')
"""What u2 and u3 are at the arm, where a record says no arm length."""

ARM = 'arm_length'
"""Info of a record: the arm length l (m) that makes u2 and u3 moments."""

REFERENCE = {'px_ref': 'm', 'py_ref': 'm', 'pz_ref': 'm', 'yaw_ref': 'rad'}
"""Unit of each column of what the controller was asked for, in the world; its gaps are nan."""

SATURATED = 'saturated'
"""Column: 1 where U1..U4 ask a rotor for more than its limits, else 0."""

QUATERNION = ('qw', 'qx', 'qy', 'qz')
EULER = ('phi', 'theta', 'psi')

RESOLUTION = 1e-12  # s: a float of an hour has half of it; shorter steps end in infinite quotients

_ROTOR_COLUMN = re.compile(r'(cmd|rotor)[1-9][0-9]*')


class Fault(NamedTuple):
    """A value that a flight record may not hold: its column and sample (0-based), and why."""

    column: str
    sample: int
    problem: str
    remedy: str


def unit(name: str) -> str | None:
    """Return the unit of a known column (str), or None for an unknown one."""
    return 'rad/s' if _ROTOR_COLUMN.fullmatch(name) else KNOWN.get(name)


def find_fault(t: np.ndarray, columns: Mapping[str, np.ndarray]) -> Fault | None:
    """
    Return the first value that a flight record may not hold.

    Args: t (N,) s; columns name -> (N,) in the unit of the name.
    Returns a Fault, or None: t is finite and grows by more than RESOLUTION, known columns are
    finite.
    """
    for name, values in {'t': t, **columns}.items():
        if unit(name) is not None and not np.isfinite(values).all():
            k = int(np.argmin(np.isfinite(values)))
            return Fault(name, k, f'{values[k]} is not a finite number',
                         'fill in the value, or leave the sample out')
    stuck = ~_later(t[1:], t[:-1])
    if stuck.any():
        k = int(np.argmax(stuck)) + 1
        if t[k] > t[k - 1]:
            return Fault('t', k, f'{t[k]} s comes less than a picosecond after {t[k - 1]} s',
                         'give the times in seconds, one sample of each')
        return Fault('t', k, f'{t[k]} s does not come after {t[k - 1]} s',
                     'put the samples into the order of time, one of each')
    return None


def faulty(t: np.ndarray, columns: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return whether a sample (N,) has to go so that find_fault finds nothing; its arguments."""
    wrong = ~np.isfinite(t)
    for name, values in columns.items():
        if unit(name) is not None:
            wrong |= ~np.isfinite(values)
    latest = np.maximum.accumulate(np.where(wrong, -np.inf, t))
    wrong[1:] |= ~_later(t[1:], latest[:-1])
    return wrong


def _later(t: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return whether each time is more than RESOLUTION after one before it."""
    with np.errstate(over='ignore', invalid='ignore'):
        return t - before > RESOLUTION


CUT = ('the last line of the file has no line end and was left out: a recording that was cut off '
       'there may have cut its last number')
"""What the info `truncated` of a record means."""

SPOILT = 'spoilt'
"""
Info of a record that is read for a part of it: [time in s, error] of each sample that was left out
because no record can hold it. It is an error where that part has the time (data.selection).
"""

NOTED = 'commands', 'logging'
"""
Info of a record: those of its notes that a diagnosis reports, too.

commands: what the outputs to the motors were taken for; logging: what was logged too seldom or
without valid estimates.
"""

DENSEST = 1000.0    # times that the mean step may be the usual one, in a record with gaps
STRAY = 3           # steps over bad stamps or the longest gaps, that the mean does not count

# What holds for a record only from its first sample on.
FIRST_SAMPLE_INFO = ('starts_at_rest', 'initial')


@dataclass(frozen=True, eq=False)
class FlightRecord:
    """
    One flight: sample times and the columns of the flight record format, known or not.

    Args: t (N,) s, finite, strictly increasing, N >= 2; columns name -> (N,) float64 in the unit
    of the name (see unit), finite where the name is known; info provenance, JSON-able, for
    example name, trim, vehicle, source, dropped.
    The arrays are read-only views of those given. Raises InputError where the above is not so.
    """

    t: np.ndarray
    columns: Mapping[str, np.ndarray]
    info: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the samples and make them read-only float64 arrays."""
        object.__setattr__(self, 'info', dict(self.info))
        t = self._checked('t', self.t, None)
        if len(t) < 2:
            raise InputError(f'{self.label()} has {counted(len(t), "sample")}; at least 2 are '
                             'needed')
        columns = {name: self._checked(name, values, len(t))
                   for name, values in self.columns.items()}
        fault = find_fault(t, columns)
        if fault is not None:
            raise InputError(f'{self.label()}, sample {fault.sample}, column {fault.column!r}: '
                             f'{fault.problem}; {fault.remedy}')
        object.__setattr__(self, 't', t)
        object.__setattr__(self, 'columns', columns)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.t)

    def has(self, *names: str) -> bool:
        """Return whether the record has all of the named columns (it always has t)."""
        return all(name == 't' or name in self.columns for name in names)

    def numbered(self, prefix: str) -> list[str]:
        """Return the names prefix1, prefix2, ... of the columns, as far as they go."""
        names: list[str] = []
        while self.has(f'{prefix}{len(names) + 1}'):
            names.append(f'{prefix}{len(names) + 1}')
        return names

    def stack(self, *names: str) -> np.ndarray:
        """Return the named columns side by side, (N, k); InputError names those missing."""
        missing = [name for name in names if not self.has(name)]
        if missing:
            raise InputError(f'{self.label()} has no column {", ".join(missing)}; it has: '
                             f'{", ".join(["t", *self.columns])}')
        return np.stack([self.t if name == 't' else self.columns[name] for name in names], axis=-1)

    def inputs(self) -> np.ndarray:
        """Return the paper's inputs U1..U4, (N, 4) N, N, N, N m; InputError without them."""
        return self.stack(*INPUTS)

    def euler(self) -> np.ndarray:
        """
        Return roll, pitch and yaw without jumps, (N, 3) rad.

        They are the columns phi, theta, psi, or else made from the quaternion, starting from its
        first sample with pitch in [-pi/2, pi/2]. Raises InputError where it has neither, or
        where a quaternion is no attitude.
        """
        if self.has(*EULER):
            return self.stack(*EULER)
        if not self.has(*QUATERNION):
            raise InputError(f'{self.label()} has no attitude; give the columns qw, qx, qy, qz '
                             'or phi, theta, psi')
        quaternion = self.stack(*QUATERNION)
        norm = np.linalg.norm(quaternion, axis=-1)
        if norm.min() < 1e-3:
            raise InputError(f'{self.label()}, sample {int(norm.argmin())}, columns qw..qz: the '
                             'quaternion is zero; '
                             + without(self.t, norm < 1e-3, 'fill in its attitude'))
        folded = euler_from_quaternion(quaternion / norm[:, None])
        return unwrap_euler(folded, folded[0])

    def slice(self, start: int, stop: int | None = None) -> 'FlightRecord':
        """Return the record of samples start..stop - 1, counted as Python slices do."""
        part = slice(start, stop)
        return FlightRecord(self.t[part],
                            {name: values[part] for name, values in self.columns.items()},
                            self.info)

    def last(self, seconds: float) -> 'FlightRecord':
        """Return the record of the samples of the last seconds (s); all where it is shorter."""
        return self.starting(int(np.searchsorted(self.t, self.t[-1] - seconds)))

    def starting(self, first: int) -> 'FlightRecord':
        """Return the record from a sample on, which beyond the first does not begin at rest."""
        if first == 0:
            return self
        part, shift = self.slice(first), self.t[first] - self.t[0]
        info = {key: value for key, value in self.info.items() if key not in FIRST_SAMPLE_INFO}
        if 'start_ns' in info:
            info['start_ns'] = int(info['start_ns'] + round(shift * 1e9))
        return FlightRecord(part.t, part.columns, info)

    def period(self) -> float:
        """
        Return the median time between samples, s, of bursts at least a DENSEST-th of the mean.

        What looks at a time of so many periods thereby looks at no more samples than it can hold.
        """
        steps = np.diff(self.t)
        count = max(1, len(steps) - STRAY)
        rest = np.partition(steps, count - 1)[:count]
        return float(max(np.median(steps), rest.mean() / DENSEST))

    def label(self) -> str:
        """Return what messages call the record: its source, or its name."""
        source = self.info.get('source') or self.info.get('name')
        return f'{source}' if source else 'the flight record'

    def _checked(self, name: object, values: ArrayLike, length: int | None) -> np.ndarray:
        if not isinstance(name, str) or not name.isprintable() or name != name.strip() or not name:
            raise InputError(f'{self.label()}: {str(name)[:40]!r} is not a column name; use '
                             'printable text without spaces around it')
        if length is not None and name == 't':
            raise InputError(f'{self.label()}: the columns repeat t; give it once')
        try:
            array = np.asarray(values, dtype=float).view()
        except (TypeError, ValueError):
            raise InputError(f'{self.label()}, column {name!r}: the values are not numbers; '
                             'give numbers or leave the column out') from None
        if array.ndim != 1 or (length is not None and len(array) != length):
            raise InputError(f'{self.label()}, column {name!r}: shape {array.shape} does not '
                             f'fit; give one value for each sample, {length or "(N,)"}')
        array.flags.writeable = False
        return array


def same_flight(one: FlightRecord, other: FlightRecord) -> bool:
    """Return whether two records have the same samples."""
    return len(one) == len(other) and np.array_equal(one.t, other.t) and all(
        name in other.columns and np.array_equal(values, other.columns[name])
        for name, values in one.columns.items())


def refuse_twice(records: Sequence[FlightRecord]) -> None:
    """Raise InputError where a flight is given twice: errors would seem smaller than they are."""
    for k, record in enumerate(records):
        if any(same_flight(record, other) for other in records[:k]):
            name = record.info.get('source') or record.info.get('name', 'a flight')
            raise InputError(f'{name}: this flight is given twice; give each once')
