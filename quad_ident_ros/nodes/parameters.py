# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a node: declared once with type, default, range and description, and checked."""

from dataclasses import dataclass, field

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.exceptions import ParameterException
from rclpy.parameter import Parameter

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError

TYPES = {bool: ParameterType.PARAMETER_BOOL, int: ParameterType.PARAMETER_INTEGER,
         float: ParameterType.PARAMETER_DOUBLE, str: ParameterType.PARAMETER_STRING,
         list: ParameterType.PARAMETER_DOUBLE_ARRAY, tuple: ParameterType.PARAMETER_STRING_ARRAY}

# Parameters that rclpy declares for every node.
BUILT_IN = ('use_sim_time', 'start_type_description_service')


@dataclass(frozen=True)
class ParameterSpec:
    """
    A parameter: name, default (its type is the type; a list means doubles, a tuple texts).

    limits: (low, high) for numbers, also in lists; choices: allowed texts; length: allowed
    lengths of a list; fixed: it cannot be changed while the node runs.
    """

    name: str
    default: object
    description: str
    limits: tuple | None = None
    choices: tuple | None = None
    length: tuple | None = None
    fixed: bool = False

    def descriptor(self):
        """Return the descriptor that `ros2 param describe` shows."""
        said = self.description
        if self.choices:
            said += f' One of: {", ".join(self.choices)}.'
        if self.limits and isinstance(self.default, list):      # ranges of ROS are of one number
            said += f' Each from {self.limits[0]:g} to {self.limits[1]:g}.'
        descriptor = ParameterDescriptor(name=self.name, type=TYPES[type(self.default)],
                                         description=said, read_only=self.fixed)
        if self.limits and isinstance(self.default, int):
            descriptor.integer_range = [IntegerRange(from_value=self.limits[0],
                                                     to_value=self.limits[1], step=0)]
        elif self.limits and isinstance(self.default, float):
            descriptor.floating_point_range = [FloatingPointRange(
                from_value=self.limits[0], to_value=self.limits[1], step=0.0)]
        return descriptor

    def check(self, value):
        """Raise InputError where the value is not allowed."""
        where = f'parameter {self.name}'
        if value is None:
            raise InputError(f'{where}: expected a value, got an empty list or nothing')
        if isinstance(self.default, float | int) and not isinstance(self.default, bool):
            low, high = self.limits or (-float('inf'), float('inf'))
            schema.number(where, value, low, high)
        if self.choices:
            for entry in [value] if isinstance(value, str) else value:
                schema.choice(where, entry, self.choices)
        if isinstance(self.default, list):
            schema.numbers(where, list(value), len(value), *(self.limits or ()))
            if self.length and len(value) not in self.length:
                raise InputError(f'{where}: expected {" or ".join(map(str, self.length))} '
                                 f'numbers, got {len(value)}')


@dataclass
class NodeParameters:
    """
    The parameters of a node.

    Args: node; specs: ParameterSpecs; validate: called with all values as a dict, raises
    InputError where they do not fit together. Raises InputError for values given at the start
    that are unknown, of the wrong type or out of range.
    """

    node: object
    specs: tuple
    validate: object = field(default=lambda values: None)

    def __post_init__(self):
        """Declare the parameters and take changes from then on."""
        self._by_name = {spec.name: spec for spec in self.specs}
        self._values = {}
        given = getattr(self.node, '_parameter_overrides', {})
        for name in given:
            if name not in self._by_name and name not in BUILT_IN \
                    and not name.startswith('qos_overrides.'):
                raise schema.unknown_key(f'parameters of {self.node.get_name()}', name,
                                         self._by_name)
        for spec in self.specs:
            try:
                value = self._declare(spec)
            except ParameterException as error:
                raise InputError(self._type_error(spec, given.get(spec.name), error)) from None
            spec.check(value)
            self._values[spec.name] = value
        self.validate(self._values)
        self.node.add_on_set_parameters_callback(self._on_set)

    def _declare(self, spec):
        if spec.default not in ([], ()):
            return self.node.declare_parameter(spec.name, spec.default, spec.descriptor()).value
        # rclpy takes an empty list for bytes: the type is declared, and the list set after it.
        kind = (Parameter.Type.DOUBLE_ARRAY if isinstance(spec.default, list)
                else Parameter.Type.STRING_ARRAY)
        descriptor = spec.descriptor()
        descriptor.read_only = False    # until the list is set
        value = self.node.declare_parameter(spec.name, kind, descriptor).value
        if value is None:
            self.node.set_parameters([Parameter(spec.name, kind, [])])
        self.node.set_descriptor(spec.name, spec.descriptor())
        return list(value or [])

    def _type_error(self, spec, given, error):
        if given is None:
            return f'parameter {spec.name}: {error}'
        expected = {bool: 'true or false', int: 'a whole number',
                    float: f'a number with a dot, for example {spec.default}', str: 'text',
                    list: 'a list of numbers with dots',
                    tuple: 'a list of texts'}[type(spec.default)]
        limits = f' from {spec.limits[0]:g} to {spec.limits[1]:g}' if spec.limits else ''
        return f'parameter {spec.name}: expected {expected}{limits}, got {given.value!r}'

    def __getitem__(self, name):
        """Return the value of a parameter."""
        return self._values[name]

    def values(self):
        """Return all values as a dict."""
        return dict(self._values)

    def _on_set(self, changes):
        values = dict(self._values)
        try:
            for change in changes:
                if change.name in self._by_name:
                    if change.type_ != Parameter.Type.NOT_SET:
                        self._by_name[change.name].check(change.value)
                    values[change.name] = change.value
            self.validate(values)
        except InputError as error:
            return SetParametersResult(successful=False, reason=str(error))
        self._values = values
        return SetParametersResult(successful=True)


def help_text(specs):
    """Return the parameters as lines of text for --help."""
    lines = []
    for spec in specs:
        default = list(spec.default) if isinstance(spec.default, list | tuple) else spec.default
        lines.append(f'  {spec.name} (default {default!r}): {spec.descriptor().description}')
    return '\n'.join(lines)
