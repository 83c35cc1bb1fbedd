# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""An end of the process that nothing can hold up, for the time in which others close it."""

from contextlib import contextmanager
import ctypes
import sys

LIBRARY = ctypes.CDLL(None, use_errno=True) if sys.platform == 'linux' else None
MONOTONIC = 1       # CLOCK_MONOTONIC and SIGEV_THREAD of <time.h> and <signal.h> on Linux
IN_A_THREAD = 2


class Event(ctypes.Structure):
    """`struct sigevent` of POSIX (timer_create(2)): a function that a new thread calls."""

    _fields_ = (('value', ctypes.c_void_p), ('signal', ctypes.c_int), ('notify', ctypes.c_int),
                ('function', ctypes.c_void_p), ('attributes', ctypes.c_void_p),
                ('rest', ctypes.c_char * 32))


class Times(ctypes.Structure):
    """`struct itimerspec` of POSIX (timer_settime(2)): an interval and a first time, in s, ns."""

    _fields_ = (('interval', ctypes.c_long * 2), ('first', ctypes.c_long * 2))


@contextmanager
def ended_after(seconds):
    """
    End the process with exit code 0 where the body takes longer than a time, in whole s.

    The end needs no interpreter: a body that holds it and waits for ever is ended, too. Nothing
    ends the process where the system is not Linux. Raises OSError where it has no timer to give.
    """
    if LIBRARY is None:
        yield
        return
    timer = ctypes.c_void_p()
    leave = ctypes.cast(LIBRARY._exit, ctypes.c_void_p)
    event = Event(value=0, notify=IN_A_THREAD, function=leave)
    _check(LIBRARY.timer_create(MONOTONIC, ctypes.byref(event), ctypes.byref(timer)))
    _check(LIBRARY.timer_settime(timer, 0, ctypes.byref(Times(first=(seconds, 0))), None))
    try:
        yield
    finally:
        LIBRARY.timer_delete(timer)


def _check(code):
    if code:
        raise OSError(ctypes.get_errno(), 'no timer for the end of a node')
