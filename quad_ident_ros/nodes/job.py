# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The long work of a node, in a thread of its own so that the executor stays free."""

import json
import threading
import time
import traceback

from std_msgs.msg import String

from quad_ident_ros.errors import Cancelled, InputError

PROGRESS_PERIOD = 0.1   # s between two messages on ~/progress
ENDING = 1.0            # s that work has to end; a compilation cannot be interrupted


class Job:
    """
    Work that is done once at a time; while it runs, only one more waits.

    Args: node; prepare: called in the executor when work begins, returns the function that does
    it, which calls `tell` now and then; on_end: called in the executor with what that returned,
    with an InputError, or with None where it was cancelled; failure: how a line on records that
    cannot be worked on begins.
    """

    def __init__(self, node, prepare, on_end, failure):
        self._prepare, self._on_end, self._failure = prepare, on_end, failure
        self._logger = node.get_logger()
        self._progress = node.create_publisher(String, '~/progress', 10)
        self._told = 0.0
        self._waiting = False
        self._worker = None
        self._cancelled = threading.Event()
        self.warming_up = False
        self._outcomes = []
        # The thread wakes the executor by this, and does no more than that and publish.
        self._finished = node.create_guard_condition(self.collect)

    @property
    def busy(self):
        """Whether work is being done."""
        return self._worker is not None

    def request(self):
        """Begin, or begin after the work that is being done."""
        if self.busy:
            self._waiting = True
            return
        self._waiting = False
        self._cancelled.clear()
        self._start(self._prepare())

    def warm_up(self, function):
        """Do something before the first work; what is requested meanwhile waits for it."""
        self.warming_up = True
        self._start(function)

    def _start(self, function):
        # A daemon: a compilation in it must not keep the process from ending.
        self._worker = threading.Thread(target=self._work, args=(function,), daemon=True)
        self._worker.start()

    def cancel(self):
        """End the work that is being done, and forget what waits; return whether there is any."""
        there = self._waiting if self.warming_up else self.busy
        self._waiting = False
        self._cancelled.set()
        return there

    def close(self):
        """Cancel, and wait for the end where it can be interrupted."""
        self._cancelled.set()
        if self._worker is not None:
            self._worker.join(ENDING)

    def tell(self, share, **more):
        """Publish how far the work is, from its thread; raises Cancelled where it shall end."""
        if self._cancelled.is_set():
            raise Cancelled
        now = time.monotonic()
        if now - self._told >= PROGRESS_PERIOD:
            self._told = now
            self.say(share, **more)

    def say(self, share, **more):
        """Publish how far the work is."""
        self._progress.publish(String(data=json.dumps({**more, 'fraction': round(share, 4)})))

    def collect(self):
        """Hand out what came of the work where it is done."""
        if not self._outcomes:
            return
        self._worker.join()
        self._worker = None
        outcome = self._outcomes.pop()
        if self.warming_up:
            self.warming_up = False
            if isinstance(outcome, InputError):   # what it is for will say so too
                self._logger.warning(str(outcome))
        else:
            self._on_end(outcome)
        if self._waiting:
            self.request()

    def _work(self, function):
        try:
            outcome = function()
        except Cancelled:
            outcome = None
        except InputError as error:
            outcome = error
        except Exception as error:   # records come from anybody: none may silence the node
            self._logger.debug(traceback.format_exc())
            outcome = InputError(f'{self._failure}: {type(error).__name__}: {error}')
        self._outcomes.append(outcome)
        self._finished.trigger()
