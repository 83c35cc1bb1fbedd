# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The nodes that launch files start, as processes with the words that they get."""

from pathlib import Path
import re
import shlex

from graph import write_experiment
from launch_files import Tables
import pytest
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.nodes.qos import latched

ROOT = Path(__file__).parents[2]


def recipes():
    """Return (launch file, {argument: value}) of each launch that the pages print as a block."""
    pages = (ROOT / 'README.md', *sorted((ROOT / 'docs').rglob('*.md')))
    text = '\n'.join(page.read_text(encoding='utf-8') for page in pages)
    lines = re.findall(r'^    ros2 launch quad_ident_ros (\w+)\.launch\.py (.*)',
                       text.replace('\\\n', ' '), re.M)
    return [(name, dict(word.split(':=', 1) for word in shlex.split(words)))
            for name, words in lines]


RECIPES = recipes()


def start(processes, plan, namespace=''):
    # What launch_ros adds by itself.
    name = ['-r', f'__ns:=/{namespace}'] if namespace else []
    return [processes.run(node, '--ros-args', *words, '--ros-args', *name)
            for node, words in plan.items()]


def parameters(graph, node, *names):
    values = graph.call(GetParameters, f'uav1/{node}/get_parameters',
                        GetParameters.Request(names=names)).values
    return [found.tolist() if hasattr(found, 'tolist') else found
            for found in map(parameter_value_to_python, values)]


def test_a_parameter_file_has_the_say_over_usual_values_and_arguments_over_it(
        graph, processes, tmp_path):
    path = write_experiment(tmp_path / 'short.yaml', {'z': (0.5, {'U1': 1.0})})
    file = tmp_path / 'some.yaml'
    file.write_text(f"""/**/simulator:
  ros__parameters:
    experiment: {path}
    real_time_factor: 5.0
    autostart: false
/**/recorder:
  ros__parameters:
    window_samples: 30
    overlap: 0.2
/uav1/diagnoser:
  ros__parameters:
    vehicle: iris
    mode: continuous
""")
    statistics = graph.listen(String, 'uav1/run', latched(32))
    plan = Tables('diagnose').plan(namespace='uav1', params_file=str(file), overlap='0.0',
                                   real_time_factor='0.0', seed='3', vehicle='crazyflie')
    nodes = start(processes, plan, 'uav1')
    assert graph.trigger('uav1/simulator/start').message == 'short: 1 runs to fly'
    graph.spin_until(lambda: statistics, 'the flight', 60.0)
    assert statistics.data()[0]['info']['seed'] == 3
    said = 'ready: diagnosing what comes on /uav1/record'
    graph.spin_until(lambda: said in nodes[2].errors(), 'the diagnoser', 90.0)
    assert parameters(graph, 'simulator', 'real_time_factor', 'autostart') == [0.0, False]
    assert parameters(graph, 'recorder', 'window_samples', 'overlap') == [30, 0.0]
    assert parameters(graph, 'diagnoser', 'vehicle', 'mode') == ['crazyflie', 'continuous']
    assert [node.stop() for node in nodes] == [0, 0, 0], [node.errors() for node in nodes]


def test_two_namespaces_have_two_clocks(graph, processes, tmp_path):
    """Each recorder follows the clock of its own simulator, and nobody publishes /clock."""
    tables = Tables('identify')
    everybody = graph.listen(Clock, '/clock', 10)
    clocks = {name: graph.listen(Clock, f'/{name}/clock', 100) for name in ('uav1', 'uav2')}
    records = {name: graph.listen(String, f'/{name}/run', latched(32)) for name in clocks}
    nodes = []
    for name in clocks:
        path = write_experiment(tmp_path / f'{name}.yaml', {'z': (30.0, {'U1': 0.1})})
        plan = tables.plan(namespace=name, use_sim_time='true', experiment=path,
                           real_time_factor='1.0')
        nodes += start(processes, {node: words for node, words in plan.items()
                                   if node != 'identifier'}, name)
    graph.spin_until(lambda: all(clocks.values()) and all(records.values()), 'the clocks', 60.0)
    for name in clocks:    # names of nodes come later than their topics
        graph.spin_until(lambda space=f'/{name}': ('recorder', space) in [
            (info.node_name, info.node_namespace)
            for info in graph.probe.get_subscriptions_info_by_topic(f'{space}/clock')],
            'the recorder to follow the clock')
    assert not graph.probe.get_publishers_info_by_topic('/clock') and not everybody


def test_the_pages_launch_a_real_vehicle():
    assert [(name, words['simulate']) for name, words in RECIPES] == [('identify', 'false')]


@pytest.mark.parametrize(('name', 'values'), RECIPES)
def test_the_nodes_of_a_launch_start_as_the_pages_print_it(
        graph, processes, tmp_path, monkeypatch, name, values):
    monkeypatch.chdir(tmp_path)     # of the files that are named
    write_vehicle(values['vehicle'], load_vehicle('hummingbird'))
    Path(values['params_file']).write_text(
        '/**/recorder:\n  ros__parameters:\n    overlap: 0.2\n    gap: 0.05\n')
    plan = Tables(name).plan(**values)
    nodes = start(processes, plan, 'uav1')
    for node in nodes:
        graph.spin_until(lambda n=node: 'ready: ' in n.errors() or not n.running(),
                         f'{node.node} to be ready', 120.0)
    # An argument has the say over the file, which has it over the default.
    assert parameters(graph, 'recorder', 'overlap', 'gap') == [float(values['overlap']), 0.05]
    assert parameters(graph, 'identifier', 'trim', 'mode', 'method') == [
        [6.374, 0.0, 0.0, 0.0], values['mode'], values['method']]
    assert [node.stop() for node in nodes] == [0, 0], [node.errors() for node in nodes]
