# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What `ros2 topic echo --once` prints: it cuts texts and lists at 128."""

from pathlib import Path
import re

import numpy as np
import pytest

from quad_ident_ros.nodes import diagnoser, identifier, recorder, simulator
from quad_ident_ros.nodes.messages import parameter_message

ROOT = Path(__file__).parents[3]
CUT = 128
JSON = ('diagnosis', 'parameters_json', 'run', 'statistics', 'progress')   # texts of any length
PAGES = {'README.md': (ROOT / 'README.md').read_text(encoding='utf-8'),
         **{path.name: path.read_text(encoding='utf-8')
            for path in (ROOT / 'docs').rglob('*.md')},
         **{module.__name__: module.HELP for module in (simulator, recorder, identifier,
                                                        diagnoser)}}


@pytest.mark.parametrize('page', PAGES)
def test_examples_that_print_json_print_all_of_it(page):
    for line in re.findall(r'ros2 topic echo .*', PAGES[page]):
        topic = line.split()[3].rpartition('/')[2]
        assert topic not in JSON or '--full-length' in line, line


def test_parameters_are_readable_without():
    message = parameter_message(np.ones((4, 3)))
    assert len(message.data) <= CUT
    assert all(len(dim.label) <= CUT for dim in message.layout.dim)
