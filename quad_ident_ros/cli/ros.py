# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What commands that need ROS 2 say where it is not installed."""

from collections.abc import Iterator
from contextlib import contextmanager

from quad_ident_ros.errors import InputError


@contextmanager
def needs_ros(command: str) -> Iterator[None]:
    """Raise InputError, which names the command, where an import of ROS 2 in the block fails."""
    try:
        yield
    except ImportError as error:
        raise InputError(f'ROS 2 is not installed ({error}): source ROS 2 Jazzy, or start this as '
                         f'`./run {command}`, which installs it') from None
