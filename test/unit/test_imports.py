# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Everything but nodes/ works where there is no ROS."""

import ast
from importlib.util import find_spec
from pathlib import Path
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / 'quad_ident_ros'
ROS = ('rclpy', 'rcl_interfaces', 'builtin_interfaces', 'action_msgs', 'diagnostic_msgs',
       'geometry_msgs', 'rosgraph_msgs', 'std_msgs', 'std_srvs', 'rosidl_runtime_py',
       'rosidl_parser', 'ament_index_python', 'launch', 'launch_ros', 'unique_identifier_msgs')
SOURCES = sorted(path for path in PACKAGE.rglob('*.py')
                 if path.relative_to(PACKAGE).parts[0] != 'nodes')
MODULES = ['.'.join(path.relative_to(ROOT).with_suffix('').parts).removesuffix('.__init__')
           for path in SOURCES]

# Run in a process of its own: what this one has imported is no evidence.
BLOCKED = f"""
import importlib, sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in {ROS!r}:
            raise ModuleNotFoundError(f'{{name}} is blocked', name=name)

sys.meta_path.insert(0, Blocker())
sys.path.insert(0, {str(ROOT)!r})
"""


def run(code):
    return subprocess.run([sys.executable, '-c', BLOCKED + code], capture_output=True, text=True,
                          timeout=1200)     # it compiles, beside whatever else runs


def test_the_blocker_blocks():
    # Else the tests below could not fail.
    done = run('import rclpy')
    assert done.returncode != 0 and 'rclpy is blocked' in done.stderr
    done = run('import quad_ident_ros.nodes.simulator')
    assert done.returncode != 0 and 'is blocked' in done.stderr


@pytest.mark.slow
def test_a_start_does_not_wait_for_what_only_some_work_needs():
    """
    Statistics and filters of SciPy take half as long to load as all the rest.

    What none of the modules has loaded after all the others, none of them loads alone.
    """
    names = ['diagnose.diagnosis', 'identify.identify', 'cli.info', 'cli.fly', 'data.frame_watch',
             'flight.fly']
    done = run(f"""
for name in {names!r}:
    importlib.import_module(f'quad_ident_ros.{{name}}')
    print(name, *{{'scipy.stats', 'scipy.signal', 'scipy.interpolate'}} & {{*sys.modules}})
""")
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.splitlines() == names


@pytest.mark.slow
def test_every_module_but_nodes_imports_without_ros():
    assert 'quad_ident_ros.identify.identify' in MODULES and len(MODULES) > 30
    # __main__ runs the command line on import: it is started below.
    extras = {'quad_ident_ros.watch.view': 'textual', 'quad_ident_ros.fleet.': 'pyarrow'}
    missing = tuple(name for name, package in extras.items() if not find_spec(package))
    names = [name for name in MODULES
             if not name.endswith('__main__') and not name.startswith(missing)]
    done = run(f'for name in {names!r}: importlib.import_module(name)')
    assert done.returncode == 0, done.stderr[-2000:]


@pytest.mark.slow
def test_a_whole_identification_runs_without_ros():
    done = run("""
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.identify import identify
experiment = load_experiment('hover_single_axis')
result = identify([fly(experiment, experiment.runs[3]).record])
print(result.methods['ls'].outputs['z'].model.gain)
""")
    assert done.returncode == 0, done.stderr[-2000:]
    assert float(done.stdout) == pytest.approx(1 / 0.65, rel=1e-6)


def imported(tree):
    """Return the names that any import statement under a node names."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or '.'


@pytest.mark.parametrize('path', SOURCES, ids=[str(path.relative_to(PACKAGE)) for path in SOURCES])
def test_no_source_outside_nodes_imports_ros(path):
    tree = ast.parse(path.read_text(encoding='utf-8'))
    assert not [name for name in imported(tree) if name.partition('.')[0] in ROS]
    # A command that starts nodes imports them where it starts them, not at the top.
    for statement in tree.body:
        if not isinstance(statement, ast.FunctionDef | ast.ClassDef):
            assert not [name for name in imported(statement)
                        if name.startswith('quad_ident_ros.nodes')]
