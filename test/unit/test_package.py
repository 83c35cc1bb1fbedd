# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The dependencies that package.xml states are those that the nodes and launch files import."""

import ast
from pathlib import Path
import sys
from xml.etree import ElementTree

from test_imports import imported

from quad_ident_ros.nodes.other_types import BY_NAME

ROOT = Path(__file__).parents[2]
PACKAGE = ElementTree.parse(ROOT / 'package.xml').getroot()
DEPENDENCIES = {entry.text: entry.get('condition') for entry in PACKAGE.iter('exec_depend')}


def test_what_is_imported_is_needed_and_nothing_else_of_ros_is():
    files = [*(ROOT / 'quad_ident_ros' / 'nodes').glob('*.py'), *(ROOT / 'launch').glob('*.py')]
    names = {name.partition('.')[0] for file in files
             for name in imported(ast.parse(file.read_text(encoding='utf-8')))}
    of_ros = names - set(sys.stdlib_module_names) - {'quad_ident_ros', 'numpy', 'yaml'}
    assert of_ros == {name for name, condition in DEPENDENCIES.items()
                      if condition is None and not name.startswith('python3-')}


def test_messages_of_others_are_optional():
    """The recorder takes them where they are installed, and all else works without them."""
    optional = {name for name, condition in DEPENDENCIES.items() if condition is not None}
    assert {kind.partition('/')[0] for kind in BY_NAME} <= optional
