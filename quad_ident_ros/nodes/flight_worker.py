# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A flight that is computed beside the executor of a node."""

import threading

from quad_ident_ros.errors import Cancelled, InputError
from quad_ident_ros.experiment import fly

ENDING = 1.0    # s that a flight has to end; a compilation cannot be interrupted


class FlightWorker(threading.Thread):
    """Flies a run beside the executor; outcome is a Simulation or an InputError."""

    def __init__(self, *flight):
        super().__init__(daemon=True)
        self._flight, self._cancelled = flight, threading.Event()
        self.outcome = None
        self.start()

    def run(self):
        """Fly."""
        experiment, run, noise, seed = self._flight
        try:
            self.outcome = fly(experiment, run, noise=noise, seed=seed,
                               on_progress=self._on_progress)
        except InputError as error:
            self.outcome = error
        except Cancelled:
            pass

    def cancel(self):
        """End the flight soon, and wait until it has ended, or compiles."""
        self._cancelled.set()
        self.join(ENDING)

    def _on_progress(self, _):
        if self._cancelled.is_set():
            raise Cancelled
