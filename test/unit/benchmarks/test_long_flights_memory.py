# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The memory of a log of 20 minutes, which `./run bench long` measures with its time."""

import subprocess
import sys

import pytest

from benchmarks.long import MOST_MEMORY, ROOT

MEASURED = """\
import resource
import subprocess
import sys

subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def python(*arguments):
    """Run a Python of this environment, and return what it prints."""
    return subprocess.run([sys.executable, *map(str, arguments)], cwd=ROOT, check=True,
                          capture_output=True, text=True).stdout


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != 'linux', reason='the C library of others counts otherwise')
def test_a_log_of_20_minutes_is_diagnosed_within_its_bound(tmp_path):
    python('-m', 'benchmarks.long', 'log.ulg', tmp_path, 1200)
    python('-m', 'quad_ident_ros', 'warm-up')       # what compiles takes memory of its own
    for command in ('info', 'diagnose'):
        # By a process that is small: a child begins with what its parent has.
        kilobytes = python('-c', MEASURED, sys.executable, '-m', 'quad_ident_ros', command,
                           tmp_path / 'log.ulg', '--vehicle', tmp_path / 'vehicle.yaml')
        assert int(kilobytes) / 1024 <= MOST_MEMORY, command
