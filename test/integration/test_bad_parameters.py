# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bad parameters are refused with the reason, at the start and while the nodes run."""

from dataclasses import replace

import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.parameter import Parameter

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

NODES = {'simulator': Simulator, 'recorder': Recorder, 'identifier': Identifier,
         'diagnoser': Diagnoser}

# Values, and what the reason names, that are refused at the start and later.
VALUES = {
    'simulator': [
        ('experiment', 'nonsense', "'nonsense' is not among the experiments"),
        ('experiment', '/nowhere/x.yaml', '/nowhere/x.yaml: there is no such file'),
        ('experiment', 3, 'text'),
        ('vehicle', 'paper_quadrotr', "'paper_quadrotr' is not among the vehicles"),
        ('seed', -1, 'seed'),
        ('noise.attitude', 'much', 'noise.attitude'),
        ('noise.altitude', float('nan'), 'noise.altitude'),
        ('noise.rate', -2.0, 'noise.rate'),
        ('effects', ['rotor_drag'], 'expected NAME:PARAMETER=VALUE'),
        ('effects', ['rotor_drag:coefficient=-1'], 'parameter effects: rotor_drag: coefficient'),
        ('effects', ['rotor_drg:coefficient=1'], "did you mean 'rotor_drag'"),
    ],
    'diagnoser': [
        ('vehicle', 'hummingbrd', "'hummingbrd' is not among the vehicles"),
        ('vehicle', '/nowhere/x.yaml', '/nowhere/x.yaml: there is no such file'),
        ('vehicle', 3, 'text'),
        ('effects', ['rotor_drg'], "parameter effects: 'rotor_drg' is not one of"),
        ('mode', 'twice', "'twice' is not one of once, continuous"),
        ('window', -1.0, 'window'),
        ('window', 3.0, 'parameter window: 3 s are too short for a diagnosis'),
        ('tolerance', ['velocty=0.1'], "parameter tolerance: 'velocty' is not known here"),
        ('tolerance', ['velocity'], 'expected GROUP=VALUE'),
        ('tolerance', ['rate=-1'], 'parameter tolerance: rate: -1 is out of range'),
    ],
    'identifier': [
        ('method', 'simplex', "'simplex' is not one of all, pso, cs, pso_cs, ls"),
        ('method', 5, 'method'),
        ('mode', 'twice', "'twice' is not one of once, continuous"),
        ('seed', 1.5, 'seed'),
        ('seed', -1, 'seed'),
        ('window', -1.0, 'window'),
        ('window', float('inf'), 'window'),
        ('lambda', 2.0, 'lambda'),
        ('lambda', 0.0, 'lambda'),
        ('lambda', 1e-300, 'lambda'),
        ('lambda', 1, 'lambda'),
        ('pa', 1.5, 'pa'),
        ('population', 1, 'population'),
        ('generations', 0, 'generations'),
        ('evaluations', -5, 'evaluations'),
        ('pole_bounds', [2.0, 1.0], 'pole_bounds: the lower bound must be below the upper'),
        ('pole_bounds', [1.0, 1.0], 'pole_bounds: the lower bound must be below the upper'),
        ('pole_bounds', [0.0, float('inf')], 'pole_bounds'),
        ('gain_bounds', [1.0], 'parameter gain_bounds: expected 0 or 2 numbers, got 1'),
        ('pole_bounds', ['low', 'high'], 'pole_bounds'),
        ('pole_bounds', [1e300, 1e301], 'parameter pole_bounds[0]: 1e+300 is out of range'),
        ('gain_bounds', [0.0, 1e308], 'parameter gain_bounds[1]: 1e+308 is out of range'),
        ('trim', [1.0, 2.0], 'parameter trim: expected 0 or 4 numbers, got 2'),
        ('trim', [1e308, 0.0, 0.0, 0.0], 'parameter trim[0]: 1e+308 is out of range'),
        ('poles', 'some', "'some' is not one of"),
        ('search', 'none', "'none' is not one of"),
    ],
}
# Parameters that cannot be changed: refused at the start only.
FIXED = {
    'simulator': [('real_time_factor', 2, 'real_time_factor'),
                  ('real_time_factor', -1.0, 'real_time_factor'),
                  ('real_time_factor', float('nan'), 'real_time_factor'),
                  ('publish_clock', 'yes', 'parameter publish_clock: expected true or false')],
    'recorder': [('topics', ['input', 'outputs'], "parameter topics: 'outputs' is not one of"),
                 ('topics', ['input', 'input'], 'name at least one topic, and each once'),
                 ('window_samples', 1, 'window_samples'),
                 ('window_seconds', 0.0, 'window_seconds'),
                 ('overlap', 1.0, 'overlap'),
                 ('output', 3, 'parameter output: expected text, got 3'),
                 ('vehicle_name', 'seven', 'parameter vehicle_name: it names a folder in output'),
                 ('vehicle_name', 'a/b', 'parameter vehicle_name: expected a name'),
                 ('vehicle_name', '2026-05-14', 'expected a name that is no day'),
                 ('vehicle_name', '..', 'begins with no dot')],
}
AT_START = [(node, *case) for cases in (VALUES, FIXED) for node, refused in cases.items()
            for case in refused]


def test_bad_values_are_refused_at_the_start(graph):
    for node, name, value, said in AT_START:
        with pytest.raises(InputError) as caught:
            graph.start(NODES[node], {name: value})
        reason = str(caught.value)
        assert said in reason and len(reason.splitlines()) == 1, (node, name, value, reason)


@pytest.mark.parametrize('node, name, near', [
    ('simulator', 'expriment', 'experiment'), ('recorder', 'windw_samples', 'window_samples'),
    ('identifier', 'metod', 'method'), ('diagnoser', 'vehicel', 'vehicle')])
def test_unknown_names_are_refused_at_the_start(graph, node, name, near):
    with pytest.raises(InputError, match=f'{name!r} is not known here; did you mean {near!r}'):
        graph.start(NODES[node], {name: 1})


@pytest.mark.parametrize('node', VALUES)
def test_bad_values_are_refused_while_the_node_runs(graph, node):
    running = graph.start(NODES[node])
    before = {name: running.get_parameter(name).value for name, _, _ in VALUES[node]}
    types = {spec.name: Parameter.Type(spec.descriptor().type) for spec in running._config.specs}
    for name, value, said in VALUES[node]:
        result = graph.set_parameter(node, name, value)
        assert not result.successful, (name, value)
        given = Parameter(name, value=value).type_
        if given != types[name]:    # rclpy refuses these itself, without the name
            said = f"Wrong parameter type, expected '{types[name]}' got '{given}'"
        assert said in result.reason, (name, value, result.reason)
    assert {name: running.get_parameter(name).value for name in before} == before


@pytest.mark.parametrize('node, name, value', [
    ('simulator', 'real_time_factor', 3.0), ('simulator', 'autostart', False),
    ('recorder', 'window_samples', 10), ('recorder', 'output', '/tmp')])
def test_fixed_parameters_cannot_be_changed(graph, node, name, value):
    running = graph.start(NODES[node])
    before = running.get_parameter(name).value
    result = graph.set_parameter(node, name, value)
    assert not result.successful and 'read-only' in result.reason
    assert running.get_parameter(name).value == before


def test_a_parameter_that_is_not_there_cannot_be_set(graph):
    graph.start(Identifier)
    result = graph.set_parameter('identifier', 'metod', 'ls')
    assert not result.successful and result.reason


@pytest.mark.parametrize('service, answered', [
    (SetParameters, lambda response: response.results),
    (SetParametersAtomically, lambda response: [response.result])])
def test_a_value_of_no_type_is_refused_and_ends_nothing(graph, service, answered):
    running = graph.start(Identifier)
    message = ParameterMessage(name='seed')
    message.value.type = 200
    name = 'set_parameters' + '_atomically' * (service is SetParametersAtomically)
    response = graph.call(service, f'identifier/{name}', service.Request(parameters=[message]))
    [result] = answered(response)
    assert not result.successful
    assert result.reason.startswith('parameter seed: 200 is not the type of a parameter')
    assert running.get_parameter('seed').value == 0
    assert graph.set_parameter('identifier', 'seed', 3).successful


@pytest.mark.parametrize('name', ['seed', 'method', 'lambda', 'pole_bounds'])
def test_a_parameter_cannot_be_unset(graph, name):
    running = graph.start(Identifier)
    before = running.get_parameter(name).value
    message = ParameterMessage(name=name)
    assert message.value.type == ParameterType.PARAMETER_NOT_SET
    response = graph.call(SetParameters, 'identifier/set_parameters',
                          SetParameters.Request(parameters=[message]))
    [result] = response.results
    assert not result.successful and result.reason
    assert running.get_parameter(name).value == before


def test_changes_that_do_not_go_together_are_refused_together(graph):
    running = graph.start(Identifier)

    def change(**values):
        request = SetParametersAtomically.Request(parameters=[
            Parameter(name, value=value).to_parameter_msg() for name, value in values.items()])
        return graph.call(SetParametersAtomically, 'identifier/set_parameters_atomically',
                          request).result

    result = change(seed=5, pole_bounds=[3.0, -3.0])
    assert not result.successful and 'pole_bounds' in result.reason
    assert running.get_parameter('seed').value == 0
    assert change(seed=5, pole_bounds=[-3.0, 3.0]).successful
    response = graph.call(GetParameters, 'identifier/get_parameters',
                          GetParameters.Request(names=['seed', 'pole_bounds']))
    assert response.values[0].integer_value == 5
    assert list(response.values[1].double_array_value) == [-3.0, 3.0]


@pytest.mark.parametrize('node', NODES)
def test_parameters_are_described(graph, node):
    running = graph.start(NODES[node])
    names = [spec.name for spec in running._config.specs]
    response = graph.call(DescribeParameters, f'{node}/describe_parameters',
                          DescribeParameters.Request(names=names))
    assert len(response.descriptors) == len(names) >= 4
    for spec, descriptor in zip(running._config.specs, response.descriptors, strict=True):
        assert descriptor.name == spec.name
        assert descriptor.description.startswith(spec.description)
        assert descriptor.type == spec.descriptor().type
        assert descriptor.read_only == spec.fixed
        assert bool(descriptor.integer_range or descriptor.floating_point_range
                    or ' Each from ' in descriptor.description) == bool(spec.limits)


def test_noise_that_a_closed_loop_does_not_know_is_refused(graph):
    """There position is one sensor: it has no altitude of its own."""
    with pytest.raises(InputError, match="noise of a flight in closed loop: 'altitude'"):
        graph.start(Simulator, {'experiment': 'closed_loop', 'noise.altitude': 0.1})


def test_effects_can_be_switched_on_and_off_while_the_node_runs(graph):
    running = graph.start(Simulator, {'experiment': 'closed_loop',
                                      'effects': ['wind:x=1', 'rotor_drag:coefficient=0.2']})
    result = graph.set_parameter('simulator', 'effects', ['wind:x=30'])
    assert not result.successful and 'out of range' in result.reason
    assert graph.set_parameter('simulator', 'effects', ['wind:x=3']).successful
    assert list(running.get_parameter('effects').value) == ['wind:x=3']


def test_a_nominal_vehicle_may_have_the_effects_of_a_simulator(graph, tmp_path):
    path = tmp_path / 'simulator.yaml'
    vehicle = load_vehicle('hummingbird')
    write_vehicle(path, replace(vehicle, effects={'motor_lag': {'time_constant': 0.03}}))
    running = graph.start(Diagnoser)
    assert graph.set_parameter('diagnoser', 'vehicle', str(path)).successful
    assert running.get_parameter('vehicle').value == str(path)
