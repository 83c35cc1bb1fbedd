# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the launch files hand to `launch`: arguments, and what the end of each node leads to.

`launch` comes with a whole ROS 2 alone. Stand-ins take its place, which take the arguments that
launch 3.4 and launch_ros 0.26 (Jazzy) take, and keep what they are given.
"""

from importlib.util import module_from_spec, spec_from_file_location
import signal
import sys
from types import ModuleType, SimpleNamespace

from launch_files import FOLDER
import pytest

FILES = {'identify': ['simulator', 'recorder', 'identifier'],
         'diagnose': ['simulator', 'recorder', 'diagnoser']}


class LaunchDescription:

    def __init__(self, initial_entities=None):
        self.entities = list(initial_entities)


class DeclareLaunchArgument:

    def __init__(self, name, *, default_value=None, description=None):
        self.name, self.default_value, self.description = name, default_value, description


class OpaqueFunction:

    def __init__(self, *, function):
        self.function = function


class Shutdown:

    def __init__(self, *, reason='reason not given'):
        self.reason = reason


class LaunchConfiguration:

    def __init__(self, variable_name):
        self.name = variable_name

    def perform(self, context):
        return context.launch_configurations[self.name]


class Node:

    def __init__(self, *, executable, package=None, name=None, namespace=None,
                 ros_arguments=None, output=None, on_exit=None, respawn=False,
                 respawn_delay=None):
        self.executable, self.package, self.name = executable, package, name
        self.namespace, self.ros_arguments = namespace, ros_arguments
        self.respawn, self.respawn_delay, self._on_exit = respawn, respawn_delay, on_exit

    def ended_by(self, code):
        """Return the reasons for which its end with an exit code ends all."""
        return [one.reason for one in self._on_exit(SimpleNamespace(returncode=code), None) or ()]


@pytest.fixture
def described(monkeypatch):
    """Return a function: the arguments (name: default) and nodes of a launch file."""
    names = {'launch': {'LaunchDescription': LaunchDescription},
             'launch.actions': {'DeclareLaunchArgument': DeclareLaunchArgument,
                                'OpaqueFunction': OpaqueFunction, 'Shutdown': Shutdown},
             'launch.substitutions': {'LaunchConfiguration': LaunchConfiguration},
             'launch_ros': {}, 'launch_ros.actions': {'Node': Node}}
    for name, values in names.items():
        module = ModuleType(name)
        vars(module).update(values)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, 'quad_ident_ros.nodes.launching', raising=False)

    def describe(file, **given):
        spec = spec_from_file_location(file, FOLDER / f'{file}.launch.py')
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        *arguments, start = module.generate_launch_description().entities
        defaults = {argument.name: argument.default_value for argument in arguments}
        assert set(given) <= {*defaults, 'ros_namespace'}
        assert all(one.description for one in arguments)
        return defaults, start.function(SimpleNamespace(launch_configurations=defaults | given))

    yield describe
    sys.modules.pop('quad_ident_ros.nodes.launching', None)


@pytest.mark.parametrize('file', FILES)
@pytest.mark.parametrize('simulate', ['true', 'false'])
@pytest.mark.parametrize('respawn', ['', 'true', 'false'])
def test_all_nodes_end_when_one_of_them_does_unless_it_is_started_once_more(
        described, file, simulate, respawn):
    """A vehicle flies on where a node is killed; a simulated flight ends with its simulator."""
    _, nodes = described(file, simulate=simulate, namespace='uav1', respawn=respawn)
    expected = FILES[file][simulate == 'false':]
    assert [node.executable for node in nodes] == [node.name for node in nodes] == expected
    again = respawn == 'true' or (simulate, respawn) == ('false', '')
    for node in nodes:
        assert (node.package, node.namespace) == ('quad_ident_ros', 'uav1')
        assert node.respawn is again and node.respawn_delay > 0.0
        reason = [f'{node.name} has ended']
        for killed in (signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT):
            assert node.ended_by(-killed) == ([] if again else reason)
        # It was told to end, or refuses its parameters, which a new start would not mend.
        for code in (0, 1, 2, -signal.SIGINT, -signal.SIGTERM, -signal.SIGALRM):
            assert node.ended_by(code) == reason


def test_arguments_that_are_given_arrive_at_their_nodes(described):
    defaults, nodes = described('identify', effects="['wind:x=3']", window_seconds='4',
                                trim='[6.4, 0, 0, 0]', seed='7')
    assert {'simulate', 'params_file', 'namespace', 'effects', 'trim', 'seed'} <= set(defaults)
    words = {node.name: node.ros_arguments for node in nodes}
    assert 'effects:=["wind:x=3"]' in words['simulator'] and 'seed:=7' in words['simulator']
    assert words['recorder'] == ['-p', 'window_seconds:=4.0']
    assert 'trim:=[6.4, 0.0, 0.0, 0.0]' in words['identifier']


@pytest.mark.parametrize(('namespace', 'whole', 'prefix'), [
    ('', '/fleet/uav1', 'fleet/uav1/'), ('left', '/fleet/uav1/left', 'fleet/uav1/left/'),
    ('/uav2', '/uav2', 'uav2/')])
def test_the_namespace_of_a_group_counts(described, tmp_path, namespace, whole, prefix):
    """A group (PushRosNamespace) has it in ros_namespace; launch_ros puts it before a node's."""
    file = tmp_path / 'some.yaml'
    file.write_text(f'{whole}/recorder:\n  ros__parameters:\n    overlap: 0.5\n')
    _, nodes = described('identify', ros_namespace='/fleet/uav1', namespace=namespace,
                         use_sim_time='true', params_file=str(file))
    assert {node.namespace for node in nodes} == {namespace}
    words = {node.name: node.ros_arguments for node in nodes}
    assert words['recorder'][:2] == ['--params-file', str(file)]
    assert f'frame_prefix:="{prefix}"' in words['simulator']
    assert all('/clock:=clock' in each for each in words.values())
