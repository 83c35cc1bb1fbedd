# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the fast way to read serialized messages."""

import numpy as np
import pytest
from rosbags.typesys import get_typestore, Stores

from quad_ident_ros.data.topics import FLIGHT_TOPICS, stamp_ns

STORE = get_typestore(Stores.ROS2_JAZZY)


def filled(kind, random, frame):
    """Return a message of a type with a number of its own in each field."""
    values = {}
    for name, (_, part) in STORE.fielddefs[kind][1]:
        if part == ('string', 0):
            values[name] = frame
        elif part[0] == 'float64':
            values[name] = random.normal()
        elif isinstance(part, tuple):
            values[name] = int(random.integers(1, 2 ** 30))
        else:
            values[name] = filled(part, random, frame)
    return STORE.types[kind](**values)


@pytest.mark.parametrize('topic', FLIGHT_TOPICS.values(), ids=FLIGHT_TOPICS)
def test_stamp_and_numbers_are_those_of_the_message(topic):
    """With names of frames of any length, after which the numbers begin at another place."""
    random = np.random.default_rng(1)
    for length in range(20):
        message = filled(topic.type, random, 'f' * length)
        data = bytes(STORE.serialize_cdr(message, topic.type))
        assert topic.read(data) == (stamp_ns(message), topic.values(message))
        assert topic.read(data + b'padding') == topic.read(data)
        for end in range(len(data)):
            assert topic.read(data[:end]) is None


def test_another_encoding_is_left_to_the_middleware():
    topic = FLIGHT_TOPICS['pose']
    message = filled(topic.type, np.random.default_rng(2), 'world')
    data = bytes(STORE.serialize_cdr(message, topic.type, little_endian=False))
    assert topic.read(data) is None
    assert topic.read(b'\0\7' + data[2:]) is None
