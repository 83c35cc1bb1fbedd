# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics that carry another type than the recorder joins, and how to have them recorded."""

from quad_ident_ros.data.message_roles import ROLES_OF
from quad_ident_ros.data.topics import FLIGHT_TOPICS
from quad_ident_ros.nodes.mapped import KNOWN

BY_NAME = {'nav_msgs/msg/Odometry': 'odometry', 'sensor_msgs/msg/Imu': 'imu',
           'actuator_msgs/msg/Actuators': 'actuators'}


def other_types(node, names):
    """
    Say which of FLIGHT_TOPICS are published as other types than theirs, or return ''.

    A subscription of another type hears nothing, and the middleware does not say so.
    """
    found, kinds = [], {}
    for name in names:
        wanted, topic = FLIGHT_TOPICS[name].type, node.resolve_topic_name(name)
        there = {info.topic_type for info in node.get_publishers_info_by_topic(topic)}
        if there and wanted not in there:
            kinds[topic] = min(there)
            found.append(f'{name}: {topic} is {kinds[topic]}, not {wanted}')
    return '; '.join([*found, way_out(kinds)]) if found else ''


def one_topic_for_two(node, name, names):
    """Say that a topic cannot be subscribed to as two of names, or return '' where it is not."""
    topic = node.resolve_topic_name(name)
    same = [one for one in names if node.resolve_topic_name(one) == topic]
    if len(same) < 2:   # the node publishes it
        return ''
    both = ' and '.join(f'{one} ({FLIGHT_TOPICS[one].type})' for one in same)
    return (f'{topic} cannot be both {both}: a topic has one type; '
            f'{way_out({topic: "nav_msgs/msg/Odometry"})}')


def way_out(kinds):
    """Return how topics of some types, {topic: type}, are recorded."""
    # One topic for each: of two that have the same, the second one is nothing new.
    roles = {role: topic for topic, kind in reversed(kinds.items())
             for role in ROLES_OF.get(kind, ())}
    known = {BY_NAME[kind]: topic for topic, kind in reversed(kinds.items()) if kind in BY_NAME}
    assert known.keys() <= KNOWN.keys()
    listed = ', '.join(f'{role}: {{topic: {topic}}}' for role, topic in roles.items())
    lines = f'with topics: {{{listed}}} in it' if roles else 'that says where in it what is'
    remapped = ' '.join(f'-r {name}:={topic}' for name, topic in known.items())
    by_name = f'start the recorder with -p topics:="[{", ".join(known)}]" {remapped}, or ' \
        if known else ''
    return f'{by_name}give it a mapping file (parameter mapping, docs/records.md) {lines}'
