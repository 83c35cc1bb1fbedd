# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The mapping file, and the rotor speeds that outputs stand for."""

from dataclasses import replace
import math
from pathlib import Path
import re

from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from reader_checks import FAST
import yaml

from quad_ident_ros.data.mapping import Actuators, mapping_from, rotor_speeds
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import motors_from
from quad_ident_ros.model.vehicle import load_vehicle


def test_the_mapping_file_of_the_documents_is_one():
    text = (Path(__file__).parents[3] / 'docs' / 'records.md').read_text(encoding='utf-8')
    blocks = [block.split('```')[0] for block in text.split('```yaml\n')[1:]]
    assert len(blocks) >= 2
    for block in blocks:
        data = yaml.safe_load(block)
        if 'motors' in data:    # of a vehicle file
            motors_from('docs', data.pop('motors'))
        mapping_from(data, 'docs')


def test_the_lines_of_the_table_of_the_nodes_are_a_mapping():
    """Each row names topics of its middleware, and what goes with them."""
    text = (Path(__file__).parents[3] / 'docs' / 'nodes.md').read_text(encoding='utf-8')
    table = text.split('| from | lines | also needed |\n')[1].split('\n\n')[0].splitlines()[1:]
    assert len(table) == 4
    for row in table:
        lines = re.findall(r'`([a-z_]+): ?(\{.*?\}|`)', row)
        topics, mapping, last = {}, {}, None
        for role, entry in lines:
            entry = entry.replace('[low, high]', '[100, 900]').replace('[...]', '[1, 2, 3, 4]')
            if role == 'actuators':
                mapping['actuators'] = yaml.safe_load(entry)
            else:
                topics[role] = last = last if entry == '`' else yaml.safe_load(entry)
        found = mapping_from({'topics': topics, **mapping}, row)
        assert {'pose', 'rate', 'specific_force', 'commands'} <= set(found.topics)


def test_the_table_of_the_readme_names_the_topics_of_that_of_the_nodes():
    root = Path(__file__).parents[3]
    table = (root / 'README.md').read_text('utf-8').split('| `actuators` |\n')[1].split('\n\n')[0]
    longer = (root / 'docs' / 'nodes.md').read_text(encoding='utf-8').splitlines()
    rows = table.splitlines()[1:]
    assert len(rows) == 4
    for row in rows:
        _, system, *cells, outputs, _ = (cell.strip() for cell in row.split('|'))
        [whole] = [line for line in longer if line.startswith(f'| {system} |')]
        topics = [re.findall(r'`(/\S+)`', cell) for cell in cells]
        assert [len(named) for named in topics] == [1, 1, 1, 1], row
        assert all(f'{{topic: {topic}' in whole for [topic] in topics), row
        assert outputs.strip('`') in whole, row


@pytest.mark.parametrize('data, said', [
    ({'topics': {'rate': {'topic': '/a', 'unit': 'deg'}}}, 'deg/s'),
    ({'topics': {'rotors': {'topic': '/a', 'unit': 'deg/s'}}}, 'rpm'),
    ({'topics': {'commands': {'topic': '/a', 'unit': 'rpm'}}}, 'unit'),
    ({'topic': {}}, "did you mean 'topics'"), ({'topics': 3}, 'topics'),
    ({'topics': {'pos': {}}}, "did you mean 'pose'"), ({'topics': {'pose': {}}}, 'topic'),
    ({'topics': {'pose': {'topic': 3}}}, 'expected a name'), ({'world': 'UP'}, 'ENU, NED'),
    ({'topics': {'pose': {'topic': '/a', 'field': 3}}}, 'field'),
    ({'topics': {'pose': {'topic': '/tf', 'child': ''}}}, 'child: expected a name'),
    ({'topics': {'rate': {'topic': '/tf', 'child': 'x'}}}, 'child'),
    ({'topics': {'rate': {'topic': '/a', 'frame': 'world'}}}, 'frame'),
    ({'actuators': {}}, 'kind'), ({'actuators': {'kind': 'duty'}}, 'pwm'),
    ({'actuators': {'kind': 'pwm', 'minimum': 2000, 'maximum': 2000}}, 'maximum'),
    ({'actuators': {'kind': 'pwm', 'order': [1, 1]}}, 'twice'),
    ({'actuators': {'kind': 'pwm', 'order': [0]}}, 'at least 1'),
    ({'actuators': {'kind': 'pwm', 'order': []}}, 'order'),
    ({'actuators': {'kind': 'rpm', 'minimum': 0}}, 'leave it out'),
    ({'actuators': {'kind': 'pwm', 'speeds': [5, 5]}}, 'speeds'),
    ({'instances': {'actuator_outputs': -1}}, 'at least 0'), ({'instances': 3}, 'instances')])
def test_bad_mappings_are_refused(data, said):
    with pytest.raises(InputError, match='m.yaml') as caught:
        mapping_from(data, 'm.yaml')
    assert said in str(caught.value)


def test_outputs_become_speeds():
    linear = mapping_from({'actuators': {'kind': 'pwm', 'speeds': [200, 1000]}}, 'm').actuators
    outputs = np.array([[900.0, 1000.0, 1500.0, 2100.0, np.nan]])
    np.testing.assert_allclose(rotor_speeds('x', outputs, linear, None),
                               [[0, 200, 600, 1000, 0]])
    thrust = mapping_from({'actuators': {'kind': 'normalised', 'curve': 'thrust',
                                         'speeds': [0, 1000]}}, 'm').actuators
    np.testing.assert_allclose(rotor_speeds('x', [[0.25, 1.0]], thrust, None), [[500, 1000]])
    rpm = mapping_from({'actuators': {'kind': 'rpm'}}, 'm').actuators
    np.testing.assert_allclose(rotor_speeds('x', [[60.0]], rpm, None), [[2 * np.pi]])


def test_speeds_that_no_file_has_are_asked_for():
    vehicle = replace(load_vehicle('iris'), motors=None, speed_max=math.inf)
    with pytest.raises(InputError, match='give speeds: .low, high.*speed_max') as caught:
        rotor_speeds('x', [[0.5] * 4], Actuators((1, 2, 3, 4), 'normalised'), vehicle)
    assert len(str(caught.value).splitlines()) == 1


def test_limits_that_a_mapping_does_not_give_are_those_of_the_motors_of_the_vehicle():
    motors = motors_from('v', {'kind': 'pwm', 'minimum': 1100, 'maximum': 1940,
                               'speed': {'offset': 100, 'gain': 900}})
    vehicle = replace(load_vehicle('iris'), motors=motors)
    outputs = [[1100, 1520, 1940, 2000]]

    def speeds(**entries):
        actuators = mapping_from({'actuators': {'kind': 'pwm', **entries}}, 'm').actuators
        return rotor_speeds('x', outputs, actuators, vehicle)

    np.testing.assert_allclose(speeds(order=[4, 3, 2, 1]), [[1000, 1000, 550, 100]])
    np.testing.assert_allclose(speeds(maximum=2360), [[100, 400, 700, 100 + 900 * 900 / 1260]])
    np.testing.assert_allclose(speeds(speeds=[0, 840]), [[0, 420, 840, 840]])
    with pytest.raises(InputError, match='maximum: 1000 is not above the minimum, 1100'):
        speeds(maximum=1000)


def test_a_map_of_another_kind_is_not_taken_for_that_of_the_outputs():
    motors = motors_from('v', {'kind': 'normalised', 'speed': {'offset': 100, 'gain': 900}})
    vehicle = replace(load_vehicle('iris'), motors=motors)
    with pytest.raises(InputError, match='is of normalised; give minimum and max') as caught:
        rotor_speeds('x', [[1500] * 4], Actuators(kind='pwm'), vehicle)
    assert len(str(caught.value).splitlines()) == 1
    for said in ({'minimum': 1000, 'maximum': 2000}, {'speeds': (100, 1000)}):
        speeds = rotor_speeds('x', [[1500] * 4], Actuators(kind='pwm', **said), vehicle)
        np.testing.assert_allclose(speeds, [[550] * 4])


@given(st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
                    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(
                        st.sampled_from(['topics', 'pose', 'topic', 'actuators', 'kind', 'order',
                                         'world', 'instances', 'x', 3]), inner, max_size=4)))
@FAST
def test_any_yaml_is_a_mapping_or_is_refused_in_a_line(data):
    try:
        mapping_from(data, 'm')
    except InputError as error:
        assert len(str(error).splitlines()) == 1
