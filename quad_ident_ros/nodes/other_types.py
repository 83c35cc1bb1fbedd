# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics that carry another type than the recorder joins, and how to have them recorded."""

from quad_ident_ros.data.message_roles import ROLES_OF
from quad_ident_ros.data.topics import FLIGHT_TOPICS
from quad_ident_ros.nodes.mapped import KNOWN

BY_NAME = {'nav_msgs/msg/Odometry': 'odometry', 'sensor_msgs/msg/Imu': 'imu',
           'actuator_msgs/msg/Actuators': 'actuators'}


def other_type(node, name):
    """
    Say what is published on one of FLIGHT_TOPICS in place of its type, or return ''.

    A subscription of another type hears nothing, and the middleware does not say so.
    """
    wanted, topic = FLIGHT_TOPICS[name].type, node.resolve_topic_name(name)
    kinds = {info.topic_type for info in node.get_publishers_info_by_topic(topic)}
    if not kinds or wanted in kinds:
        return ''
    kind = min(kinds)
    return f'{name}: {topic} is {kind}, not {wanted}; {way_out(topic, kind)}'


def one_topic_for_two(node, name, names):
    """Say that a topic cannot be subscribed to as two of names, or return '' where it is not."""
    topic = node.resolve_topic_name(name)
    same = [one for one in names if node.resolve_topic_name(one) == topic]
    if len(same) < 2:   # the node publishes it
        return ''
    both = ' and '.join(f'{one} ({FLIGHT_TOPICS[one].type})' for one in same)
    return (f'{topic} cannot be both {both}: a topic has one type; '
            f'{way_out(topic, "nav_msgs/msg/Odometry")}')


def way_out(topic, kind):
    """Return how a topic of some type is recorded."""
    known = BY_NAME.get(kind)
    assert known is None or known in KNOWN
    roles = ', '.join(f'{role}: {{topic: {topic}}}' for role in ROLES_OF.get(kind, ()))
    lines = f'with topics: {{{roles}}} in it' if roles else 'that says where in it what is'
    by_name = f'start the recorder with -p topics:="[{known}]" -r {known}:={topic}, or ' \
        if known else ''
    return f'{by_name}give it a mapping file (parameter mapping, docs/records.md) {lines}'
