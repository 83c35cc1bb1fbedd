# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What happens when a process is interrupted while it still loads its modules."""

import os
import signal


def end_on_interrupt() -> None:
    """
    End the process at once where it is interrupted, with the exit code of a node that was stopped.

    For processes of a node, before they load what takes a second: nothing is open yet. The node
    has a handler of its own as soon as it exists.
    """
    signal.signal(signal.SIGINT, lambda *_: os._exit(0))
