# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Shared memory of FastDDS: what it leaves where a node is killed, and takes from one that lives.

A killed node leaves half a megabyte, for ever. Who last lets go of what it listened on deletes
that by its name, which the next node may have taken: it hears nothing then (its issue 5469).
"""

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
PORT = re.compile(r'fastrtps_port\d+')
LOOK = 5.0          # s between two looks at what a node listens on, which take a millisecond, and
SOON = 1.0          # s between those of one that has just begun: most are deaf from the beginning
EARLY = 30.0        # s in which it is not worth more than a start that hears


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


def lost_ports(process=Path('/proc/self'), folder=FOLDER):
    """
    Return the files on which a process listens that are deleted, or somebody else's by now.

    It holds a lock on a file beside each of them and has it mapped. None where the system has no
    such list of what a process holds.
    """
    mapped, held = {}, set()
    with suppress(OSError):
        for line in (process / 'maps').read_text().splitlines():
            name = Path(line.partition('/')[2].removesuffix(' (deleted)')).name
            if PORT.fullmatch(name):
                mapped[name] = int(line.split()[4])
        for number in (process / 'fd').iterdir():
            with suppress(OSError):
                name = Path(os.readlink(number).removesuffix(' (deleted)')).name
                held.add(name.removesuffix(LOCK) if name.endswith(LOCK) else '')
    return [str(folder / name) for name in sorted(held & set(mapped))
            if _inode(folder / name) != mapped[name]]


def _inode(path):
    """Return the number of a file, None where it is gone."""
    try:
        return path.stat().st_ino
    except OSError:
        return None


class HearingWatch:
    """
    Finds out whether a node hears those that begin now, and says so once where it does not.

    Args: say: takes a line of log; anew: returns whether the node may start once more by
    itself.
    """

    def __init__(self, say, anew):
        self._say, self._anew, self._lost = say, anew, []
        self._begun = time.monotonic()
        self._next = self._begun + SOON

    def look(self):
        """
        Look whether what the node listens on is still there, now and then until it is not.

        Twice: for a moment it holds the file of another node, too, to see whether that lives.
        Returns whether the node is to start once more: later than EARLY, or where it may not, it
        works with those who began before, and only a person knows what a start would cost.
        """
        now = time.monotonic()
        if now < self._next:
            return False
        early = now - self._begun < EARLY
        before, self._lost = self._lost, lost_ports()
        told = bool(self._lost) and self._lost == before
        self._next = float('inf') if told else now + (SOON if early else LOOK)
        if not told:
            return False
        anew = early and self._anew()
        self._say(
            f'no node that starts from now on is heard, and perhaps no other: '
            f'{", ".join(self._lost)}, on which this node listens, was deleted by another '
            'process, as happens after a kill -9 (FastDDS, issue 5469); '
            + ('this node starts again' if anew else 'start this node again'))
        return anew


def keep_to_oneself(process=Path('/proc/self'), folder=FOLDER):
    """Have what FastDDS left open closed where this process becomes another program."""
    with suppress(OSError):
        for number in (process / 'fd').iterdir():
            with suppress(OSError):
                if os.readlink(number).startswith(f'{folder}/fastrtps_'):
                    os.set_inheritable(int(number.name), False)
