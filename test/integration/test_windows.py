# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Several windows of one recorder, for nodes that want records of different length."""

from graph import DEADLINE, Vehicle
import numpy as np
import pytest
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.outlets import Window, windows_of
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

PERIOD = 10 ** 7


def stamps(record):
    return record.info['start_ns'] + np.rint(record.t * 1e9).astype(np.int64)


def test_each_window_has_records_of_its_own_topic(fast_graph):
    graph = fast_graph
    short, long = (graph.listen(Float64MultiArray, name, latched(16))
                   for name in ('record', 'uav/long'))
    recorder = graph.start(Recorder, {'window_seconds': 0.39, 'overlap': 0.5,
                                      'windows': ['uav/long=0.99']})
    sent = Vehicle(graph).fly(250)
    graph.spin_until(lambda: recorder.counts.joined == 250, 'the samples')
    assert graph.trigger('recorder/flush').success
    graph.spin_until(lambda: len(long) == 3 and len(short) == 12, 'the records')
    assert [stamps(record).tolist() for record in long.records()] == [
        sent[:100], sent[100:200], sent[200:]]
    assert [stamps(record).tolist() for record in short.records()][:11] == [
        sent[k:k + 40] for k in range(0, 201, 20)]


@pytest.mark.parametrize('entry, said', [
    ('long', 'expected TOPIC=SECONDS'), ('long=x', 'expected TOPIC=SECONDS'),
    ('long=3,0.5,1', 'expected TOPIC=SECONDS,OVERLAP'), ('1 2=3', 'name of a topic'),
    ('long=-1', 'seconds'), ('long=nan', 'seconds'), ('long=3,1', 'overlap'),
    ('record=3', 'two windows have the topic record')])
def test_a_window_that_is_none_is_refused(entry, said):
    with pytest.raises(InputError, match=said):
        windows_of([entry])


def test_a_remapping_cannot_give_two_windows_one_topic(graph):
    """The diagnoser of the side by side recipe has this remapping."""
    with pytest.raises(InputError, match='two windows of this node have the topic /record_long'):
        graph.start(Recorder, {'windows': ['record_long=30']},
                    arguments=['-r', 'record:=record_long'])


def test_a_window_is_read():
    assert windows_of(['a=30', 'b/c=2.5,0.9']) == (Window('a', 30.0, 0.0),
                                                   Window('b/c', 2.5, 0.9))


def test_identifier_and_diagnoser_work_side_by_side(graph):
    """Two seconds suffice for the one; the other takes no less than six."""
    found = graph.listen(String, 'parameters_json', latched())
    verdicts = graph.listen(String, 'diagnosis', latched())
    graph.start(Identifier, {'mode': 'continuous', 'method': 'vp'})
    graph.start(Diagnoser, {'mode': 'continuous', 'vehicle': 'hummingbird',
                            'effects': ['rotor_drag', 'wind']},
                arguments=['-r', 'record:=record_long'])
    graph.start(Recorder, {'window_seconds': 2.0, 'overlap': 0.5,
                           'windows': ['record_long=7.5']})
    graph.start(Simulator, {'experiment': 'closed_loop', 'real_time_factor': 0.0})
    graph.spin_until(lambda: found and verdicts, 'results of both', 6 * DEADLINE)
    for data, low, high in ((found.data()[0], 1.9, 2.1), (verdicts.data()[0], 7.4, 7.6)):
        first, last = data['span_ns'] if 'span_ns' in data else (
            data['records'][0]['start_ns'], data['records'][0]['start_ns'] + 2e9)
        assert low < (last - first) * 1e-9 < high


def test_records_that_are_too_short_are_not_logged_each(graph):
    graph.start(Diagnoser, {'mode': 'continuous'})
    lines = graph.listen(Log, '/rosout')
    publisher = graph.advertise(Float64MultiArray, 'record', latched(16))
    recorder = graph.start(Recorder, arguments=['-r', 'record:=other'])
    heard = graph.listen(Float64MultiArray, 'other', latched(16))
    Vehicle(graph).fly(100)
    graph.spin_until(lambda: recorder.counts.joined == 100 and graph.trigger(
        'recorder/flush').success and heard, 'a short record')
    for _ in range(40):
        publisher.publish(record_message(heard.records()[0]))
        graph.spin_for(0.02)
    said = [line.msg for line in lines if 'too short for a diagnosis' in line.msg]
    assert len(said) == 1
