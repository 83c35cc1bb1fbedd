# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A watchdog that ends the process, and needs no interpreter for that."""

from contextlib import contextmanager
import ctypes
import sys

LIBRARY = ctypes.CDLL(None) if sys.platform == 'linux' else None
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
def watchdog(seconds, code):
    """
    End the process with an exit code where the body takes longer than a time, in whole s.

    A body that holds the interpreter and waits for ever is ended, too. Where the system gives no
    timer, or is not Linux, the body has all the time that it takes.
    """
    timer = ctypes.c_void_p()
    create = getattr(LIBRARY, 'timer_create', None)     # in another library before glibc 2.34
    given = False
    if create is not None:
        leave = ctypes.cast(LIBRARY._exit, ctypes.c_void_p)
        event = Event(value=code, notify=IN_A_THREAD, function=leave)
        given = create(MONOTONIC, ctypes.byref(event), ctypes.byref(timer)) == 0
    if given:
        LIBRARY.timer_settime(timer, 0, ctypes.byref(Times(first=(seconds, 0))), None)
    try:
        yield
    finally:
        if given:
            LIBRARY.timer_delete(timer)
