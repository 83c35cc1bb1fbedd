# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How far the compilation of the inner loops is, for those who wait for it."""

from dataclasses import dataclass
import threading
import time

from numba.core import event

from quad_ident_ros.compiled import FUNCTIONS

PAUSE = 2.0     # s without one, after which compiling is over: what was compiled runs in between


@dataclass(frozen=True)
class Compilation:
    """
    How far the compilation is.

    under_way: whether functions are being compiled; ready of all: functions that can be called,
    and those that there are, not all of which a process needs; seconds: since the first began.
    """

    under_way: bool
    ready: int
    all: int
    seconds: float


class CompilationWatch(event.Listener):
    """Counts what numba compiles in this process, in whichever thread, from now on."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._open = 0
        self._since: float | None = None
        self._until = -PAUSE
        event.register('numba:compile', self)

    def on_start(self, event: object) -> None:
        """Note that a function is being compiled."""
        with self._lock:
            self._open += 1
            self._since = self._since or time.monotonic()

    def on_end(self, event: object) -> None:
        """Note that a function was compiled, or failed to."""
        with self._lock:
            self._open -= 1
            self._until = time.monotonic()

    def close(self) -> None:
        """Stop counting."""
        event.unregister('numba:compile', self)

    def state(self) -> Compilation:
        """Return the Compilation as it is now."""
        now = time.monotonic()
        seconds = 0.0 if self._since is None else now - self._since
        under_way = self._since is not None and (self._open > 0 or now < self._until + PAUSE)
        return Compilation(under_way, sum(bool(function.signatures) for function in FUNCTIONS),
                           len(FUNCTIONS), seconds)
