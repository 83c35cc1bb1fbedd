# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification from window to window of a flight that goes on."""

from collections import deque
from dataclasses import replace

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.change import find_change, SHORTEST
from quad_ident_ros.identify.identify import identify
from quad_ident_ros.identify.vp import vp

AFRESH = 20     # windows after which the search begins without the last model
USUAL = 100     # windows whose advantage of two models is the usual one,
RECENT = 60     # but for the last, in which a change may be coming up
SETTLED = 20    # windows after which it is known


class Tracker:
    """
    Identifies overlapping windows of one flight, each from the models of the one before.

    Where the vehicle changed, windows begin at the end of the one that shows it: the instant that
    is found may be half a second early, and then the change was over. The parameters are those of
    the vehicle as it is.
    """

    def __init__(self):
        self._near = {}
        self._windows = 0
        self._since_ns = None
        self._advantages = {}
        self._usual = {}    # the largest of them without a change, by output

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
            self._since_ns = max(_end_ns(result.signals[change.output]) for change in changes)
            self._near, self._advantages = {}, {}
            try:
                result = self._identify(records, settings, options)
            except InputError:   # the shortest window shows nothing: the whole has to do
                pass
        self._near = {output: fit.model for output, fit in
                      result.methods[result.best].outputs.items() if fit.model is not None}
        return replace(result, changes=tuple(changes))

    def _identify(self, records, settings, options):
        return identify([self._newest(record) for record in records], settings, near=self._near,
                        **options)

    def _newest(self, record):
        """Return the part of a record since the last change, but no less than the shortest."""
        start = record.info.get('start_ns')
        if self._since_ns is None or start is None or start >= self._since_ns:
            return record
        age = (record.t - record.t[0]) * 1e9 + start - self._since_ns
        first = int((age < -1e3).sum())   # stamps are doubles of seconds: 1 us is the same time
        return record.starting(max(min(first, len(record) - SHORTEST), 0))

    def _model(self, result, output):
        """Return a model near the best one of an output: that of VP where it has one."""
        fit = result.methods.get('vp', result.methods[result.best]).outputs[output]
        return fit.model or self._near.get(output)

    def _changes(self, result, settings):
        found = []
        for output, signal in result.signals.items():
            past = self._advantages.setdefault(output, deque(maxlen=USUAL + RECENT))
            known = list(past)[:-RECENT]
            if len(known) >= SETTLED:
                # Short windows, as after a change, do not tell all that is usual.
                before = -np.inf if len(known) == USUAL else self._usual.get(output, -np.inf)
                self._usual[output] = max(before, *known)
            usual = self._usual.get(output)
            fitted = vp(signal, settings.poles, self._model(result, output))
            change, advantage = find_change(signal, fitted, usual or 0.0)
            past.append(advantage)
            if change is not None and usual is not None and signal.start_ns is not None:
                found.append(replace(
                    change, stamp_ns=signal.start_ns + round(change.time * 1e9)))
        return found


def _end_ns(signal):
    return signal.start_ns + round(signal.t[-1] * 1e9)
