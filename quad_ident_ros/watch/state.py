# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes of a vehicle have published: contents of messages in, a frozen state out."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime

from quad_ident_ros.data.joiner import Counts
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.report.received import diagnosis_from
from quad_ident_ros.report.verdict import verdict_line

NODES = ('recorder', 'identifier', 'diagnoser')
KEPT = 200          # events, some screens full
RATE_PERIOD = 0.5   # s between two accounts that give a rate: the recorder also sends one with
# each record, and a few messages within some ms say nothing about a rate
SILENT = 3.0        # s: three of the messages that each node sends once a second
CALENDAR = 10 ** 9  # s: stamps beyond (2001) are of the calendar, others of simulated time
OK = 0              # level of a diagnostic_msgs/DiagnosticStatus


@dataclass(frozen=True)
class Health:
    """What a node says of itself: the level of its DiagnosticStatus, a text, when (steady, s)."""

    level: int
    text: str
    time: float


@dataclass(frozen=True)
class Stream:
    """A topic of the recorder: messages received, and their rate, Hz, or None."""

    name: str
    received: int
    rate: float | None


@dataclass(frozen=True)
class Recording:
    """
    The account of the recorder.

    joined, buffered: samples; problems {what: count} since its start; folder: None in memory;
    time: of receipt (steady, s).
    """

    streams: tuple[Stream, ...]
    joined: int
    buffered: int
    records: int
    problems: Mapping[str, int]
    run: str
    folder: str | None
    disk_error: str | None
    time: float


@dataclass(frozen=True)
class Model:
    """
    K/((s+a)(s+b)) of an output as the best method gives it.

    values, errors: K, a, b and their standard errors, None where there is none; pair: the real and
    imaginary part of complex poles (1/s) in place of a and b.
    """

    output: str
    values: tuple[float | None, ...]
    errors: tuple[float | None, ...]
    pair: tuple[float, float] | None
    fit_percent: float | None


@dataclass(frozen=True)
class Fit:
    """What the identifier published: the best method, and a Model of each output excited."""

    method: str
    models: tuple[Model, ...]


@dataclass(frozen=True)
class Verdict:
    """
    What the diagnoser published, in words and numbers.

    units, before, after, noise {group: ...}: the gap of the flight held out, `horizon` s ahead.
    """

    line: str
    horizon: float
    units: Mapping[str, str]
    before: Mapping[str, float]
    after: Mapping[str, float]
    noise: Mapping[str, float]


@dataclass(frozen=True)
class Event:
    """A line of the history: the time of the data (or of the day), what it is about, a text."""

    time: str
    about: str
    text: str


@dataclass(frozen=True)
class State:
    """
    All that there is to show; history: the newest event first.

    health, progress: by node, the latter only while it works; changed {output: time of its last
    change}.
    """

    health: Mapping[str, Health] = field(default_factory=dict)
    progress: Mapping[str, float] = field(default_factory=dict)
    recording: Recording | None = None
    fit: Fit | None = None
    verdict: Verdict | None = None
    changed: Mapping[str, str] = field(default_factory=dict)
    history: tuple[Event, ...] = ()

    def silence(self, node: str, now: float) -> float | None:
        """Return for how long (s) a node has been silent beyond SILENT, or None."""
        health = self.health.get(node)
        silent = None if health is None else now - health.time
        return None if silent is None or silent < SILENT else silent


def after_message(state: State, topic: str, step: Callable[[State], State]) -> State:
    """
    Return step(state), or the state with one event where the message is not what it should be.

    Topics are open to anybody: no message may end the view.
    """
    try:
        return step(state)
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError,
            ValueError) as error:
        return with_event(state, Event('', topic, 'a message cannot be read '
                                       f'({type(error).__name__}: {error}): start all nodes from '
                                       'the same version'))


def with_health(state: State, node: str, level: int, text: str, now: float) -> State:
    """Return the state after a DiagnosticStatus of a node."""
    state = replace(state, health={**state.health, node: Health(level, text, now)})
    # A node at work says that it is well: no matter what else it reports, its work has ended.
    return state if level == OK else _without_progress(state, node)


def with_progress(state: State, node: str, data: dict) -> State:
    """Return the state after what a node published on ~/progress."""
    share = float(data['fraction'])
    if share >= 1.0:
        return _without_progress(state, node)
    return replace(state, progress={**state.progress, node: share})


def with_statistics(state: State, data: dict, now: float) -> State:
    """Return the state after the account of the recorder, ~/statistics."""
    before = state.recording
    passed = 0.0 if before is None else now - before.time
    if before is not None and passed < RATE_PERIOD:
        rates = {stream.name: stream.rate for stream in before.streams}
        counted, now = {stream.name: stream.received for stream in before.streams}, before.time
    else:
        counted = data['received']
        rates = {} if before is None else {
            stream.name: (counted[stream.name] - stream.received) / passed
            for stream in before.streams if counted.get(stream.name, -1) >= stream.received}
    counts = Counts(**{name: data[name] for name in vars(Counts())})
    return replace(state, recording=Recording(
        streams=tuple(Stream(name, counted.get(name, 0), rates.get(name))
                      for name in data['received']),
        joined=counts.joined, buffered=data['buffered'], records=data['records'],
        problems=counts.problems(), run=data['run'] or '', folder=data['recording'],
        disk_error=data['disk_error'], time=now))


def with_fit(state: State, data: dict) -> State:
    """Return the state after parameters_json of the identifier."""
    outputs = data['methods'][data['best']]['outputs']
    return replace(state, fit=Fit(data['best'], tuple(
        _model(name, outputs[name]) for name in OUTPUTS if name in outputs)))


def with_change(state: State, stamp_ns: int, output: str, text: str) -> State:
    """Return the state after a message on `change`: its stamp, its output, what moved."""
    time = time_text(stamp_ns)
    state = replace(state, changed={**state.changed, output: time})
    return with_event(state, Event(time, 'change', text))


def with_diagnosis(state: State, data: dict) -> State:
    """Return the state after the JSON on `diagnosis`."""
    found = diagnosis_from(data, None)
    gap, line = found.gap, verdict_line(found)
    state = _without_progress(state, 'diagnoser')
    state = replace(state, verdict=Verdict(
        line, gap.horizon, gap.units, gap.before, gap.after, gap.noise))
    return with_event(state, Event(time_text(data['span_ns'][1]), 'verdict', line))


def with_event(state: State, event: Event) -> State:
    """Return the state with an event, each once: restarted nodes publish theirs again."""
    if event in state.history:
        return state
    return replace(state, history=(event, *state.history)[:KEPT])


def time_text(stamp_ns: int) -> str:
    """Return a stamp as a person reads it: the time of the day, or s of simulated time."""
    seconds = stamp_ns * 1e-9
    if seconds < CALENDAR:
        return f'{seconds:.2f} s'
    return f'{datetime.fromtimestamp(seconds):%H:%M:%S}'


def _model(name: str, data: dict) -> Model:
    pair = data.get('pair')
    return Model(name, tuple(data[key] for key in 'Kab'),
                 tuple(data['standard_errors'][key] for key in 'Kab'),
                 pair and (pair['real'], pair['imaginary']), data['errors'].get('fit_percent'))


def _without_progress(state: State, node: str) -> State:
    return replace(state, progress={name: share for name, share in state.progress.items()
                                    if name != node})
