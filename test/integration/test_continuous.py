# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Continuous mode through recorder and identifier: a payload picked up in flight."""

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped
from graph import stamp_of, STREAMS
import numpy as np
from payload import climb, GRAVITY, MASS, PAYLOAD, PERIOD, PICKED_UP, START_NS
import pytest
from std_msgs.msg import Bool, Float64MultiArray

from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder

TOPICS = ('altitude', 'input')
WINDOW, STRIDE = 500, 5     # 20 windows per second
PICKED_UP_NS = START_NS + round(PICKED_UP * 1e9)


class Online:
    """A recorder and an identifier in continuous mode, fed with a flight, and what they say."""

    def __init__(self, graph, topics=TOPICS, stride=STRIDE):
        self.graph, self.stride = graph, stride
        self.json, self.parameters, _ = graph.results()
        self.errors = graph.listen(Float64MultiArray, 'standard_errors', latched())
        self.changed = graph.listen(Bool, 'changed', latched())
        self.stamped = {name: graph.listen(Vector3Stamped, name, latched()) for name in (
            'outputs/z', 'outputs/z/standard_errors', 'outputs/phi')}
        graph.start(Recorder, {'topics': list(topics), 'window_samples': WINDOW,
                               'overlap': 1 - stride / WINDOW})
        graph.start(Identifier, {'method': 'vp', 'mode': 'continuous', 'initial_state': 'free',
                                 'trim': [MASS * GRAVITY, 0.0, 0.0, 0.0]})
        self.publishers = {name: graph.advertise(STREAMS[name], name) for name in topics}

    def fly(self, flight, begin, end):
        """Publish a flight from begin to end (s), each window when the last has its result."""
        count = 0
        for k in range(round(begin / PERIOD), round(end / PERIOD)):
            self._publish(flight, k)
            count += 1
            if count >= WINDOW and count % self.stride == 0:
                windows = (count - WINDOW) // self.stride + 1
                self.graph.spin_until(lambda expected=windows: all(
                    len(heard) == expected for heard in (
                        self.json, self.parameters, self.errors, self.changed,
                        self.stamped['outputs/z'],
                        self.stamped['outputs/z/standard_errors'])), f'result {windows}')

    def _publish(self, flight, k):
        attitude, altitude, thrust = (STREAMS[name]() for name in ('attitude', *TOPICS))
        for message in (attitude, altitude, thrust):
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(
                START_NS + round(k * PERIOD * 1e9), 10 ** 9)
        attitude.vector.x = float(flight.columns['phi'][k])
        attitude.vector.y = float(flight.columns['theta'][k])
        altitude.point.z = float(flight.columns['pz'][k])
        thrust.wrench.force.z = float(flight.columns['u1'][k])
        for name, message in (('attitude', attitude), ('altitude', altitude), ('input', thrust)):
            if name in self.publishers:
                self.publishers[name].publish(message)


def end_of(data):
    """Return the stamp of the newest sample of a result, ns."""
    samples, period = data['samples']['z'], data['period']['z']
    return data['records'][0]['start_ns'] + round((samples - 1) * period * 1e9)


def test_a_payload_picked_up_in_flight_is_found_within_2_s_of_its_stamp(graph, capfd):
    online = Online(graph)
    online.fly(climb(PAYLOAD), PICKED_UP - 8.0, PICKED_UP + 3.0)
    results = online.json.data()
    ends = np.array([end_of(data) for data in results])
    # Each window has a result: they follow one another at 20 per second of flight.
    np.testing.assert_allclose(np.diff(ends), STRIDE * PERIOD * 1e9, atol=2)
    found = [data for data in results if data['changes']]
    assert [message.data for message in online.changed] == [data in found for data in results]
    assert not [data for data in found if end_of(data) < PICKED_UP_NS]
    [change] = found[0]['changes']
    assert end_of(found[0]) - PICKED_UP_NS < 2e9
    assert change['output'] == 'z' and change['moved']
    assert abs(change['stamp_ns'] - PICKED_UP_NS) < 1e9
    # Who comes late still gets the event, with the stamp of the change.
    events = graph.listen(DiagnosticArray, 'change', latched(10))
    graph.spin_until(lambda: len(events) == len(found), 'the events')
    event = events[0]
    assert stamp_of(event) == change['stamp_ns']
    [status] = event.status
    assert (status.name, status.hardware_id) == ('z', 'identifier')
    assert {entry.key: float(entry.value) for entry in status.values} == {
        f'{name}/{when}': value for name, values in change['moved'].items()
        for when, value in zip(('before', 'after'), values, strict=True)}
    # The log reports each change, and now and then that all is well.
    log = capfd.readouterr().err
    assert log.count(' changed at ') == len(found)
    for line in ('[recorder]: record ', '[identifier]: best method vp'):
        assert 0 < log.count(line) < len(results) / 2
    # From then on it is the vehicle as it is that is identified.
    last = results[-1]
    assert last['records'][0]['start_ns'] == pytest.approx(end_of(found[0]), abs=1e4)


def test_a_payload_is_found_in_lateral_flight_where_the_linear_model_holds(graph):
    online = Online(graph, ('attitude', *TOPICS), stride=25)
    online.fly(climb(0.3 * MASS, tilt=np.radians(20.0)), PICKED_UP - 7.0, PICKED_UP + 2.5)
    results = online.json.data()
    [found] = [data for data in results if data['changes']]
    [change] = found['changes']
    assert 0 < end_of(found) - PICKED_UP_NS < 2e9 and change['output'] == 'z'
    before, after = change['moved']['K']
    assert before == pytest.approx(1 / MASS, rel=0.03) and after < 0.85 * before
    held = [data['linear_model']['z'] for data in results]
    # Just after the change three windows are shorter than a block and its grid.
    assert [one['holds'] for one in held].count(None) <= 3
    for one in held:
        assert one['holds'] is None or one['holds'] and one['tilt'] < 0.36 and 'deg' in one['why']


def test_where_the_linear_model_does_not_hold_is_said(graph):
    statuses = graph.listen(DiagnosticArray, '/diagnostics')
    online = Online(graph, ('attitude', *TOPICS), stride=25)
    online.fly(climb(0.0, tilt=np.radians(30.0)), 0.0, 6.0)
    for data in online.json.data():
        held = data['linear_model']['z']
        assert held['holds'] is False and held['tilt'] > 0.4
        assert any('does not hold' in remark for remark in data['remarks'])

    def said():
        return [entry.value for message in statuses for status in message.status
                for entry in status.values if entry.key == 'linear_model/z']
    graph.spin_until(said, 'the diagnostics')
    assert all('does not hold' in why for why in said())


def test_results_for_plots_have_the_time_of_the_data_and_come_with_standard_errors(graph):
    online = Online(graph)
    online.fly(climb(0.0), 0.0, 6.0)
    assert online.stamped['outputs/z'] and not online.stamped['outputs/phi']
    for name, tables in (('outputs/z', online.parameters),
                         ('outputs/z/standard_errors', online.errors)):
        for data, message, table in zip(online.json.data(), online.stamped[name], tables,
                                        strict=True):
            assert abs(stamp_of(message) - end_of(data)) < 2
            np.testing.assert_array_equal(
                [message.vector.x, message.vector.y, message.vector.z],
                np.reshape(table.data, (4, 3))[3])
    assert not any(message.data for message in online.changed)
    for data, parameters, errors in zip(online.json.data(), online.parameters, online.errors,
                                        strict=True):
        fit = data['methods']['vp']['outputs']['z']
        table, spread = (np.reshape(message.data, (4, 3)) for message in (parameters, errors))
        assert errors.layout.dim[0].label == 'phi,theta,psi,z'
        assert np.isnan(spread[:3]).all() and np.isnan(table[:3]).all()
        assert spread[3, 0] == fit['standard_errors']['K'] > 0
        assert abs(table[3, 0] - 1 / MASS) < 4 * spread[3, 0]
