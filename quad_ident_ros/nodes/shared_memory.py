# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Shared memory that FastDDS leaves where a node is killed: half a megabyte each, for ever."""

from contextlib import suppress
import fcntl
import os
from pathlib import Path
import re
import time

FOLDER = Path('/dev/shm')
SEGMENT = re.compile(r'fastrtps_[0-9a-f]{16}')
LOCK = '_el'        # behind the name of a segment: the file that its process holds a lock on
YOUNG = 5.0         # s, in which one that begins may not have its lock yet


def free_abandoned(folder=FOLDER):
    """
    Remove the segments of this user's processes that are gone; return how many.

    Each process holds a lock on a file beside its segment as long as it lives.
    """
    count = 0
    with suppress(OSError):
        for lock in sorted(folder.glob(f'fastrtps_*{LOCK}')):
            segment = lock.with_name(lock.name.removesuffix(LOCK))
            if SEGMENT.fullmatch(segment.name):
                with suppress(OSError):     # it lives, or another start was faster
                    count += _freed(segment, lock)
    return count


def _freed(segment, lock):
    """Remove a segment where nobody holds its lock; return whether; OSError where one does."""
    about = lock.lstat()
    if about.st_uid != os.geteuid() or time.time() - about.st_mtime < YOUNG:
        return False
    held = os.open(lock, os.O_RDWR | os.O_NOFOLLOW)
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        segment.unlink(missing_ok=True)
        lock.unlink()
    finally:
        os.close(held)
    return True
