# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Random messages of other publishers, on all topics that the nodes hear: none ends a node."""

import json
import math
import random

from graph import sample, STREAMS, Vehicle
import pytest
from std_msgs.msg import Float64MultiArray, MultiArrayDimension, String

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder

VALUES = (0.0, -1.0, 1e300, -1.7e308, 1e99, 1e16, 5e-324, math.nan, math.inf)
SECONDS = (0, 1, 2 ** 31 - 1, -1, -2 ** 31)
PERIOD = 10 ** 7


def numbers_of(message):
    """Yield (object, field) of all numbers in a message but its header."""
    for name, kind in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        if kind == 'double':
            yield message, name
        elif name != 'header' and hasattr(value, 'get_fields_and_field_types'):
            yield from numbers_of(value)


def notices(draw, stamp):
    """Return the text of a run that may be none."""
    good = {'start_ns': stamp, 'stop_ns': stamp + 100 * PERIOD, 'samples': 101,
            'info': {'name': 'one', 'run_index': 0, 'run_count': 1, 'arm_length': 0.2}}
    odd = draw.choice((10 ** 30, -1, 1e-300, math.inf, None, 'x', [], {}, True))
    if draw.random() < 0.5:
        return json.dumps({**good, draw.choice(tuple(good)): odd})
    return json.dumps({**good, 'info': {**good['info'], draw.choice(tuple(good['info'])): odd}})


def tables(draw, stamp):
    """Return a record that may be none."""
    t = [0.01 * k for k in range(60)]
    record = FlightRecord(t, {name: [draw.choice((0.0, 1.0, 1e99)) * x for x in t] for name in (
        'u1', 'u2', 'u3', 'u4', 'phi', 'theta', 'psi', 'pz')}, {'start_ns': stamp})
    message = record_message(record)
    key = draw.choice(('start_ns', 'dropped', 'session', 'run_index', 'trim', 'initial', 'name'))
    odd = draw.choice((10 ** 30, -10 ** 30, math.nan, None, 'x', [[]], {'z': 'y'}))
    message.layout.dim[2].label = json.dumps({**record.info, key: odd})
    if draw.random() < 0.2:
        message.layout.dim[draw.randrange(3)] = MultiArrayDimension(label='t,t', size=2 ** 31)
    return message


@pytest.mark.parametrize('seed', range(3))
def test_no_message_ends_a_node(graph, tmp_path, seed):
    draw = random.Random(seed)
    recorder = graph.start(Recorder, {'window_seconds': 1.0, 'overlap': 0.5,
                                      'output': str(tmp_path), 'windows': ['long=5,0.5']})
    graph.start(Identifier, {'mode': 'continuous', 'method': 'ls'})
    diagnoser = graph.start(Diagnoser, {'mode': 'continuous'}, arguments=('-r', 'record:=long'))
    vehicle = Vehicle(graph)
    runs = graph.advertise(String, 'run', latched(32))
    records = [graph.advertise(Float64MultiArray, name, latched(16)) for name in (
        'record', 'long')]
    sent = dict.fromkeys(STREAMS, 0)
    for k in range(1200):
        stamp = 10 ** 18 + k * PERIOD
        for name in STREAMS:
            message = sample(name, stamp, math.sin(0.01 * k))
            for part, field in numbers_of(message):
                if draw.random() < 0.01:
                    setattr(part, field, draw.choice(VALUES))
            if draw.random() < 0.01:
                message.header.stamp.sec = draw.choice(SECONDS)
            vehicle.publishers[name].publish(message)
            sent[name] += 1
        if k % 20 == 0:
            runs.publish(String(data=notices(draw, stamp)))
            draw.choice(records).publish(tables(draw, stamp))
            draw.choice((runs, *records, *vehicle.publishers.values())).publish(
                draw.choice((b'', b'\0\1\0\0', b'\0\1\0\0' + b'\xff' * 40)))
        graph.executor.spin_once(timeout_sec=0.0)
    graph.spin_until(lambda: recorder.counts.received == sent, 'all messages')
    assert recorder.counts.joined > 100
    assert graph.trigger('recorder/flush').message
    graph.spin_until(lambda: not diagnoser._job.busy, 'the end of the diagnosis')
