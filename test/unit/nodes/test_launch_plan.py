# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the launch files start; that nodes take these words is in test/integration."""

from launch_files import Tables
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes import diagnoser, identifier, recorder, simulator

FILES = ('identify', 'diagnose')
SPECS = {node.__name__.rpartition('.')[2]: {spec.name: spec for spec in node.SPECS}
         for node in (simulator, recorder, identifier, diagnoser)}


@pytest.mark.parametrize('name', FILES)
def test_arguments_set_parameters_of_their_type(name):
    tables = Tables(name)
    names = [argument.name for argument in tables.arguments]
    assert len(names) == len(set(names))
    for argument in tables.arguments:
        assert argument.description.endswith('.')
        for node, parameter in argument.sets:
            kind = type(SPECS[node][parameter].default)
            assert {tuple: list}.get(kind, kind) is argument.kind, (argument.name, node)
    for node, parameters in tables.usual.items():
        assert set(parameters) <= set(SPECS[node])


@pytest.mark.parametrize('name', FILES)
def test_a_real_vehicle_has_no_simulator(name):
    tables = Tables(name)
    assert list(tables.plan()) == list(tables.nodes)
    plan = tables.plan(simulate='false', window_seconds='20', overlap='0.9', namespace='uav1')
    assert list(plan) == list(tables.nodes[1:])
    assert plan['recorder'] == ['-p', 'window_seconds:=20.0', '-p', 'overlap:=0.9']
    assert plan[tables.nodes[-1]] == []    # its own defaults: they are no simulated vehicle's
    for argument in ('experiment', 'effects', 'real_time_factor'):
        with pytest.raises(InputError, match=f'{argument}: is for the simulator'):
            tables.plan(simulate='false', **{argument: '[]' if argument == 'effects' else '1'})


def test_lists_and_numbers_arrive_as_such():
    plan = Tables('identify').plan(
        effects="['wind:x=3']", seed='7', trim='[6.374, 0, 0, 0]', window='4', experiment='1e3',
        window_samples='500', vehicle='quad.yaml', topics='[input, altitude]',
        windows="['record_long=30,0.5']")
    assert plan['simulator'] == ['-p', 'experiment:="1e3"', '-p', 'effects:=["wind:x=3"]',
                                 '-p', 'vehicle:="quad.yaml"', '-p', 'seed:=7']
    assert plan['recorder'] == ['-p', 'topics:=["input", "altitude"]',
                                '-p', 'window_samples:=500',
                                '-p', 'windows:=["record_long=30,0.5"]']
    assert plan['identifier'] == ['-p', 'vehicle:="quad.yaml"', '-p', 'seed:=7',
                                  '-p', 'window:=4.0', '-p', 'trim:=[6.374, 0.0, 0.0, 0.0]']


@pytest.mark.parametrize(('values', 'said'), [
    ({'effects': 'wind:x=3'}, 'effects: expected a list'), ({'simulate': 'perhaps'}, 'simulate'),
    ({'seed': '1.5'}, 'seed: expected a whole number'), ({'overlap': 'much'}, 'overlap'),
    ({'effects': '[2026-11-23]'}, 'effects: expected texts or numbers'),
    ({'topics': '[[input]]'}, 'topics: expected texts or numbers'),
    ({'trim': '[1, true, 0, 0]'}, 'trim: expected texts or numbers'),
    ({'trim': '[.nan, 0, 0, 0]'}, 'trim'),
    ({'effects': '[2026-99-99]'}, 'effects: expected a list'),
    ({'trim': '[' * 5000}, 'trim: expected a list'),
    ({'window': '[1'}, 'window'), ({'params_file': '/nowhere.yaml'}, 'no such file')])
def test_bad_arguments_are_refused_by_name(values, said):
    with pytest.raises(InputError, match=said):
        Tables('identify').plan(**values)


def test_simulated_time_has_one_clock_in_each_namespace():
    tables = Tables('identify')
    alone, fleet, replayed = (tables.plan(use_sim_time='true', **more) for more in (
        {}, {'namespace': 'uav1'}, {'namespace': 'uav1', 'simulate': 'false'}))
    assert alone['simulator'] == ['-p', 'publish_clock:=true']
    assert alone['recorder'] == alone['identifier'] == ['-p', 'use_sim_time:=true']
    assert all(words[-2:] == ['-r', '/clock:=clock'] for words in fleet.values())
    # The clock of a bag or of another simulator is everybody's.
    assert replayed['recorder'] == ['-p', 'use_sim_time:=true']


def test_a_parameter_file_that_publishes_the_time_has_one_clock_in_each_namespace(tmp_path):
    path = tmp_path / 'some.yaml'
    path.write_text('/**/simulator:\n  ros__parameters:\n    publish_clock: true\n'
                    '/**:\n  ros__parameters:\n    use_sim_time: false\n')
    tables = Tables('identify')
    alone, fleet, others = (tables.plan(params_file=str(path), **more) for more in (
        {}, {'namespace': '/uav1/'}, {'namespace': 'uav1', 'simulate': 'false'}))
    assert all(words[-2:] == ['-r', '/clock:=clock'] for words in fleet.values())
    assert not any('/clock:=clock' in words for words in (*alone.values(), *others.values()))


def test_a_parameter_file_goes_to_those_whom_it_names(tmp_path):
    path = tmp_path / 'some.yaml'
    path.write_text('/**/recorder:\n  ros__parameters:\n    window_samples: 30\n')
    tables = Tables('diagnose')
    plan = tables.plan(params_file=str(path), overlap='0.5', namespace='uav1')
    assert plan['recorder'] == ['--params-file', str(path), '-p', 'overlap:=0.5']
    assert plan['diagnoser'] == ['-p', 'vehicle:="hummingbird"']
    assert 'frame_prefix:="uav1/"' in plan['simulator']
    path.write_text('/uav2/recorder:\n  ros__parameters:\n    window_samples: 30\n')
    with pytest.raises(InputError, match='nothing in .* is for simulator, recorder, diagnoser'):
        tables.plan(params_file=str(path), namespace='uav1')
    assert '--params-file' in tables.plan(params_file=str(path), namespace='/uav2/')['recorder']


def test_arguments_stand_behind_a_parameter_file_and_nothing_before_it(tmp_path):
    """ROS 2 keeps the words of -p where the first of them stands: before the file, they lose."""
    path = tmp_path / 'some.yaml'
    path.write_text('/**/diagnoser:\n  ros__parameters:\n    vehicle: iris\n')
    tables, file = Tables('diagnose'), ['--params-file', str(path)]
    assert tables.plan(params_file=str(path))['diagnoser'] == file
    plan = tables.plan(params_file=str(path), vehicle='quad.yaml', mode='once')
    assert plan['diagnoser'] == [*file, '-p', 'vehicle:="quad.yaml"', '-p', 'mode:="once"']
    path.write_text('/**/diagnoser:\n  ros__parameters:\n    mode: once\n')
    plan = tables.plan(params_file=str(path), mode='continuous')
    assert plan['diagnoser'] == [*file, '-p', 'vehicle:="hummingbird"', '-p', 'mode:="continuous"']


def test_a_parameter_file_that_would_overrule_the_arguments_is_refused(tmp_path):
    path, tables = tmp_path / 'some.yaml', Tables('diagnose')
    everybody = '/**:\n  ros__parameters:\n    use_sim_time: false\n'
    one = '/**/diagnoser:\n  ros__parameters:\n    vehicle: iris\n'
    path.write_text(everybody + one)
    with pytest.raises(InputError, match=r'/\*\*/diagnoser sets .*; move /\*\* to the end of the'):
        tables.plan(params_file=str(path), vehicle='quad.yaml')
    file = ['--params-file', str(path)]
    assert tables.plan(params_file=str(path))['diagnoser'] == file
    assert tables.plan(params_file=str(path), mode='once')['diagnoser'] == [
        *file, '-p', 'mode:="once"']
    path.write_text(one + everybody)
    assert tables.plan(params_file=str(path), vehicle='quad.yaml')['diagnoser'] == [
        *file, '-p', 'vehicle:="quad.yaml"']
