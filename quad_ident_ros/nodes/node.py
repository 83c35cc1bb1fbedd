# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What all nodes of the package share."""

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

LISTS = (Parameter.Type.DOUBLE_ARRAY, Parameter.Type.STRING_ARRAY)


class PackageNode(Node):
    """
    A node that takes parameters as the `ros2` command sends them.

    An empty list has no type: `ros2 param set` sends it as one of truth values. A fixed parameter
    may be set to what it is, so that a node takes its own dump.
    """

    def ready(self):
        """Return what the node does, for the line of log that says that it does it."""
        raise NotImplementedError

    @property
    def is_ready(self):
        """Whether the node can do what it is there for, or still gets ready for it."""
        return True

    def set_parameters_atomically(self, parameter_list):
        """Set parameters as Node does, also empty lists and fixed ones that stay the same."""
        wanted = [self._typed(parameter) for parameter in parameter_list]
        changes = [parameter for parameter in wanted if not self._stays(parameter)]
        if wanted and not changes:
            return SetParametersResult(successful=True)
        return super().set_parameters_atomically(changes)

    def _typed(self, parameter):
        """Return an empty list as one of the parameter's type."""
        if self.has_parameter(parameter.name) and (
                parameter.type_.name.endswith('_ARRAY')
                and len(parameter.value) == 0):
            kind = Parameter.Type(self.describe_parameter(parameter.name).type)
            if kind in LISTS:
                return Parameter(parameter.name, kind, [])
        return parameter

    def _stays(self, parameter):
        """Return whether a parameter is fixed and is to be what it is."""
        if not self.has_parameter(parameter.name):
            return False
        now = self.get_parameter(parameter.name)
        return (self.describe_parameter(parameter.name).read_only and now.type_ == parameter.type_
                and _plain(now.value) == _plain(parameter.value))


def _plain(value):
    return list(value) if hasattr(value, '__len__') and not isinstance(value, str) else value
