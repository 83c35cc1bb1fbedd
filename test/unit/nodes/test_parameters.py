# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of parameter specifications; nodes with bad parameters are in test/integration."""

import math
from types import SimpleNamespace

import pytest
from rcl_interfaces.msg import ParameterType

from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes import diagnoser, identifier, recorder, simulator
from quad_ident_ros.nodes.parameter_files import given_to, is_for, names_in
from quad_ident_ros.nodes.parameters import help_text, NodeParameters, ParameterSpec, TYPES

SHARE = ParameterSpec('share', 0.5, 'A share.', limits=(0.0, 1.0))
COUNT = ParameterSpec('count', 3, 'A count.', limits=(1, 10), fixed=True)
KIND = ParameterSpec('kind', 'a', 'A kind.', choices=('a', 'b'))
KINDS = ParameterSpec('kinds', ('a',), 'Kinds.', choices=('a', 'b'))
PAIR = ParameterSpec('pair', [], 'A pair.', length=(0, 2))
FLAG = ParameterSpec('flag', False, 'A flag.')

NODES = {'simulator': simulator, 'recorder': recorder, 'identifier': identifier,
         'diagnoser': diagnoser}
ALL = [(node, spec) for node, module in NODES.items() for spec in module.SPECS]


def test_descriptors_say_type_range_and_choices():
    share, count, kind = SHARE.descriptor(), COUNT.descriptor(), KIND.descriptor()
    assert share.type == ParameterType.PARAMETER_DOUBLE
    [limits] = share.floating_point_range
    assert (limits.from_value, limits.to_value, limits.step) == (0.0, 1.0, 0.0)
    assert (share.description, share.read_only) == ('A share.', False)
    assert count.type == ParameterType.PARAMETER_INTEGER
    [limits] = count.integer_range
    assert (limits.from_value, limits.to_value, limits.step) == (1, 10, 0)
    assert count.read_only
    assert kind.type == ParameterType.PARAMETER_STRING
    assert kind.description == 'A kind. One of: a, b.'
    assert KINDS.descriptor().type == ParameterType.PARAMETER_STRING_ARRAY
    assert PAIR.descriptor().type == ParameterType.PARAMETER_DOUBLE_ARRAY
    assert FLAG.descriptor().type == ParameterType.PARAMETER_BOOL
    assert not FLAG.descriptor().integer_range


@pytest.mark.parametrize('spec, value', [
    (SHARE, 0.0), (SHARE, 1.0), (COUNT, 1), (COUNT, 10), (KIND, 'b'), (KINDS, ['a', 'b']),
    (PAIR, []), (PAIR, [1.0, -2.0]), (FLAG, True)])
def test_good_values_pass(spec, value):
    spec.check(value)


@pytest.mark.parametrize('spec, value, said', [
    (SHARE, 1.1, '1.1 is out of range'), (SHARE, -0.1, 'out of range'),
    (SHARE, math.nan, 'expected a finite number'), (SHARE, math.inf, 'expected a finite number'),
    (COUNT, 0, '0 is out of range, expected >= 1 and <= 10'),
    (KIND, 'c', "'c' is not one of a, b"), (KINDS, ['a', 'c'], "'c' is not one of a, b"),
    (PAIR, [1.0], 'expected 0 or 2 numbers, got 1'),
    (PAIR, [1.0, math.nan], 'expected a finite number')])
def test_bad_values_are_refused_with_the_reason(spec, value, said):
    with pytest.raises(InputError) as caught:
        spec.check(value)
    assert str(caught.value).startswith(f'parameter {spec.name}') and said in str(caught.value)


@pytest.mark.parametrize('spec', [spec for _, spec in ALL if type(spec.default) is float],
                         ids=lambda spec: spec.name)
def test_the_example_in_a_refusal_would_be_taken(spec):
    given = SimpleNamespace(value='text')
    said = NodeParameters._type_error(None, spec, given, None)
    spec.check(float(said.split('for example ')[1].split(',')[0].split(' ')[0]))


def test_help_names_default_and_description():
    assert help_text((SHARE, KIND, KINDS, PAIR)).splitlines() == [
        '  share (default 0.5): A share.', "  kind (default 'a'): A kind. One of: a, b.",
        "  kinds (default ['a']): Kinds. One of: a, b.", '  pair (default []): A pair.']


@pytest.mark.parametrize('node, spec', ALL, ids=[f'{node}-{spec.name}' for node, spec in ALL])
def test_each_parameter_of_a_node_is_described_and_accepts_its_default(node, spec):
    spec.check(spec.default)
    assert type(spec.default) in TYPES
    assert spec.description.endswith('.') and len(spec.description) > 5
    if type(spec.default) in (int, float):
        assert spec.limits is not None
    assert f'  {spec.name} (default' in NODES[node].HELP


@pytest.mark.parametrize('node', NODES)
def test_names_of_parameters_are_unique(node):
    names = [spec.name for spec in NODES[node].SPECS]
    assert len(set(names)) == len(names)


def test_names_in_a_parameter_file_are_found():
    data = {'identifier': {'ros__parameters': {}}, '/quad': {'recorder': {'ros__parameters': {}}},
            '/**': {'ros__parameters': {}}, '/**/simulator': {'ros__parameters': {}},
            'no': 'mapping'}
    assert names_in(data) == ['/identifier', '/quad/recorder', '/**', '/**/simulator']


def test_what_a_parameter_file_gives_a_node_is_found():
    data = {'/**': {'ros__parameters': {'seed': 1, 'effects': []}},
            'quad': {'simulator': {'ros__parameters': {'seed': 2}}},
            'simulator': {'ros__parameters': {'seed': 3}},
            '/quad/**': {'ros__parameters': None}}
    assert given_to(data, 'simulator', '/quad/simulator') == {'seed': 2, 'effects': []}
    assert given_to(data, 'simulator', '/simulator') == {'seed': 3, 'effects': []}


@pytest.mark.parametrize('key, name, matches', [
    ('/identifier', '/identifier', True), ('/identifier', '/quad/identifier', False),
    ('/quad/identifier', '/quad/identifier', True), ('/recorder', '/identifier', False),
    ('/**', '/quad/identifier', True), ('/quad/**', '/quad/identifier', True),
    ('/other/**', '/quad/identifier', False), ('/**/identifier', '/quad/identifier', True),
    ('/**/identifier', '/identifier', True), ('/**/recorder', '/identifier', False),
    ('/*/identifier', '/quad/identifier', True), ('/*', '/identifier', True)])
def test_a_name_in_a_parameter_file_matches_as_in_ros(key, name, matches):
    assert is_for([key], name.rsplit('/', 1)[-1], name) is matches
