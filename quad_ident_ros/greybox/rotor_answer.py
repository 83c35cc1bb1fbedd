# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How measured rotor speeds answer their commands: delay, lag and sag, whatever the body does."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy

from quad_ident_ros.data.commands import BY_SPEEDS
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import EFFECTS, NULL, titled, Values
from quad_ident_ros.greybox.flights import BRIDGED, GAP, RATE
from quad_ident_ros.greybox.normal import BLOCK
from quad_ident_ros.model.actuators import actuated, DELAY, LAG

MOST = 20_000           # samples, from the middle of a stretch: more show nothing new
LEAST_RATE = 40.0       # Hz of measured speeds; slower ones do not show lags
COPY, COPIED = 1e-9, 1e-4   # of the variance, and s: residual and delay of a copy of the
                            # commands, which no sensor measures
DELAYS, LAGS = np.arange(-0.02, 0.121, 0.01), np.array([0.0, 0.01, 0.02, 0.04, 0.08, 0.16])
SPARSE = slice(None, None, 4)   # samples that tell which of these are nearest
SMALL = 0.5 / RATE      # s: half a sample of what a diagnosis looks at
FINEST = 1e-5           # s: no clock is finer

OF_MOTORS = tuple(name for name, effect in EFFECTS.items() if effect.actuator)
"""Effects of what the motors make of commands."""

NO_COMMANDS = Finding(
    'rotor_speeds', 'info', 'rotor1, rotor2, ...',
    'the record has no commands, so the measured rotor speeds drive the model; the response of '
    f'the motors is not visible: {" and ".join(map(titled, OF_MOTORS))}',
    'log the commands as well to have the motors diagnosed')
"""What is said of a record that is_driven_by_speeds."""


@dataclass(frozen=True)
class RotorAnswer:
    """
    What measured speeds say of the actuators of a flight, each with its standard error.

    delay, lag (s): of the speeds behind the commands, by one lag up and down; gain: of the speed
    over the command; per_volt (1/V): share by which a speed rises with the battery's voltage at
    one command, or None without it; explained: share of the spread of the speeds.
    """

    delay: tuple[float, float]
    lag: tuple[float, float]
    gain: tuple[float, float]
    per_volt: tuple[float, float] | None
    explained: float

    def said(self) -> str:
        """Return it in words."""
        text = (f'measured rotor speeds follow the commands {_ms(self.delay)} late, with a lag of '
                f'{_ms(self.lag)}, and change {self.gain[0]:.3f} ± {self.gain[1]:.3f} times '
                'as much')
        if self.per_volt is not None:
            text += (f'; at one command they change by {100 * self.per_volt[0]:.2f} ± '
                     f'{100 * self.per_volt[1]:.2f} % per volt')
        return text


def is_driven_by_speeds(record: FlightRecord) -> bool:
    """Return whether the commands of a record are its measured rotor speeds."""
    return bool(record.info.get(BY_SPEEDS))


def ruled_out_by(answers: Iterable[RotorAnswer | None], sure: float,
                 effects: Values | None = None) -> tuple[str, ...]:
    """
    Return the effects of the actuators that measured speeds of the flights speak against.

    Those whose time may be that of the vehicle file's effects, by default none, and surely differs
    from it by less than a diagnosis resolves, by all flights together, and in none of them surely
    by more. Speeds do not speak of a lag that the file has by another law than theirs.
    Args: sure: standard errors that make it so.
    """
    effects = effects or {}
    some = [answer for answer in answers if answer is not None]
    found = []
    for name, parameter, pairs in (
            ('motor_lag', 'time_constant', [answer.lag for answer in some]),
            ('actuation_delay', 'delay', [answer.delay for answer in some])):
        known = effects.get(name, {})
        if not set(known) <= {parameter}:
            continue
        values, errors = np.array([pair for pair in pairs if np.isfinite(pair[1])]).reshape(
            -1, 2).T
        if not len(values):
            continue
        values = values - known.get(parameter, 0.0)
        weights = 1.0 / np.maximum(errors, FINEST) ** 2
        mean = float(np.sum(weights * values) / weights.sum())
        error = sure / float(np.sqrt(weights.sum()))
        if (abs(mean) < error and abs(mean) + error < SMALL
                and (np.abs(values) - sure * errors < SMALL).all()):
            found.append(name)
    return tuple(found)


def rotor_answer(record: FlightRecord) -> RotorAnswer | None:
    """
    Return the RotorAnswer of a record, None where its measured speeds do not show it.

    Where they are missing, slow, or a copy of the commands. Of a record with gaps it is the
    longest stretch without one: lags do not reach across them.
    """
    names, measured = record.numbered('cmd'), record.numbered('rotor')
    if not names or len(names) != len(measured):
        return None
    part = _part(record.t)
    t = record.t[part] - record.t[part][0]
    commands = np.ascontiguousarray(record.stack(*names)[part])
    speeds = record.stack(*measured)[part]
    if t[-1] < 2 * BLOCK or _rate(t, speeds) < LEAST_RATE or not np.ptp(commands, axis=0).all():
        return None

    def acted(delay: float, lag: float) -> np.ndarray:
        theta = NULL.copy()
        theta[DELAY], theta[LAG] = delay, max(lag, 0.0)
        return actuated(t, t, commands, theta[None]).speeds[0]

    beside = _sag(record, part, speeds)
    all_of, sparse = (_Measured.of(speeds[used], [one[used] for one in beside])
                      for used in (slice(None), SPARSE))
    # A delay moves the answer of a lag in time, nearly enough to begin with.
    lagged = [(lag, acted(0.0, lag)) for lag in LAGS]
    near = np.array(min(
        (sparse.unexplained(_moved(t[SPARSE], t, answer, delay)), delay, lag)
        for delay in DELAYS for lag, answer in lagged)[1:])
    best = scipy.optimize.minimize(
        lambda place: all_of.unexplained(acted(*place)), near, method='Nelder-Mead', options={
            'initial_simplex': near + np.array([[0.0, 0.0], [0.005, 0.0], [0.0, 0.005]]),
            'xatol': FINEST, 'fatol': np.inf, 'maxiter': 120}).x
    delay, lag = float(best[0]), max(float(best[1]), 0.0)
    there = [acted(delay, lag), *beside]
    rest, values = all_of.apart(there[0])
    spread = float(np.sum(all_of.speeds ** 2))
    explained = 1.0 - float(np.sum(rest ** 2)) / max(spread, 1e-300)
    if 1.0 - explained < COPY and max(abs(delay), lag) < COPIED:
        return None
    # Samples do not show what happens between them: slopes are those over half a period.
    step = 0.5 * float(np.median(np.diff(t)))
    slopes = [(acted(delay + step, lag) - acted(delay - step, lag)) / (2 * step),
              (acted(delay, lag + step) - acted(delay, lag)) / step]
    columns = [values[0] * _Measured.of(slope, beside).apart(there[0])[0] for slope in slopes]
    errors = _errors(t, np.stack(columns, axis=-1), rest)
    if lag < 2 * step:      # steps of speed from one sample to the next: anywhere between them
        errors[0] = np.hypot(errors[0], 2 * step / np.sqrt(12.0))
    others = _errors(t, np.stack([_centred(one) for one in there], axis=-1), rest)
    per_volt = (float(values[1]), float(others[1])) if beside else None
    return RotorAnswer((delay, float(errors[0])), (lag, float(errors[1])),
                       (float(values[0]), float(others[0])), per_volt, explained)


def _part(t: np.ndarray) -> slice:
    """Return the samples, MOST at the most, in the middle of the longest stretch without a gap."""
    steps = np.diff(t)
    gaps = np.flatnonzero(steps > max(GAP * float(np.median(steps)), BRIDGED))
    edges = np.concatenate([[0], gaps + 1, [len(t)]])
    longest = int(np.argmax(np.diff(edges)))
    begin, end = int(edges[longest]), int(edges[longest + 1])
    begin += max(0, (end - begin - MOST) // 2)
    return slice(begin, min(end, begin + MOST))


def _moved(at: np.ndarray, t: np.ndarray, values: np.ndarray, late: float) -> np.ndarray:
    """Return what values (N, n) at t (N,) s are at times (K,) s if they come later, (K, n)."""
    return np.stack([np.interp(at - late, t, column) for column in values.T], axis=-1)


@dataclass(frozen=True, eq=False)
class _Measured:
    """
    Speeds (N, n) about the mean of each rotor, which answers are held against.

    beside (N n, C): what may be in them beside an answer, likewise.
    """

    speeds: np.ndarray
    beside: np.ndarray

    @classmethod
    def of(cls, speeds: np.ndarray, beside: list[np.ndarray]) -> '_Measured':
        """Return that of speeds and what may be beside an answer, all (N, n)."""
        return cls(_centred(speeds), np.reshape([_centred(one).ravel() for one in beside],
                                                (len(beside), speeds.size)).T)

    def apart(self, answer: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the speeds less values (1 + C,) times an answer (N, n) and beside; the values."""
        table = np.column_stack([_centred(answer).ravel(), self.beside])
        values = np.linalg.lstsq(table.T @ table, table.T @ self.speeds.ravel(), rcond=1e-12)[0]
        return self.speeds - (table @ values).reshape(self.speeds.shape), values

    def unexplained(self, answer: np.ndarray) -> float:
        """Return the sum of the squares of what an answer leaves of the speeds."""
        return float(np.sum(self.apart(answer)[0] ** 2))


def _centred(values: np.ndarray) -> np.ndarray:
    """Return values (N, n) about the mean of each column."""
    return values - values.mean(axis=0)


def _errors(t: np.ndarray, columns: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return standard errors (C,) of what columns (N, n, C) fit, by blocks of the rest (N, n)."""
    block = (t / BLOCK).astype(int)
    scores = np.zeros((block[-1] + 1, columns.shape[-1]))
    np.add.at(scores, block, np.einsum('tjc,tj->tc', columns, rest))
    inverse = np.linalg.pinv(np.einsum('tjc,tjd->cd', columns, columns))
    return np.sqrt(np.maximum(np.diag(inverse @ (scores.T @ scores) @ inverse), 0.0))


def _sag(record: FlightRecord, part: slice, speeds: np.ndarray) -> list[np.ndarray]:
    """Return [what a speed that goes with the voltage would change by, per 1/V], or []."""
    if not record.has('vbat') or not np.ptp(record.columns['vbat'][part]) > 0:
        return []
    volts = record.columns['vbat'][part]
    return [(volts - volts.mean())[:, None] * speeds.mean(axis=0)]


def _rate(t: np.ndarray, speeds: np.ndarray) -> float:
    """Return how often a second speeds are measured: between two samples they lie on a line."""
    bends = np.abs(np.diff(speeds, 2, axis=0)) > 1e-9 * np.abs(speeds).max(initial=1e-300)
    return float(bends.any(axis=1).sum() / (t[-1] - t[0]))


def _ms(pair: tuple[float, float]) -> str:
    return f'{1e3 * pair[0]:.1f} ± {1e3 * pair[1]:.1f} ms'
