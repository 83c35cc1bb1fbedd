# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is compiled beforehand, so that the first diagnosis of a user need not be."""

import os
import subprocess
import sys

import pytest

FIRST = """
from flightmaker import flight, VEHICLE
from quad_ident_ros.compiled import FUNCTIONS
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.warm_up import warm_up_diagnosis

def known():
    return {(function.__name__, signature) for function in FUNCTIONS
            for signature in function.signatures}

warm_up_diagnosis()
before = known()
diagnose([flight(seconds=8.0, seed=seed) for seed in (0, 1)], VEHICLE)
print(*sorted(name for name, _ in known() - before))
"""


@pytest.mark.slow
def test_the_first_diagnosis_of_commands_alone_compiles_nothing():
    """It took seconds, and 130 MB more, where no rotor speeds were measured."""
    places = {'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run([sys.executable, '-c', FIRST], capture_output=True, text=True,
                          check=True, env={**os.environ, **places})
    assert done.stdout.split() == []
