# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How many threads linear algebra has."""

import os

VARIABLES = ('OPENBLAS_NUM_THREADS', 'MKL_NUM_THREADS')


def use_one() -> None:
    """
    Give linear algebra one thread in a program whose environment does not say how many.

    Before numpy is loaded. Our matrices are small: threads of OpenBLAS that wait for one another
    by spinning took two to four times the CPU on two busy cores, and took it from other nodes.
    """
    for name in VARIABLES:
        os.environ.setdefault(name, '1')
