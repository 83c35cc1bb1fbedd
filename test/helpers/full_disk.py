# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A disk that is full, for tests of what is written to it."""

from contextlib import contextmanager
import os
import resource
import sys

NO_BYTECODE = 'PYTHONDONTWRITEBYTECODE'     # nothing and '' are alike


@contextmanager
def file_size_limit(size):
    """Have writes past that size (bytes) fail, as on a full disk."""
    # Python 3.11 keeps bytecode that is cut short, and later starts end with an EOFError.
    keeps, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    told, os.environ[NO_BYTECODE] = os.environ.get(NO_BYTECODE, ''), '1'
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        sys.dont_write_bytecode, os.environ[NO_BYTECODE] = keeps, told
