# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""From a flight record to the four input-output pairs that are identified."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np

from quad_ident_ros.data.cutting import options, without
from quad_ident_ros.data.info import LARGEST
from quad_ident_ros.data.record import (
    EULER,
    FlightRecord,
    INPUTS,
    MOMENTS,
    QUATERNION,
    SATURATED,
)
from quad_ident_ros.errors import InputError
from quad_ident_ros.schema import numbers

OUTPUTS = ('phi', 'theta', 'psi', 'z')
INPUT_OF = {'phi': 'U2', 'theta': 'U3', 'psi': 'U4', 'z': 'U1'}
OUTPUT_UNITS = {'phi': 'rad', 'theta': 'rad', 'psi': 'rad', 'z': 'm'}
GAIN_UNITS = {'phi': 'rad/s^2/N', 'theta': 'rad/s^2/N', 'psi': 'rad/s^2/(N m)', 'z': 'm/s^2/N'}

# Sample times off the grid by less than this share of a period count as on it.
GRID_TOLERANCE = 1e-3
FEWEST = 8          # samples that a record needs
LONGEST_GAP = 10    # periods that interpolation may bridge
TILT_MATTERS = 1e-3     # of an input's largest deviation that the tilt takes of it
LARGEST_PERIOD = 1e9    # s between samples; 1 / LARGEST_PERIOD is the shortest
NO_ARM = ('roll and pitch are not identified: the record has moments in N m, which an arm '
          'length makes U2 and U3; name the vehicle (--vehicle, or the parameter vehicle)')
MISSING_SHARE = 0.2  # of the samples that interpolation may fill


@dataclass(frozen=True)
class Signal:
    """
    One input-output pair on an even grid: deviations u (N,) from trim and y (N,) from the start.

    at_rest: the vehicle was at rest at the first sample, at y = 0 where level_known;
    measured (N,) which samples of y there are, by default all; start_ns is the stamp of the first;
    trim: what u deviates from; attitude (N, 3) roll, pitch and yaw, rad, where recorded; saturated
    (N,) where the input is beyond the limits of the rotors, by default nowhere.
    """

    output: str
    t: np.ndarray
    u: np.ndarray
    y: np.ndarray
    period: float
    at_rest: bool
    level_known: bool = True
    measured: np.ndarray = field(default_factory=lambda: np.empty(0, bool))
    start_ns: int | None = None
    trim: float = 0.0
    attitude: np.ndarray | None = None
    saturated: np.ndarray | None = None

    def __post_init__(self) -> None:
        """Take all samples as measured unless stated otherwise."""
        if not len(self.measured):
            object.__setattr__(self, 'measured', np.ones(len(self.y), bool))

    @property
    def samples(self) -> int:
        """How many samples of y were measured."""
        return int(np.count_nonzero(self.measured))

    @property
    def unknowns(self) -> int:
        """
        How many numbers beside the model the response depends on.

        0 none, 1 the level at rest, 2 initial output and rate, 3 a constant disturbance too: where
        y is zero, in a record that begins anywhere, nothing is in balance.
        """
        if self.at_rest:
            return 0 if self.level_known else 1
        # Under an input that never changes a disturbance and the gain are one number.
        return 2 if np.all(self.u[:-1] == self.u[0]) else 3


def signals(record: FlightRecord, *, trim: Sequence[float] | None = None,
            outputs: Collection[str] | None = None, initial_state: str = 'auto'
            ) -> tuple[list[Signal], list[str]]:
    """
    Return the pairs of a record whose input is excited, and remarks on the data.

    Args: trim: inputs U1..U4 from which deviations count, by default the record's own
    (`info['trim']`) or else the first sample's; outputs: names to identify, by default the
    record's own or all; initial_state 'rest', 'free' or 'auto' (rest where the record says that
    it starts so). A flight that begins anywhere has the vertical part of U1 as the input of z (see
    vertical_share); one from rest is the paper's experiment, with U1 itself. Angles that jump by
    more than half a turn are unwrapped, unless the record says (`info['unwrapped']`) that they
    turn so fast.
    Returns (list of Signal, list of str). Raises InputError for missing columns, too few samples
    or gaps that cannot be bridged.
    """
    if len(record) < FEWEST:
        raise InputError(f'{record.label()} has {len(record)} samples; at least {FEWEST} are '
                         'needed')
    inputs, measured, there = _columns(record)
    _check_size(record.t, inputs, measured)
    t, inputs, measured, there_at, remarks = _even_grid(record.t, inputs, measured)
    jumps = np.abs(np.diff(measured[:, :3], axis=0)).max() > np.pi
    if jumps and not record.info.get('unwrapped'):
        measured[:, :3] = np.unwrap(measured[:, :3], axis=0)
        remarks.append('the angles jump by more than half a turn: they were unwrapped')
    if record.has(*MOMENTS) and not record.has('u2', 'u3'):
        remarks.append(NO_ARM)
    if record.info.get('truncated'):
        remarks.append('the last line of the file has no line end and was left out')
    at_rest = bool(record.info.get('starts_at_rest')) if initial_state == 'auto' \
        else initial_state == 'rest'
    if trim is None:
        trim = record.info.get('trim')
    attitude = measured[:, :3].copy() if _has_attitude(record) else None
    if attitude is not None and not at_rest:
        vertical = _vertical(inputs[:, 0], attitude, inputs[0, 0] if trim is None else trim[0])
        inputs = np.column_stack([vertical, inputs[:, 1:]])
    if trim is None:
        trim = inputs[0]
        remarks.append('the record says no trim: inputs count from their first sample')
    trim = numbers('trim', list(trim), len(INPUTS), -LARGEST, LARGEST)
    deviation = inputs - np.asarray(trim)
    known = record.info.get('initial', {}) if at_rest else {}
    start = [known.get(name, measured[0, i]) for i, name in enumerate(OUTPUTS)]
    wanted = outputs or record.info.get('outputs') or OUTPUTS
    found = []
    for name in there:
        i = OUTPUTS.index(name)
        u = deviation[:, int(INPUT_OF[name][1]) - 1]
        # The last input acts after the last sample, so it excites nothing.
        if name not in wanted or np.abs(u[:-1]).max() <= 1e-9 * (1 + np.abs(trim).max()):
            continue
        if np.ptp(measured[:, i]) > 0:
            found.append(Signal(name, t - t[0], np.ascontiguousarray(u),
                                measured[:, i] - start[i], float(t[1] - t[0]), at_rest,
                                level_known=name in known, measured=there_at,
                                start_ns=record.info.get('start_ns'),
                                trim=float(trim[int(INPUT_OF[name][1]) - 1]),
                                attitude=attitude, saturated=_saturated(record, t)))
        else:
            remarks.append(f'{name} does not move: there is nothing to identify in it')
    return found, remarks


def _saturated(record: FlightRecord, t: np.ndarray) -> np.ndarray | None:
    """Return where the input held at times t (N,) of the grid is beyond the rotors, or None."""
    if not record.has(SATURATED):
        return None
    last = np.clip(np.searchsorted(record.t, t + 1e-9, side='right') - 1, 0, None)
    return record.columns[SATURATED][last] > 0


def vertical_share(phi: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """
    Return the share of the thrust that acts along the vertical while each input is held, (N,).

    Args: phi, theta (N,) rad. The thrust U1 acts along body z, whose vertical part in the rotation
    matrix of eq. (2) is cos(phi) cos(theta), so that eq. (18) reads m z'' = cos(phi) cos(theta) U1
    - m g - Kftz z'. An input is held over a sample in which the tilt goes on: the mean of its two
    ends counts.
    """
    share = np.cos(phi) * np.cos(theta)
    return np.append((share[:-1] + share[1:]) / 2, share[-1])


def _has_attitude(record: FlightRecord) -> bool:
    return record.has(*EULER) or record.has(*QUATERNION)


def _vertical(thrust: np.ndarray, attitude: np.ndarray, trim: float) -> np.ndarray:
    """Return the vertical part of U1 (N,), or U1 where the tilt takes next to nothing of it."""
    vertical = vertical_share(attitude[:, 0], attitude[:, 1]) * thrust
    most = np.abs(thrust[:-1] - trim).max()
    if most <= 1e-9 * (1 + np.abs(thrust).max()):
        most = np.abs(thrust).max()
    # Without a tilt to speak of, the attitude's noise would but spoil an input that is exact.
    return vertical if np.abs(thrust - vertical)[:-1].max() > TILT_MATTERS * most else thrust


def _check_size(t: np.ndarray, inputs: np.ndarray, measured: np.ndarray) -> None:
    """Raise InputError for numbers whose squares and ratios no longer fit into a double."""
    largest = max(np.abs(inputs).max(), np.abs(measured).max())
    if largest > LARGEST:
        raise InputError(f'the record holds a value of {largest:.3g}; above {LARGEST:g} nothing '
                         'can be computed: '
                         + without(t, np.abs(np.hstack([inputs, measured])).max(axis=1) > LARGEST,
                                   'check the units'))
    steps = np.diff(t)
    if steps.min() < 1 / LARGEST_PERIOD or steps.max() > LARGEST_PERIOD:
        raise InputError(f'the samples are {steps.min():.3g} to {steps.max():.3g} s apart; '
                         f'expected {1 / LARGEST_PERIOD:g} to {LARGEST_PERIOD:g} s: check the '
                         'unit of t')


def _columns(record: FlightRecord) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """
    Return inputs (N, 4), outputs (N, 4), and the names of the outputs that can be identified.

    Those that are not recorded, or whose input is not, are zero. Raises InputError where none is.
    """
    recorded = {f'U{i}': record.has(f'u{i}') for i in range(1, 5)}
    euler = _has_attitude(record)
    there = [name for name in OUTPUTS
             if recorded[INPUT_OF[name]] and (record.has('pz') if name == 'z' else euler)]
    if not there:
        if not any(recorded.values()) and record.has('cmd1'):
            raise InputError(f'{record.label()} has rotor commands and no inputs u1..u4: name its '
                             'vehicle, from which they follow (--vehicle)')
        if euler and record.has(*MOMENTS):
            raise InputError(NO_ARM)
        if not any(recorded.values()):
            record.inputs()
        if not euler and not record.has('pz'):
            record.euler()
        raise InputError(f'{record.label()} has no output together with its input: roll needs u2, '
                         'pitch u3, yaw u4, and altitude pz with u1')
    none = np.zeros(len(record))
    inputs = np.column_stack([record.columns.get(f'u{i}', none) for i in range(1, 5)])
    angles = record.euler() if euler else np.zeros((len(record), 3))
    return inputs, np.column_stack([angles, record.columns.get('pz', none)]), there


def _even_grid(t: np.ndarray, inputs: np.ndarray, measured: np.ndarray
               ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, list[str]]:
    """Return times, inputs and outputs on an even grid, where they were measured, and remarks."""
    steps = np.diff(t)
    period = float(np.median(steps))
    place = np.concatenate([[0], np.cumsum(np.maximum(1, np.round(steps / period)))]).astype(int)
    grid = t[0] + (t[-1] - t[0]) / place[-1] * np.arange(place[-1] + 1)
    fits = np.abs(t - grid[place]).max() <= GRID_TOLERANCE * period
    if fits and len(grid) == len(t):
        return grid, inputs, measured, np.ones(len(t), bool), []
    if steps.max() > (LONGEST_GAP + 0.5) * period:
        k = int(np.argmax(steps))
        raise InputError(f'the record has a gap of {steps[k]:.3g} s after t = {t[k]:.6g} s '
                         f'({steps[k] / period:.0f} periods; at most {LONGEST_GAP} can be '
                         f'bridged): leave out what is after it, {options(t, 0, k)}, or before '
                         f'it, {options(t, k + 1, len(t) - 1)}')
    if not fits:
        grid = np.arange(t[0], t[-1] + GRID_TOLERANCE * period, period)
    missing = len(grid) - len(t)
    if missing > MISSING_SHARE * len(grid):
        raise InputError(f'{missing} of {len(grid)} samples are missing; at most '
                         f'{100 * MISSING_SHARE:.0f} % can be filled: record again with a '
                         'deeper queue')
    columns = np.column_stack([np.interp(grid, t, column) for column in measured.T])
    there = np.ones(len(grid), bool)
    if fits:
        there[:] = False
        there[place] = True
        held = np.repeat(np.arange(len(t)), np.diff(place, append=place[-1] + 1))
        return grid, inputs[held], columns, there, [
            f'{missing} of {len(grid)} samples are missing: the fit goes without them, with the '
            'input taken as held']
    remark = (f'sample times are uneven ({steps.min():.4g} to {steps.max():.4g} s): resampled to '
              f'{period:.4g} s, {max(missing, 0)} samples filled by interpolation')
    gaps = steps > 1.5 * period
    changed = np.count_nonzero(np.any(np.diff(inputs, axis=0)[gaps] != 0, axis=1))
    if changed:
        remark += (f'; an input differs between the two sides of {changed} of '
                   f'{np.count_nonzero(gaps)} gaps, and the standard errors do not allow for the '
                   'unknown time of the change')
    return grid, _mean_inputs(t, inputs, grid), columns, there, [remark]


def _mean_inputs(t: np.ndarray, inputs: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """
    Return the means of held inputs over the steps of a grid, (M, k).

    A change between two grid times would act up to a period late if the grid's inputs were looked
    up; the mean keeps its impulse.
    """
    change = inputs - inputs[0]
    area = np.concatenate([np.zeros((1, inputs.shape[1])),
                           np.cumsum(change[:-1] * np.diff(t)[:, None], axis=0)])
    at_grid = np.column_stack([np.interp(grid, t, column) for column in area.T])
    means = np.diff(at_grid, axis=0) / np.diff(grid)[:, None]
    return inputs[0] + np.concatenate([means, change[-1:]])
