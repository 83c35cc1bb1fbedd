# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What ROS 2 packages are checked by: ament_flake8, ament_pep257 and ament_copyright.

The first is configured in test/ament_flake8.ini, the second as it ships. The third knows headers
with the text of a licence alone; those here name it by its SPDX identifier, which
test_repository.py asks of each file.
"""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PARTS = ('benchmarks', 'docs', 'launch', 'quad_ident_ros', 'setup.py', 'soak', 'test',
         'withheld')


def paths():
    return [str(ROOT / part) for part in PARTS]


@pytest.mark.slow
# Its plug-ins use what Python has announced to remove.
@pytest.mark.filterwarnings('ignore')
def test_ament_flake8():
    main = pytest.importorskip('ament_flake8.main', reason='comes with a whole ROS 2')
    code, errors = main.main_with_errors(
        ['--config', str(ROOT / 'test' / 'ament_flake8.ini'), *paths()])
    assert code == 0, '\n'.join(errors)


def test_ament_pep257(capsys):
    main = pytest.importorskip('ament_pep257.main', reason='comes with a whole ROS 2')
    assert main.main(paths()) == 0, capsys.readouterr().err
