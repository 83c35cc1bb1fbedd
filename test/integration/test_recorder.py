# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node recorder: joining, counting, windows; what it writes is in test_recording.py."""

import math
import re
import signal
import time

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from graph import sample, STREAMS, Vehicle, write_experiment
import numpy as np
import pytest
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.data.load import load
from quad_ident_ros.data.topics import RunNotice
from quad_ident_ros.nodes import health
from quad_ident_ros.nodes import recorder as recorder_module
from quad_ident_ros.nodes.qos import BEST_EFFORT, latched, STREAM
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

SECOND = 10 ** 9
PERIOD = 10 ** 7


@pytest.fixture
def graph(fast_graph):
    """Run on the executor that the recorder has as a process."""
    return fast_graph


def listen(graph):
    return (graph.listen(Float64MultiArray, 'record', latched(16)),
            graph.listen(String, 'recorder/statistics', latched()))


def await_counts(graph, statistics, **expected):
    """Wait until the published account has the expected counts, and return it."""
    def news():
        return statistics and {name: statistics.data()[-1][name] for name in expected} == expected

    try:
        graph.spin_until(news)
    except pytest.fail.Exception:
        pytest.fail(f'expected {expected}, have {statistics.data()[-1]}')
    return statistics.data()[-1]


def await_joined(graph, recorder, count):
    graph.spin_until(lambda: recorder.counts.joined >= count, f'{count} joined samples')
    assert recorder.counts.joined == count


def problems(account):
    names = ('dropped', 'late', 'duplicated', 'out_of_order', 'nan', 'lost', 'incompatible_qos',
             'unreadable', 'restarts', 'missing')
    return {name: account[name] for name in names if account[name]}


def stamps_of(record):
    return record.info['start_ns'] + np.rint(record.t * 1e9).astype(np.int64)


def test_topics_are_joined_by_stamp(graph):
    recorder = graph.start(Recorder)
    records, statistics = listen(graph)
    vehicle = Vehicle(graph)
    # Each topic by itself, one after the other: only stamps show what belongs together.
    stamps = [SECOND + k * PERIOD for k in range(50)]
    for topic in STREAMS:
        for k, stamp in enumerate(stamps):
            vehicle.send(stamp, 0.001 * k, [topic])
    await_joined(graph, recorder, 50)
    assert not records
    response = graph.trigger('recorder/flush')
    assert (response.success, response.message) == (True, 'published a record of 50 samples')
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    np.testing.assert_array_equal(stamps_of(record), stamps)
    value = 0.001 * np.arange(50)
    for name, factor in {'phi': 1, 'theta': 2, 'psi': 3, 'pz': 4, 'px': 5, 'py': 6, 'vx': 7,
                         'wz': 8, 'u1': 9, 'u4': 10}.items():
        np.testing.assert_array_equal(record.columns[name], factor * value)
    assert (record.info['dropped'], record.info['problems']) == (0, {})
    account = await_counts(graph, statistics, joined=50, records=1)
    assert account['received'] == dict.fromkeys(STREAMS, 50)
    assert problems(account) == {}


def test_flush_without_samples_says_so(graph):
    graph.start(Recorder)
    response = graph.trigger('recorder/flush')
    assert not response.success
    assert response.message == 'there are fewer than two samples to publish'


def test_what_is_wrong_is_counted_and_published(graph):
    recorder = graph.start(Recorder)
    records, statistics = listen(graph)
    diagnostics = graph.listen(DiagnosticArray, '/diagnostics')
    vehicle = Vehicle(graph)
    for k in range(200):
        stamp, topics = SECOND + k * PERIOD, list(STREAMS)
        if k == 30:    # one topic delivers a sample too late
            topics.remove('altitude')
        if k == 80:
            await_joined(graph, recorder, 79)
            vehicle.send(SECOND + 30 * PERIOD, topics=['altitude'])
        if k == 100:   # a sample that nobody delivers
            continue
        if k == 110:   # two samples in the wrong order on one topic
            vehicle.send(stamp + PERIOD, topics=['twist'])
        if k == 111:
            topics.remove('twist')
        if k == 130:   # twice
            vehicle.send(stamp, topics=['pose', 'input'])
        vehicle.send(stamp, math.nan if k == 150 else 0.001 * k, topics)
    await_joined(graph, recorder, 200 - 3)
    assert graph.trigger('recorder/flush').success
    account = await_counts(graph, statistics, joined=197, records=1)
    # not a number: five messages of one sample
    assert problems(account) == {'dropped': 1, 'late': 1, 'duplicated': 2, 'out_of_order': 2,
                                 'nan': 5, 'missing': 3}
    assert account['received'] == {**dict.fromkeys(STREAMS, 199), 'pose': 200, 'input': 200}
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    assert len(record) == 197
    missing = set(range(200)) - set(((stamps_of(record) - SECOND) // PERIOD).tolist())
    assert missing == {30, 100, 150}
    assert record.info['dropped'] == 3
    assert record.info['problems']['nan'] == 5
    status = graph.spin_until(
        lambda: [m.status[0] for m in diagnostics if m.status[0].level == DiagnosticStatus.WARN],
        'a warning')[-1]
    assert status.name == 'recorder' and '5 nan' in status.message


@pytest.mark.parametrize('topic, spoil, said', [
    ('twist', lambda message: setattr(message.twist.linear, 'x', 1.7e308), 'beyond all measure'),
    ('altitude', lambda message: setattr(message.point, 'z', math.inf), 'is not a number'),
    ('pose', lambda message: setattr(message.pose.orientation, 'w', 0.0), 'length 1'),
    ('pose', lambda message: setattr(message.pose.orientation, 'w', 1e200), 'beyond all measure')])
def test_what_no_sensor_measures_is_told_and_counted_and_joined_into_nothing(
        graph, capfd, topic, spoil, said):
    recorder = graph.start(Recorder)
    records, statistics = listen(graph)
    vehicle = Vehicle(graph)
    for k in range(20):
        stamp = SECOND + k * PERIOD
        vehicle.send(stamp, 0.001 * k, [name for name in STREAMS if name != topic])
        message = sample(topic, stamp, 0.001 * k)
        if k in (7, 8):
            spoil(message)
        vehicle.publishers[topic].publish(message)
    await_joined(graph, recorder, 18)
    assert graph.trigger('recorder/flush').success
    assert problems(await_counts(graph, statistics, joined=18, records=1)) == {
        'nan': 2, 'missing': 2}
    graph.spin_until(lambda: records, 'the record')
    assert len(records.records()[0]) == 18
    assert f'[recorder]: {topic}: ' in (err := capfd.readouterr().err) and said in err


@pytest.mark.parametrize('raw', [b'', b'\0\1\0\0', b'\0\1\0\0' + b'\xff' * 40])
def test_bytes_that_are_no_message_are_told_and_counted(graph, capfd, tmp_path, raw):
    """As those of a publisher with another version of the package are."""
    recorder = graph.start(Recorder, {'output': str(tmp_path)})
    records, statistics = listen(graph)
    vehicle = Vehicle(graph)
    runs = graph.advertise(String, 'run', latched(32))
    vehicle.fly(10)
    for publisher in (*vehicle.publishers.values(), runs):
        publisher.publish(raw)
    vehicle.fly(10, first=SECOND + 10 * PERIOD)
    await_joined(graph, recorder, 20)
    assert graph.trigger('recorder/flush').success
    assert problems(await_counts(graph, statistics, joined=20, records=1, unreadable=6)) == {
        'unreadable': 6}
    assert re.search(r'/\w+: a message is no \w+/msg/\w+ as it is defined here; source',
                     capfd.readouterr().err)
    graph.stop(recorder)
    assert len(load(tmp_path / 'recording_1' / 'bag')) == 20


def test_an_arm_by_which_moments_are_beyond_all_numbers_does_not_end_the_recorder(graph):
    graph.start(Recorder, {'topics': ['input']})
    records, _ = listen(graph)
    runs = graph.advertise(String, 'run', latched(32))
    runs.publish(String(data=RunNotice(SECOND, SECOND + 9 * PERIOD, 10,
                                       {'name': 'x', 'arm_length': 1e-300}).to_json()))
    vehicle = Vehicle(graph, ['input'])
    for k in range(10):
        message = sample('input', SECOND + k * PERIOD, 1.0)
        message.wrench.torque.x = 1e90
        vehicle.publishers['input'].publish(message)
    graph.spin_until(lambda: records, 'the record')
    assert len(records.records()[0]) == 10


@pytest.mark.parametrize('parameters', [{'window_samples': 40},
                                        {'window_seconds': 39 * 0.01}])
def test_a_window_is_complete_when_it_is_full(graph, parameters):
    recorder = graph.start(Recorder, parameters)
    records, _ = listen(graph)
    stamps = Vehicle(graph).fly(100)
    await_joined(graph, recorder, 100)
    graph.spin_until(lambda: len(records) == 2, 'two records')
    assert [stamps_of(record).tolist() for record in records.records()] == [stamps[:40],
                                                                            stamps[40:80]]
    graph.trigger('recorder/flush')
    graph.spin_until(lambda: len(records) == 3, 'the rest')
    assert stamps_of(records.records()[2]).tolist() == stamps[80:]


@pytest.mark.parametrize('topics, period, shift, said', [
    (('attitude', 'input'), PERIOD, 0, 'nothing comes on altitude, pose, twist'),
    (tuple(STREAMS), PERIOD, 100 * PERIOD, 'never within 0.1 s of one another'),
    (tuple(STREAMS), 0, 0, 'have one stamp again and again')])
def test_it_says_why_messages_do_not_become_samples(graph, topics, period, shift, said):
    graph.start(Recorder)
    diagnostics = graph.listen(DiagnosticArray, '/diagnostics')
    vehicle = Vehicle(graph, topics, STREAM)
    started, sent = time.monotonic(), 0

    def trouble():
        nonlocal sent
        while sent < 50 * (time.monotonic() - started):    # 50 samples/s
            sent += 1
            for k, topic in enumerate(topics):
                vehicle.send(SECOND + sent * period + k * shift, topics=[topic])
        return diagnostics and said in diagnostics[-1].status[0].message

    graph.spin_until(trouble, said)
    assert diagnostics[-1].status[0].level == DiagnosticStatus.WARN
    response = graph.trigger('recorder/flush')
    assert not response.success and said in response.message


def test_windows_overlap(graph):
    recorder = graph.start(Recorder, {'window_samples': 40, 'overlap': 0.75})
    records, _ = listen(graph)
    stamps = Vehicle(graph).fly(100)
    await_joined(graph, recorder, 100)
    graph.spin_until(lambda: len(records) == 7, 'the records')
    assert [stamps_of(record).tolist() for record in records.records()] == [
        stamps[k:k + 40] for k in range(0, 61, 10)]


def test_only_some_topics(graph):
    recorder = graph.start(Recorder, {'topics': ['input', 'altitude']})
    records, _ = listen(graph)
    stamps = Vehicle(graph, ('input', 'altitude')).fly(30)
    await_joined(graph, recorder, 30)
    graph.trigger('recorder/flush')
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    assert sorted(record.columns) == ['moment_x', 'moment_y', 'pz', 'u1', 'u4']
    assert stamps_of(record).tolist() == stamps


def test_a_best_effort_publisher_is_heard(graph):
    recorder = graph.start(Recorder)
    records, statistics = listen(graph)
    publishers = {name: graph.probe.create_publisher(
        kind, name, BEST_EFFORT if name == 'altitude' else STREAM)
        for name, kind in STREAMS.items()}
    account = await_counts(graph, statistics, incompatible_qos=1)
    assert problems(account) == {'incompatible_qos': 1}
    for publisher in publishers.values():
        graph.await_listeners(publisher)
    for k in range(50):
        for name, publisher in publishers.items():
            publisher.publish(sample(name, SECOND + k * PERIOD, 0.1 * k))
        graph.executor.spin_once(timeout_sec=0.01)
    await_joined(graph, recorder, 50)
    graph.trigger('recorder/flush')
    graph.spin_until(lambda: records, 'the record')
    np.testing.assert_array_equal(records.records()[0].columns['pz'], 4 * 0.1 * np.arange(50))


def test_what_the_middleware_lost_is_counted(graph, processes):
    """
    A publisher that keeps one message only overruns a recorder in another process.

    As a callback of the executor, the count hung the recorder in one of 20 such floods.
    """
    processes.start('recorder', {'topics': ['altitude']})
    _, statistics = listen(graph)
    quality = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=1,
                         reliability=ReliabilityPolicy.RELIABLE)
    publisher = graph.advertise(STREAMS['altitude'], 'altitude', quality)
    message, sent = sample('altitude', SECOND), 0

    def send():
        nonlocal sent
        sent += 1
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(sent * PERIOD, SECOND)
        publisher.publish(message)

    def told(name):
        account = statistics.data()[-1]
        return account[name] if name == 'lost' else account['received']['altitude']

    # It may be a while until the recorder has found the publisher, too.
    graph.spin_until(lambda: send() or (statistics and told('received')), 'the first message')
    seen = len(statistics) + 1
    graph.spin_until(lambda: len(statistics) > seen and statistics[-1] == statistics[-2], 'quiet')
    before = sent - told('received') - told('lost')
    while not told('lost'):    # a fast machine may keep up, as far as it goes
        for _ in range(5000):
            send()
        graph.spin_until(lambda: told('received') + told('lost') + before == sent,
                         'all messages in the account')
    assert graph.trigger('recorder/flush').success
    account = await_counts(graph, statistics, records=1)
    assert account['missing'] == account['lost']


def overrun(depth):
    """Return a quality of publishers that keep some messages only."""
    return QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=depth,
                      reliability=ReliabilityPolicy.RELIABLE)


@pytest.mark.parametrize('seconds', [20.0, 0.02])
def test_what_waits_when_a_recorder_is_stopped_is_joined_or_counted(graph, monkeypatch, seconds):
    monkeypatch.setattr(recorder_module, 'ENDING', seconds)
    recorder = graph.start(Recorder, {'topics': ['altitude']})
    Vehicle(graph, ('altitude',), overrun(1000)).fly(4000)
    assert recorder.counts.joined == 0
    graph.stop(recorder)
    counts = recorder.counts
    assert counts.received['altitude'] == counts.joined > 0
    assert counts.joined + counts.unread == 4000
    assert (counts.unread > 0) == (seconds < 1.0)


def test_a_recorder_that_is_told_to_end_in_a_flood_accounts_for_all(graph, processes):
    """What waits is joined or counted, what the middleware had no room for is counted as lost."""
    process = processes.start('recorder', {'topics': ['altitude']})
    _, statistics = listen(graph)
    vehicle = Vehicle(graph, ('altitude',), overrun(1000))
    vehicle.send(SECOND)
    graph.spin_until(lambda: statistics and statistics.data()[-1]['received']['altitude'],
                     'the first message')
    sent = 40_001
    vehicle.fly(sent - 1, first=SECOND + PERIOD)
    assert process.stop() == 0

    def whole():
        account = statistics.data()[-1]
        return account['joined'] + account['lost'] + account['unread'] == sent

    graph.spin_until(whole, 'the last account, which was published while the process ended')
    account = statistics.data()[-1]
    assert account['missing'] == account['lost']


def test_what_is_lost_while_a_recorder_hangs_is_counted(graph, processes):
    """It stands still, whatever the machine does, while a publisher goes beyond what it keeps."""
    process = processes.start('recorder', {'topics': ['altitude']})
    _, statistics = listen(graph)
    vehicle = Vehicle(graph, ('altitude',), overrun(100))
    vehicle.send(SECOND)
    graph.spin_until(lambda: statistics and statistics.data()[-1]['received']['altitude'],
                     'the first message')
    process.send(signal.SIGSTOP)
    sent = 40_001
    vehicle.fly(sent - 1, first=SECOND + PERIOD)
    process.send(signal.SIGCONT)

    def account():
        return statistics.data()[-1]

    graph.spin_until(lambda: account()['received']['altitude'] + account()['lost'] == sent,
                     'all messages in the account')
    assert account()['lost'] > 0
    assert process.stop() == 0
    graph.spin_for(0.5)
    assert account()['missing'] == account()['lost'] == sent - account()['joined']


def test_a_flush_in_flight_loses_no_sample(graph):
    recorder = graph.start(Recorder)
    records, _ = listen(graph)
    vehicle = Vehicle(graph)
    early, late = ('attitude', 'pose'), ('altitude', 'twist', 'input')
    for k in range(200):
        vehicle.send(SECOND + k * PERIOD, topics=early)
        if k in (60, 120):    # each time with half a sample under way
            graph.spin_until(lambda k=k: recorder.counts.received['pose'] == k + 1, 'that half')
            assert graph.trigger('recorder/flush').success
        vehicle.send(SECOND + k * PERIOD, topics=late)
    await_joined(graph, recorder, 200)
    graph.trigger('recorder/flush')
    graph.spin_until(lambda: len(records) == 3, 'the records')
    stamps = np.concatenate([stamps_of(record) for record in records.records()])
    assert stamps.tolist() == [SECOND + k * PERIOD for k in range(200)]
    assert [record.info['dropped'] for record in records.records()] == [0, 0, 0]
    assert not recorder.counts.problems()


def test_diagnostics_recover_from_a_warning(graph, monkeypatch):
    monkeypatch.setattr(health, 'RECENT', 1.0)
    graph.start(Recorder, {'topics': ['altitude']})
    diagnostics = graph.listen(DiagnosticArray, '/diagnostics')
    vehicle = Vehicle(graph, ('altitude',))
    for stamp in (SECOND, SECOND + PERIOD, SECOND + PERIOD):
        vehicle.send(stamp)

    def said(level):
        status = diagnostics and diagnostics[-1].status[0]
        return status and status.level == level and '1 duplicated' in status.message

    graph.spin_until(lambda: said(DiagnosticStatus.WARN), 'the warning')
    graph.spin_until(lambda: said(DiagnosticStatus.OK), 'its end')


def test_a_clock_that_begins_anew_begins_a_record(graph):
    recorder = graph.start(Recorder)
    records, statistics = listen(graph)
    vehicle = Vehicle(graph)
    first = vehicle.fly(60, first=100 * SECOND)
    second = vehicle.fly(80, first=0)
    await_joined(graph, recorder, 140)
    graph.spin_until(lambda: records, 'the first record')
    graph.trigger('recorder/flush')
    graph.spin_until(lambda: len(records) == 2, 'the second record')
    assert [stamps_of(record).tolist() for record in records.records()] == [first, second]
    account = await_counts(graph, statistics, records=2)
    assert problems(account) == {'restarts': 1}


def test_a_simulated_clock_begins_anew_with_a_new_simulator(graph, tmp_path):
    """The same experiment again, with the same stamps, by a simulator that was started again."""
    path = write_experiment(tmp_path / 'yaw.yaml', {'psi': (3.0, {'U4': 0.01})})
    recorder = graph.start(Recorder)
    records, statistics = listen(graph)
    parameters = {'experiment': path, 'publish_clock': True, 'real_time_factor': 0.0}
    first = graph.start(Simulator, parameters)
    graph.spin_until(lambda: len(records) == 1, 'the first flight')
    graph.stop(first)
    graph.start(Simulator, parameters)
    graph.spin_until(lambda: len(records) == 2, 'the second flight')
    for record in records.records():
        assert record.info['start_ns'] == 0 and len(record) == 301
        assert record.info['starts_at_rest'] and record.info['dropped'] == 0
    assert problems(await_counts(graph, statistics, records=2)) == {'restarts': 1}
    assert recorder.counts.joined == 602


def announce(graph, start, count, **info):
    publisher = graph.advertise(String, 'run', latched(32))
    notice = RunNotice(start, start + (count - 1) * PERIOD, count, info)
    publisher.publish(String(data=notice.to_json()))
    return publisher


def test_an_announced_run_is_a_record_with_its_provenance(graph):
    graph.start(Recorder)
    records, _ = listen(graph)
    announce(graph, SECOND, 50, name='one', starts_at_rest=True, run_index=0)
    Vehicle(graph).fly(70)
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    assert len(record) == 50
    assert record.info['name'] == 'one' and record.info['starts_at_rest'] is True


def test_a_run_whose_publishers_are_gone_is_over(graph):
    graph.start(Recorder)
    records, statistics = listen(graph)
    announcement = announce(graph, SECOND, 100, name='cut')
    vehicle = Vehicle(graph)
    vehicle.fly(60)
    vehicle.send(SECOND + 60 * PERIOD, topics=['attitude'])
    await_counts(graph, statistics, joined=60)
    for publisher in [announcement, *vehicle.publishers.values()]:
        graph.probe.destroy_publisher(publisher)
    graph.spin_until(lambda: records, 'the record')
    [record] = records.records()
    assert (len(record), record.info['dropped'], record.info['name']) == (60, 40, 'cut')
    assert problems(await_counts(graph, statistics, records=1)) == {'dropped': 1, 'missing': 40}


@pytest.mark.parametrize('text', ['', 'nonsense', '{"start_ns": 1}', '[]', '{"start_ns": 0, '
                                  '"stop_ns": Infinity, "samples": 1, "info": {}}'])
def test_a_malformed_notice_does_no_harm(graph, text):
    recorder = graph.start(Recorder)
    records, _ = listen(graph)
    graph.advertise(String, 'run', latched(32)).publish(String(data=text))
    Vehicle(graph).fly(30)
    await_joined(graph, recorder, 30)
    assert graph.trigger('recorder/flush').success
    graph.spin_until(lambda: records, 'the record')
    assert 'name' not in records.records()[0].info


def test_records_are_there_for_those_who_come_late(graph):
    recorder = graph.start(Recorder, {'window_samples': 10})
    Vehicle(graph).fly(200)
    await_joined(graph, recorder, 200)
    records, statistics = listen(graph)
    graph.spin_until(lambda: len(records) == 16 and statistics, 'the latched records')
    starts = [record.info['start_ns'] for record in records.records()]
    assert starts == [SECOND + k * 10 * PERIOD for k in range(4, 20)]   # the newest 16
    assert await_counts(graph, statistics, records=20)['buffered'] == 0
