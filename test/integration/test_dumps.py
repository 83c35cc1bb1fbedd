# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What `ros2 param set`, `dump` and `load` send, and parameter files of dumps."""

import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.parameter import (
    get_parameter_value,
    parameter_dict_from_yaml_file,
    parameter_value_to_python,
)
import yaml

from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

NODES = {'simulator': Simulator, 'recorder': Recorder, 'identifier': Identifier,
         'diagnoser': Diagnoser}
FILLED = [('simulator', 'effects', ['rotor_drag:coefficient=0.2']),
          ('diagnoser', 'effects', ['wind', 'rotor_drag']),
          ('diagnoser', 'tolerance', ['velocity=0.1']),
          ('identifier', 'pole_bounds', [-1.0, 1.0]),
          ('identifier', 'trim', [6.0, 0.0, 0.0, 0.0])]


def dump(graph, node, path):
    """Write the parameters of a node as `ros2 param dump` does."""
    names = graph.call(ListParameters, f'{node}/list_parameters').result.names
    values = graph.call(GetParameters, f'{node}/get_parameters',
                        GetParameters.Request(names=names)).values
    data = {name: plain(parameter_value_to_python(value))
            for name, value in zip(names, values, strict=True)}
    path.write_text(yaml.safe_dump({f'/{node}': {'ros__parameters': data}}), encoding='utf-8')


def plain(value):
    return list(value) if hasattr(value, '__len__') and not isinstance(value, str) else value


def now(node):
    return {name: plain(value) for name, value in node._config.values().items()}


@pytest.mark.parametrize(('node', 'name', 'value'), FILLED)
def test_lists_can_be_emptied_while_the_node_runs(graph, node, name, value):
    given = {'experiment': 'closed_loop'} if node == 'simulator' else {}
    running = graph.start(NODES[node], {**given, name: value})
    assert list(running.get_parameter(name).value) == value
    message = ParameterMessage(name=name, value=get_parameter_value('[]'))   # as the command does
    [result] = graph.call(SetParameters, f'{node}/set_parameters',
                          SetParameters.Request(parameters=[message])).results
    assert result.successful, result.reason
    assert list(running.get_parameter(name).value) == list(running._config[name]) == []
    assert graph.set_parameter(node, name, value).successful


def test_a_list_that_must_not_be_empty_stays(graph):
    running = graph.start(Recorder)
    message = ParameterMessage(name='topics', value=get_parameter_value('[]'))
    [result] = graph.call(SetParameters, 'recorder/set_parameters',
                          SetParameters.Request(parameters=[message])).results
    assert not result.successful and running.get_parameter('topics').value


@pytest.mark.parametrize('node', NODES)
def test_a_node_loads_its_own_dump(graph, node, tmp_path):
    running = graph.start(NODES[node])
    path = tmp_path / 'dump.yaml'
    dump(graph, node, path)
    before = now(running)
    wanted = list(parameter_dict_from_yaml_file(str(path), True).values())
    results = graph.call(SetParameters, f'{node}/set_parameters',
                         SetParameters.Request(parameters=wanted)).results
    assert [one.reason for one in results if not one.successful] == []
    assert len(results) > len(before) and now(running) == before


@pytest.mark.parametrize('node', NODES)
def test_a_dump_is_a_parameter_file(graph, node, tmp_path):
    running = graph.start(NODES[node])
    before = now(running)
    dump(graph, node, tmp_path / 'dump.yaml')
    graph.stop(running)
    again = graph.start(NODES[node], arguments=('--params-file', str(tmp_path / 'dump.yaml')))
    assert now(again) == before
