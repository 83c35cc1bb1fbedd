# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: the same examples, what is quick, what needs ROS 2 where it is."""

from collections import Counter
from importlib.util import find_spec
import re

from hypothesis import settings
import pytest

from quad_ident_ros.linear_algebra_threads import use_one

use_one()    # there are as many processes as cores

settings.register_profile('same', derandomize=True)
settings.register_profile('explore', print_blob=True)   # pytest --hypothesis-profile=explore
settings.load_profile('same')

IMPORTS_ROS = re.compile(
    r'^(from|import) (rclpy|rcl_interfaces|\w+_msgs|quad_ident_ros\.nodes|benchmarks\.load)\b',
    re.MULTILINE)

FEW = 3     # cases of a test that are quick: of more, as many that are spread over them
OF_FILES = 'test_repository.py', 'test_imports.py'      # each case is a file that may be at fault


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark as slow what of a table of many cases ./run test --fast need not look at."""
    tests = [item.nodeid.partition('[')[0] for item in items]
    count, seen = Counter(tests), Counter()
    for test, item in zip(tests, items, strict=True):
        if seen[test] * FEW % count[test] >= FEW and item.path.name not in OF_FILES:
            item.add_marker(pytest.mark.slow)
        seen[test] += 1


def pytest_ignore_collect(collection_path):
    """Leave out the tests that import ROS 2 where it is not installed, as on ARM and macOS."""
    if find_spec('rclpy') is not None:
        return None
    if collection_path.name == 'integration':
        return True
    text = collection_path.read_text(encoding='utf-8') if collection_path.is_file() else ''
    return True if IMPORTS_ROS.search(text) else None
