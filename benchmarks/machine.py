# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The machine: one core of it, its arithmetic limit, and what it is called."""

import datetime
from importlib.metadata import PackageNotFoundError, version
import os
from pathlib import Path
import platform
import time

import numpy as np

SIZE = 1024      # of the matrices whose product gives the limit


def take_one_core():
    """Bind this process, and those that it starts, to one core; return its number."""
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


def timed(function, *arguments):
    """Return what a function returns, and the CPU time in s that it took."""
    start = time.process_time()
    result = function(*arguments)
    return result, time.process_time() - start


def peak_flops():
    """Return what one core reaches in the product of two matrices of doubles, flop/s."""
    random = np.random.default_rng(0)
    a, b = random.normal(size=(2, SIZE, SIZE))
    a @ b
    return 2.0 * SIZE ** 3 / min(timed(np.matmul, a, b)[1] for _ in range(10))


def described(packages, used):
    """Return what the numbers of a run depend on, in one line; used: how many cores."""
    versions = [f'{name} {found}' for name in packages if (found := version_of(name))]
    return (f'{datetime.date.today():%Y-%m-%d}; {_processor()}, {os.cpu_count()} cores, '
            f'{used} used; Python {platform.python_version()}, {", ".join(versions)}')


def version_of(package):
    """Return the installed version of a package, or None."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _processor():
    try:
        lines = Path('/proc/cpuinfo').read_text(encoding='utf-8').splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(':')[2].strip() for line in lines if line.startswith('model name')]
    return names[0] if names else platform.machine()
