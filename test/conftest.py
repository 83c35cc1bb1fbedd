# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all tests: the same examples in every run, and what needs ROS 2 where it is."""

from importlib.util import find_spec
import re

from hypothesis import settings

settings.register_profile('same', derandomize=True)
settings.register_profile('explore', print_blob=True)   # pytest --hypothesis-profile=explore
settings.load_profile('same')

IMPORTS_ROS = re.compile(
    r'^(from|import) (rclpy|rcl_interfaces|\w+_msgs|quad_ident_ros\.nodes|benchmarks\.load)\b',
    re.MULTILINE)


def pytest_ignore_collect(collection_path):
    """Leave out the tests that import ROS 2 where it is not installed, as on ARM and macOS."""
    if find_spec('rclpy') is not None:
        return None
    if collection_path.name == 'integration':
        return True
    text = collection_path.read_text(encoding='utf-8') if collection_path.is_file() else ''
    return True if IMPORTS_ROS.search(text) else None
