# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The tables of the launch files, read without `launch`, which only a whole ROS 2 has."""

import ast
from pathlib import Path

from quad_ident_ros.nodes import launch_plan

FOLDER = Path(__file__).parents[2] / 'launch'


class Tables:
    """NODES, ARGUMENTS and USUAL of a launch file."""

    def __init__(self, name):
        tree = ast.parse((FOLDER / f'{name}.launch.py').read_text(encoding='utf-8'))
        tree.body = [part for part in tree.body if isinstance(part, ast.Assign)]
        found = {'Argument': launch_plan.Argument, 'COMMON': launch_plan.COMMON}
        exec(compile(tree, name, 'exec'), found)
        self.nodes, self.arguments = found['NODES'], found['ARGUMENTS']
        self.usual = found['USUAL']

    def plan(self, **values):
        """Return {node: words} of what is started with some arguments given."""
        texts = {argument.name: values.get(argument.name, argument.default)
                 for argument in self.arguments}
        assert set(values) <= set(texts)
        return {one.node: list(one.words) for one in
                launch_plan.planned(self.nodes, self.arguments, texts, self.usual)}
