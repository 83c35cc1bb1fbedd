# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs of ours leave the other cores to others."""

import os
import subprocess
import sys

import pytest

from quad_ident_ros.linear_algebra_threads import VARIABLES

PROGRAM = """
import {module}
import os
import numpy as np
np.ones((500, 500)) @ np.ones((500, 500))
print(len(os.listdir('/proc/self/task')))
"""


def threads(module, **variables):
    """Return how many threads a program has that loads a module and multiplies matrices."""
    clean = {name: value for name, value in os.environ.items()
             if not name.endswith('_NUM_THREADS')}
    done = subprocess.run([sys.executable, '-c', PROGRAM.format(module=module)], text=True,
                          capture_output=True, timeout=120, check=True, env=clean | variables)
    return int(done.stdout)


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith('linux') or len(os.sched_getaffinity(0)) < 2,
                    reason='threads are counted in /proc, on two cores or more')
@pytest.mark.parametrize('module', ['quad_ident_ros.cli.main', 'quad_ident_ros.nodes'])
def test_linear_algebra_has_one_thread_unless_it_is_given_more(module):
    alone = threads(module)
    assert alone == 1
    if threads('os') == alone:
        pytest.skip('the linear algebra of this numpy has one thread anyway')
    assert threads(module, **dict.fromkeys(VARIABLES, '2')) == 2
