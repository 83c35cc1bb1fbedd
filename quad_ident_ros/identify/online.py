# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification from window to window of a flight that goes on."""

from dataclasses import replace

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.change import find_change, SHORTEST
from quad_ident_ros.identify.identify import identify
from quad_ident_ros.identify.vp import vp

AFRESH = 20   # windows after which the search begins without the last model


class Tracker:
    """
    Identifies overlapping windows of one flight, each from the models of the one before.

    Where the vehicle changed within a window, what was before the change is left out from then
    on: the parameters are those of the vehicle as it is.
    """

    def __init__(self):
        self._near = {}
        self._windows = 0
        self._since_ns = None

    def update(self, records, settings, **options):
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
        changes = self._changes(result, settings)
        if changes:
            self._since_ns = max(change.stamp_ns for change in changes)
            self._near = {}
            try:
                result = self._identify(records, settings, options)
            except InputError:   # too little after the change: the window as a whole has to do
                pass
        self._near = {output: fit.model for output, fit in
                      result.methods[result.best].outputs.items() if fit.model is not None}
        return replace(result, changes=tuple(changes))

    def _identify(self, records, settings, options):
        return identify([self._newest(record) for record in records], settings, near=self._near,
                        **options)

    def _newest(self, record):
        """Return the part of a record since the last change."""
        start = record.info.get('start_ns')
        if self._since_ns is None or start is None or start >= self._since_ns:
            return record
        age = (record.t - record.t[0]) * 1e9 + start - self._since_ns
        first = int((age < -1e3).sum())   # stamps are doubles of seconds: 1 us is the same time
        return record if len(record) - first < SHORTEST else record.starting(first)

    def _changes(self, result, settings):
        found = []
        for output, signal in result.signals.items():
            change = find_change(signal, vp(signal, settings.poles, self._near.get(output)))
            if change is not None and signal.start_ns is not None:
                found.append(replace(
                    change, stamp_ns=signal.start_ns + round(change.time * 1e9)))
        return found
