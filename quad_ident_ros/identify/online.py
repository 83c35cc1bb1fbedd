# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification from window to window of a flight that goes on."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.change import Change, Watch
from quad_ident_ros.identify.identify import identify, Progress, Settings
from quad_ident_ros.identify.result import Identification
from quad_ident_ros.identify.signals import Signal
from quad_ident_ros.identify.transfer import SecondOrder

AFRESH = 20     # windows after which the search begins without the last model
SHORTEST = 40   # samples of a window


class Changes:
    """Watches all outputs of one flight."""

    def __init__(self) -> None:
        self._watches: dict[str, Watch] = {}

    def update(self, signals: Mapping[str, Signal]) -> tuple[tuple[Change, ...], int | None]:
        """
        Return the Changes that Signals by output show, and the stamp from which they are over.

        That is () and None where nothing changed.
        """
        signals = {name: signal for name, signal in signals.items()
                   if signal.start_ns is not None}
        found = [change for name, signal in signals.items()
                 if (change := self._watch(name).update(signal)) is not None]
        if not found:
            return (), None
        # The instant that is found may be early: by the end of the window the change was over.
        settled = max(_end_ns(signals[change.output]) for change in found)
        for watch in self._watches.values():
            watch.restart(settled)
        return tuple(found), settled

    def _watch(self, output: str) -> Watch:
        return self._watches.setdefault(output, Watch(output))


class Tracker:
    """
    Identifies overlapping windows of one flight, each from the models of the one before.

    Where the vehicle changed, windows begin at the end of the one that shows it. The parameters
    are those of the vehicle as it is.
    """

    def __init__(self) -> None:
        self._near: dict[str, SecondOrder] = {}
        self._windows = 0
        self._since_ns: int | None = None
        self._changes = Changes()

    def update(self, records: Sequence[FlightRecord], settings: Settings, **options: Progress
               ) -> Identification:
        """
        Return the Identification of the newest windows, with the changes found in them.

        Args: as of identify; records that do not say when they begin (info start_ns) are taken
        whole. Raises InputError where identify does.
        """
        self._windows += 1
        if self._windows % AFRESH == 0:
            self._near = {}
        settings = replace(settings, compare_orders=False)
        result = self._identify(records, settings, options)
        changes, settled = self._changes.update(result.signals)
        if changes:
            self._since_ns = settled
            self._near = {}
            try:
                result = self._identify(records, settings, options)
            except InputError:   # the shortest window shows nothing: the whole has to do
                pass
        self._near = {output: fit.model for output, fit in
                      result.methods[result.best].outputs.items() if fit.model is not None}
        return replace(result, changes=changes)

    def _identify(self, records: Sequence[FlightRecord], settings: Settings,
                  options: Mapping[str, Progress]) -> Identification:
        return identify([self._newest(record) for record in records], settings, near=self._near,
                        **options)

    def _newest(self, record: FlightRecord) -> FlightRecord:
        """Return the part of a record since the last change, but no less than the shortest."""
        start = record.info.get('start_ns')
        if self._since_ns is None or start is None or start >= self._since_ns:
            return record
        age = (record.t - record.t[0]) * 1e9 + start - self._since_ns
        first = int((age < -1e3).sum())   # stamps are doubles of seconds: 1 us is the same time
        return record.starting(max(min(first, len(record) - SHORTEST), 0))


def _end_ns(signal: Signal) -> int:
    return signal.start_ns + round(signal.t[-1] * 1e9)
