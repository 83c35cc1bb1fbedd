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

    def describe(file, around=None, **given):
        spec = spec_from_file_location(file, FOLDER / f'{file}.launch.py')
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        *arguments, start = module.generate_launch_description().entities
        defaults = {argument.name: argument.default_value for argument in arguments}
        assert set(given) <= set(defaults) and all(one.description for one in arguments)
        pushed = {'ros_namespace': around} if around else {}
        return defaults, start.function(SimpleNamespace(
            launch_configurations=defaults | given | pushed))

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
        for code in (0, 1, 2, -signal.SIGINT, -signal.SIGTERM):
            assert node.ended_by(code) == reason


def test_arguments_that_are_given_arrive_at_their_nodes(described):
    defaults, nodes = described('identify', effects="['wind:x=3']", window_seconds='4',
                                trim='[6.4, 0, 0, 0]', seed='7')
    assert {'simulate', 'params_file', 'namespace', 'effects', 'trim', 'seed'} <= set(defaults)
    words = {node.name: node.ros_arguments for node in nodes}
    assert 'effects:=["wind:x=3"]' in words['simulator'] and 'seed:=7' in words['simulator']
    assert words['recorder'] == ['-p', 'window_seconds:=4.0']
    assert 'trim:=[6.4, 0.0, 0.0, 0.0]' in words['identifier']


@pytest.mark.parametrize(('around', 'namespace', 'prefix'), [
    ('/fleet', '', 'fleet/'), ('/fleet', 'uav1', 'fleet/uav1/'), ('/fleet', '/uav1', 'uav1/'),
    ('/', 'uav1', 'uav1/'), (None, 'uav1', 'uav1/'), (None, '', '')])
def test_a_launch_file_that_is_included_has_the_namespace_around_it(
        described, tmp_path, around, namespace, prefix):
    """PushRosNamespace: two vehicles published one /clock, and their files were for nobody."""
    file = tmp_path / 'some.yaml'
    file.write_text(f'/{prefix}recorder:\n  ros__parameters:\n    overlap: 0.2\n')
    _, nodes = described('identify', around=around, namespace=namespace, use_sim_time='true',
                         params_file=str(file))
    for node in nodes:
        assert node.namespace == namespace      # launch_ros joins them once more
        assert (node.ros_arguments[-2:] == ['-r', '/clock:=clock']) is bool(prefix)
    words = {node.name: node.ros_arguments for node in nodes}
    assert str(file) in words['recorder'] and str(file) not in words['identifier']
    assert (f'frame_prefix:="{prefix}"' in words['simulator']) is bool(prefix)
