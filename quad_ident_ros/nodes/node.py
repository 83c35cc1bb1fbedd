# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What all nodes of the package share."""

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService

from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.messages import type_name

LISTS = (Parameter.Type.DOUBLE_ARRAY, Parameter.Type.STRING_ARRAY)


class PackageNode(Node):
    """
    A node that takes parameters as the `ros2` command sends them.

    An empty list has no type: `ros2 param set` sends it as one of truth values. A fixed parameter
    may be set to what it is, so that a node takes its own dump. A value of no type that there is
    is refused; in a node of rclpy it ends the process. So is a topic that is to have two types.
    """

    def __init__(self, name, **kwargs):
        self._types_by_topic = {'/rosout': 'rcl_interfaces/msg/Log'}    # which rcl publishes
        super().__init__(name, start_parameter_services=False, **kwargs)
        self._parameter_service = _TypedParameterService(self)

    def ready(self):
        """Return what the node does, for the line of log that says that it does it."""
        raise NotImplementedError

    @property
    def is_ready(self):
        """Whether the node is ready for its work."""
        return True

    @property
    def busy(self):
        """Whether the node has anything that would be lost if it started once more."""
        return False

    def values(self):
        """Return {name: value} of all parameters as they are now."""
        return {name: _plain(parameter.value)
                for name, parameter in self.get_parameters_by_prefix('').items()}

    def create_publisher(self, msg_type, topic, *args, **kwargs):
        """Return a publisher; raises InputError where this node has the topic as another type."""
        self._take_topic(topic, msg_type)
        return super().create_publisher(msg_type, topic, *args, **kwargs)

    def create_subscription(self, msg_type, topic, *args, **kwargs):
        """Return a subscription; InputError as for a publisher."""
        self._take_topic(topic, msg_type)
        return super().create_subscription(msg_type, topic, *args, **kwargs)

    def _take_topic(self, name, msg_type):
        topic = self.resolve_topic_name(name)
        kind = type_name(msg_type)
        before = self._types_by_topic.setdefault(topic, kind)
        if before != kind:
            raise TwoTypes(f'{topic} cannot be both {before} and {kind}: a topic has one type; a '
                           'parameter or a remapping (-r) gives two topics of this node one name')

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


class TwoTypes(InputError):
    """A topic that a node is to have as two types, which rcl would refuse with a traceback."""


class _TypedParameterService(ParameterService):
    """The services of rclpy, which take parameters of known types only."""

    def _set_parameters_callback(self, request, response):
        for message in request.parameters:
            if refusal := _of_no_type([message]):
                response.results.append(refusal)
            else:
                super()._set_parameters_callback(SetParameters.Request(parameters=[message]),
                                                 response)
        return response

    def _set_parameters_atomically_callback(self, request, response):
        if refusal := _of_no_type(request.parameters):
            response.result = refusal
            return response
        return super()._set_parameters_atomically_callback(request, response)


def _of_no_type(messages):
    """Return why one of several parameter messages is refused, or None."""
    known = {kind.value for kind in Parameter.Type}
    return next((SetParametersResult(
        successful=False, reason=f'parameter {message.name}: {message.value.type} is not the type '
        'of a parameter (rcl_interfaces/ParameterType)')
        for message in messages if message.value.type not in known), None)


def _plain(value):
    return list(value) if hasattr(value, '__len__') and not isinstance(value, str) else value
