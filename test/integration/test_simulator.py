# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node simulator: what it publishes, at which pace, and how it is steered."""

from graph import Graph, stamps_of, STREAMS, write_experiment
import numpy as np
import pytest
from rcl_interfaces.msg import Log
from rosgraph_msgs.msg import Clock
from scipy.spatial.transform import Rotation
from std_msgs.msg import String

from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.nodes.process import FastExecutor
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

PERIOD = 10 ** 7    # ns


@pytest.fixture
def short(tmp_path):
    """Give the path of an experiment of 2 runs of 0.5 s, in which all axes move."""
    return write_experiment(tmp_path / 'short.yaml', {
        'all': (0.5, {'U1': 1.0, 'U2': 0.1, 'U3': -0.05, 'U4': 0.02}),
        'psi': (0.5, {'U4': 0.02})})


def listen(graph, prefix=''):
    return {name: graph.listen(kind, prefix + name) for name, kind in STREAMS.items()}


def notices(graph, prefix=''):
    return graph.listen(String, f'{prefix}run', latched(32))


def truth(path, k=0, **options):
    experiment = load_experiment(path)
    return fly(experiment, experiment.runs[k], **options).record


def await_samples(graph, heard, count):
    graph.spin_until(lambda: all(len(messages) >= count for messages in heard.values()),
                     f'{count} samples')


def test_topics_carry_the_state_with_one_stamp(graph, short):
    heard, runs = listen(graph), notices(graph)
    simulator = graph.start(Simulator, {'experiment': short, 'real_time_factor': 0.0})
    await_samples(graph, heard, 102)
    graph.spin_until(lambda: simulator.done and len(runs) == 2, 'the end')
    stamps = stamps_of(heard['attitude'])
    assert len(stamps) == 102
    for messages in heard.values():
        np.testing.assert_array_equal(stamps_of(messages), stamps)
    for k, run in enumerate(runs.data()):
        part = slice(51 * k, 51 * k + 51)
        np.testing.assert_array_equal(stamps[part] - stamps[51 * k], PERIOD * np.arange(51))
        assert (run['start_ns'], run['stop_ns']) == (stamps[part][0], stamps[part][-1])
        assert run['samples'] == 51
        check_content(heard, part, truth(short, k))
    assert stamps[51] > stamps[50] + PERIOD   # a gap, so that nobody takes them for one flight


def check_content(heard, part, record, prefix=''):
    """Compare messages, by their fields, with what the library flew."""
    def rows(topic, read):
        return np.array([read(message) for message in heard[topic][part]])

    def vector(field):
        return field.x, field.y, field.z

    equal = np.testing.assert_array_equal
    equal(rows('attitude', lambda m: vector(m.vector)), record.stack('phi', 'theta', 'psi'))
    equal(rows('altitude', lambda m: m.point.z), record.columns['pz'])
    equal(rows('pose', lambda m: vector(m.pose.position)), record.stack('px', 'py', 'pz'))
    quaternion = rows('pose', lambda m: (*vector(m.pose.orientation), m.pose.orientation.w))
    equal(quaternion, record.stack('qx', 'qy', 'qz', 'qw'))
    # The velocity is that of the body axes: the world's one turned by the inverse attitude.
    world = record.stack('vx', 'vy', 'vz')
    body = Rotation.from_quat(quaternion).inv().apply(world)
    np.testing.assert_allclose(rows('twist', lambda m: vector(m.twist.linear)), body, atol=1e-12)
    equal(rows('twist', lambda m: vector(m.twist.angular)), record.stack('wx', 'wy', 'wz'))
    # A true wrench: the moments (N m) about x and y are the arm length times U2 and U3.
    arm = load_vehicle('paper_quadrotor').arm_length
    equal(rows('input', lambda m: (m.wrench.force.z, *vector(m.wrench.torque))),
          record.inputs() * [1.0, arm, arm, 1.0])
    assert not rows('input', lambda m: (m.wrench.force.x, m.wrench.force.y)).any()
    for topic, frame in {'attitude': 'world', 'altitude': 'world', 'pose': 'world',
                         'twist': f'{prefix}base_link',
                         'input': f'{prefix}base_link'}.items():
        assert {message.header.frame_id for message in heard[topic][part]} == {frame}


def test_attitude_and_velocity_are_told_apart_by_frames(graph, short):
    """The comparison above would pass without a turn if the flight were level: it is not."""
    record = truth(short)
    body = Rotation.from_quat(record.stack('qx', 'qy', 'qz', 'qw')).inv().apply(
        record.stack('vx', 'vy', 'vz'))
    assert np.abs(body - record.stack('vx', 'vy', 'vz')).max() > 0.01


def test_noise_has_a_seed(graph, short):
    noise = {'noise.attitude': 0.01, 'noise.altitude': 0.1, 'noise.velocity': 0.2}
    heard = {}
    for name, seed in {'a': 1, 'b': 1, 'c': 2}.items():
        heard[name] = listen(graph, f'{name}/')
        graph.start(Simulator, {'experiment': short, 'real_time_factor': 0.0, 'seed': seed,
                                **noise}, namespace=name)
    for messages in heard.values():
        await_samples(graph, messages, 102)
    flown = truth(short, noise={key[6:]: value for key, value in noise.items()}, seed=1)
    for name in 'ab':
        check_content(heard[name], slice(0, 51), flown)
    attitude = {name: np.array([(m.vector.x, m.vector.y) for m in messages['attitude']])
                for name, messages in heard.items()}
    np.testing.assert_array_equal(attitude['a'], attitude['b'])
    assert (attitude['a'] != attitude['c']).all()
    clean = truth(short).stack('phi', 'theta')
    assert (attitude['a'][:51] - clean).std() == pytest.approx(0.01, rel=0.3)
    # What has no noise is not touched: the rates.
    np.testing.assert_array_equal([m.twist.angular.x for m in heard['a']['twist'][:51]],
                                  truth(short).columns['wx'])


def test_full_speed_loses_nothing(graph):
    heard = listen(graph)
    recorder = graph.start(Recorder)
    simulator = graph.start(Simulator, {'real_time_factor': 0.0})
    await_samples(graph, heard, 4 * 501)
    graph.spin_until(lambda: simulator.done and recorder.counts.joined == 4 * 501, 'the end')
    stamps = stamps_of(heard['attitude'])
    runs = np.array(stamps).reshape(4, 501)
    np.testing.assert_array_equal(runs - runs[:, :1], np.tile(PERIOD * np.arange(501), (4, 1)))
    # Where all of a run's time has passed before it was heard, the next one begins later.
    assert (runs[1:, 0] - runs[:-1, -1] >= 10 * PERIOD).all()
    for messages in heard.values():
        np.testing.assert_array_equal(stamps_of(messages), stamps)
    assert recorder.counts.problems() == {}


def test_full_speed_waits_for_a_slow_subscriber(domain, fast_graph, processes, tmp_path):
    """A subscriber that sleeps gets every sample of a run longer than all queues together."""
    graph, count = fast_graph, 12001
    path = write_experiment(tmp_path / 'long.yaml', {'psi': ((count - 1) * 1e-3, {'U4': 0.01})},
                            period=0.001)
    sleeper = Graph(domain, FastExecutor)
    try:
        slow = sleeper.listen(STREAMS['attitude'], 'attitude')
        recorder = graph.start(Recorder, {'topics': ['attitude', 'input']})
        for name in ('altitude', 'pose', 'twist'):
            graph.listen(STREAMS[name], name, 1)
        processes.start('simulator', {'experiment': path, 'real_time_factor': 0.0})
        # It does not even look until the simulator has stopped to wait for it.
        received = 0
        while not 0 < received == recorder.counts.received['attitude']:
            received = recorder.counts.received['attitude']
            graph.spin_for(1.0)
        assert received < count
        sleeper.spin_until(lambda: len(slow) == count, 'the whole run')
        graph.spin_until(lambda: recorder.counts.joined == count, 'the recorder')
        stamps = stamps_of(slow)
        np.testing.assert_array_equal(stamps - stamps[0], 10 ** 6 * np.arange(count))
        assert recorder.counts.problems() == {}
    finally:
        sleeper.close()


@pytest.mark.parametrize('factor', [1.0, 5.0])
def test_pace(graph, tmp_path, factor):
    seconds = 0.6 * factor
    path = write_experiment(tmp_path / 'paced.yaml', {'psi': (seconds, {'U4': 0.01})})
    heard = listen(graph)['input']
    graph.start(Simulator, {'experiment': path, 'real_time_factor': factor})
    count = round(seconds * 100) + 1
    graph.spin_until(lambda: len(heard) >= count, 'the run')
    stamps = stamps_of(heard)
    np.testing.assert_array_equal(stamps - stamps[0], PERIOD * np.arange(count))
    # Never faster than the pace, and no slower than a busy machine explains.
    assert 0.6 - 0.1 < heard.times[-1] - heard.times[0] < 0.6 + 5.0


def test_published_clock_is_the_time_of_the_samples(graph, short):
    clock, runs = graph.listen(Clock, '/clock', 1000), notices(graph)
    heard = listen(graph)['attitude']
    simulator = graph.start(Simulator, {'experiment': short, 'publish_clock': True,
                                        'real_time_factor': 10.0})
    graph.spin_until(lambda: simulator.done and len(heard) == 102 and len(clock) == 102, 'the end')
    times = [message.clock.sec * 10 ** 9 + message.clock.nanosec for message in clock]
    np.testing.assert_array_equal(times, stamps_of(heard))
    assert times[:2] == [0, PERIOD]
    assert runs.data()[0]['start_ns'] == 0
    # The next flight goes on where this one ended: time does not go back.
    assert graph.trigger('simulator/start').success
    graph.spin_until(lambda: len(heard) == 204, 'the second flight')
    assert (np.diff(stamps_of(heard)) > 0).all()


def test_pace_comes_from_an_external_clock(graph, short):
    publisher = graph.probe.create_publisher(Clock, '/clock', 10)
    heard, runs = listen(graph), notices(graph)
    simulator = graph.start(Simulator, {'experiment': short, 'use_sim_time': True,
                                        'real_time_factor': 2.0})
    graph.await_listeners(publisher)

    def show(nanoseconds):
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(nanoseconds, 10 ** 9)
        publisher.publish(message)

    begin = 7 * 10 ** 9
    # Before the clock runs there is no time to start at.
    graph.spin_for(0.8)
    assert not any(heard.values())

    def started():
        show(begin)
        return runs

    graph.spin_until(started, 'the start')
    assert runs.data()[0]['start_ns'] == begin
    # At twice the clock's pace, 50 ms of the clock are 0.1 s of the flight.
    show(begin + 5 * PERIOD)
    await_samples(graph, heard, 11)
    graph.spin_for(0.3)
    assert [len(messages) for messages in heard.values()] == [11] * 5
    np.testing.assert_array_equal(stamps_of(heard['pose']), begin + PERIOD * np.arange(11))
    show(begin + 10 ** 9)
    await_samples(graph, heard, 51)
    # The stamps of the second flight do not fall behind the time at which it begins.
    graph.spin_until(lambda: len(runs) == 2, 'the second flight')
    assert runs.data()[1]['start_ns'] == begin + 10 ** 9
    show(begin + 10 ** 10)
    await_samples(graph, heard, 52)
    show(begin + 10 ** 10 + 10 ** 9)
    await_samples(graph, heard, 102)
    graph.spin_until(lambda: simulator.done, 'the end')


def test_namespace_and_remapping(graph, short):
    heard = {name: graph.listen(kind, f'/fleet/one/{name}' if name != 'attitude'
                                else '/imu/angles') for name, kind in STREAMS.items()}
    plain = listen(graph, '/')
    runs = notices(graph, '/fleet/one/')
    graph.start(Simulator, {'experiment': short, 'real_time_factor': 0.0}, namespace='fleet/one',
                arguments=['-r', 'attitude:=/imu/angles', '-p', 'frame_prefix:=one/'])
    await_samples(graph, heard, 102)
    assert len(runs) == 2
    check_content(heard, slice(0, 51), truth(short), 'one/')
    assert not any(plain.values())
    names = [name for name, _ in graph.probe.get_topic_names_and_types()]
    assert '/fleet/one/attitude' not in names
    assert graph.trigger('/fleet/one/simulator/stop').success


def test_start_and_stop(graph, short):
    heard, runs = listen(graph), notices(graph)
    simulator = graph.start(Simulator, {'experiment': short, 'autostart': False,
                                        'real_time_factor': 1.0})
    response = graph.trigger('simulator/stop')
    assert (response.success, response.message) == (True, 'nothing was flying')
    graph.spin_for(0.8)
    assert not runs
    assert graph.trigger('simulator/start').message == 'short: 2 runs to fly'
    await_samples(graph, heard, 3)
    assert graph.trigger('simulator/stop').message == 'stopped'
    assert simulator.done
    graph.spin_for(0.2)
    count = len(heard['input'])
    assert 3 <= count < 51
    graph.spin_for(0.2)
    assert len(heard['input']) == count
    # The run is announced again, unchanged.
    graph.spin_until(lambda: len(runs) == 2, 'the notice of the end')
    whole, cut = runs.data()
    assert (whole['samples'], whole['info']['status']) == (51, 'complete')
    assert (cut['samples'], cut['info']['status']) == (count, 'stopped')
    assert cut['start_ns'] == whole['start_ns'] == stamps_of(heard['input'])[0]
    assert cut['stop_ns'] == stamps_of(heard['input'])[-1]
    # It begins with the first run again, later than what was published before.
    assert graph.trigger('simulator/start').success
    graph.spin_until(lambda: len(runs) == 3, 'the run again')
    again = runs.data()[2]
    assert again['info']['run'] == whole['info']['run'] == 'all'
    assert again['info']['session'] == again['start_ns'] > whole['stop_ns']
    await_samples(graph, heard, count + 102)


def test_changed_parameters_hold_from_the_next_start_on(graph, short):
    runs = notices(graph)
    heard = listen(graph)
    graph.start(Simulator, {'experiment': short, 'real_time_factor': 0.0})
    await_samples(graph, heard, 102)
    for name, value in {'vehicle': 'paper_quadrotor_izz_corrected', 'seed': 5,
                        'noise.rate': 0.5}.items():
        assert graph.set_parameter('simulator', name, value).successful
    assert graph.trigger('simulator/start').success
    await_samples(graph, heard, 204)
    graph.spin_until(lambda: len(runs) == 4, 'four notices')
    old, new = runs.data()[0]['info'], runs.data()[2]['info']
    assert (old['vehicle'], old['seed'], old['noise']) == ('paper_quadrotor', 0, {})
    assert (new['vehicle'], new['seed']) == ('paper_quadrotor_izz_corrected', 5)
    assert new['noise'] == {'rate': 0.5}


def test_a_broken_file_is_refused_by_the_service(graph, short):
    simulator = graph.start(Simulator, {'experiment': short, 'autostart': False})
    with open(short, 'w', encoding='utf-8') as file:
        file.write('name: short\n')
    response = graph.trigger('simulator/start')
    assert not response.success
    assert 'short.yaml' in response.message and 'missing' in response.message
    result = graph.set_parameter('simulator', 'experiment', short)
    assert not result.successful and 'missing' in result.reason
    assert simulator.get_parameter('experiment').value == short


def test_diverging_run_ends_with_its_status(graph, tmp_path):
    """The printed yaw equation goes to infinity at (pi/2) Iz / sqrt(Kfaz U4) = 0.0810 s."""
    path = write_experiment(tmp_path / 'yaw.yaml', {
        'psi': (5.0, {'U4': 1.0}), 'z': (0.2, {'U1': 1.0})}, model='paper')
    runs, heard = notices(graph), listen(graph)
    recorder = graph.start(Recorder)
    simulator = graph.start(Simulator, {'experiment': path, 'real_time_factor': 0.0})
    graph.spin_until(lambda: simulator.done and len(runs) == 2, 'the end')
    diverged, after = runs.data()
    assert diverged['info']['status'] == 'diverged'
    blow_up = np.pi / 2 * 1.3e-3 / np.sqrt(6.354e-4)
    assert diverged['info']['end_time'] == pytest.approx(blow_up, abs=1e-3)
    assert diverged['samples'] == 9
    assert diverged['stop_ns'] - diverged['start_ns'] == 8 * PERIOD
    assert (after['info']['status'], after['samples']) == ('complete', 21)
    await_samples(graph, heard, 30)
    graph.spin_until(lambda: recorder.counts.joined == 30, 'the recorder')
    assert recorder.counts.problems() == {}


def test_inputs_without_rotor_speeds_are_said_to_be_so(graph, tmp_path, short):
    path = write_experiment(tmp_path / 'strong.yaml', {'psi': (0.1, {'U4': 1.0})})
    runs, feasible = notices(graph), notices(graph, 'feasible/')
    logs = graph.listen(Log, '/rosout', latched(100))
    options = {'real_time_factor': 0.0, 'wait_for_subscribers': False}
    graph.start(Simulator, {'experiment': path, **options})
    graph.start(Simulator, {'experiment': short, **options}, namespace='feasible')
    graph.spin_until(lambda: runs and feasible, 'the notices')
    problem = runs.data()[0]['info']['infeasible']
    assert 'rotor' in problem
    assert feasible.data()[0]['info']['infeasible'] is None
    graph.spin_until(lambda: [log for log in logs if problem in log.msg], 'a warning')
    assert next(log for log in logs if problem in log.msg).level == Log.WARN


def test_a_run_that_cannot_be_flown_is_left_out(graph, tmp_path):
    """The speeds of rotors that no rotor speeds give: known only when the run is flown."""
    path = write_experiment(tmp_path / 'mixed.yaml', {'psi': (0.1, {'U4': 1.0}),
                                                      'z': (0.1, {'U1': 0.5})},
                            omega_r='from_rotors')
    runs, logs = notices(graph), graph.listen(Log, '/rosout', latched(100))
    simulator = graph.start(Simulator, {'experiment': path, 'real_time_factor': 0.0,
                                        'wait_for_subscribers': False})
    graph.spin_until(lambda: simulator.done and runs, 'the end')
    assert [run['info']['run'] for run in runs.data()] == ['z']
    graph.spin_until(lambda: [log for log in logs if 'needs feasible inputs' in log.msg],
                     'the error')
    assert next(log for log in logs if 'feasible' in log.msg).level == Log.ERROR


def test_waits_for_subscribers_only_if_told_to(graph, short):
    runs = notices(graph)
    waiting = graph.start(Simulator, {'experiment': short, 'real_time_factor': 0.0})
    eager = graph.start(Simulator, {'experiment': short, 'real_time_factor': 0.0,
                                    'wait_for_subscribers': False}, namespace='eager')
    graph.spin_until(lambda: eager.done, 'the one that does not wait')
    graph.spin_for(0.7)
    assert not waiting.done and not runs
    heard = listen(graph)
    await_samples(graph, heard, 102)


def test_a_clock_cannot_wait_for_itself(graph):
    with pytest.raises(InputError, match='publish_clock and use_sim_time exclude each other'):
        graph.start(Simulator, {'publish_clock': True, 'use_sim_time': True})


def test_read_only_parameters_are_said_to_be_so(graph, short):
    graph.start(Simulator, {'experiment': short})
    result = graph.set_parameter('simulator', 'real_time_factor', 2.0)
    assert not result.successful and 'read-only' in result.reason
